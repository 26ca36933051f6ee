//! Values that may be written in more than one way.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

/// Ids: a number, a list, or text such as `"1 THRU 5000"` or `"1, 7, 20 THRU 30"`.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Ids(pub Vec<[u32; 2]>);

/// Ids of properties, and names that the deck gives properties: `[14, "RailLeft"]`, `"RailLeft"`.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct PropertyIds {
    /// Ids as stated.
    pub ids: Ids,
    /// Names as stated.
    pub names: Vec<String>,
}

impl Ids {
    /// Returns whether the list contains `id`.
    pub fn contains(&self, id: u32) -> bool {
        self.0.iter().any(|[a, b]| (*a..=*b).contains(&id))
    }
}

fn ids_from_text(text: &str) -> Option<Ids> {
    let words: Vec<String> = text
        .split([',', ' ', ';', '\t'])
        .filter(|w| !w.is_empty())
        .map(str::to_uppercase)
        .collect();
    let mut out = Vec::new();
    let mut i = 0;
    while let Some(word) = words.get(i) {
        let a = word.parse::<u32>().ok()?;
        if words.get(i + 1).map(String::as_str) == Some("THRU") {
            let b = words.get(i + 2)?.parse::<u32>().ok()?;
            if b < a {
                return None;
            }
            out.push([a, b]);
            i += 3;
        } else {
            out.push([a, a]);
            i += 1;
        }
    }
    (!out.is_empty()).then_some(Ids(out))
}

impl<'de> Deserialize<'de> for Ids {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Ids;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("ids: a number, a list of numbers, or text such as \"1 THRU 5000\"")
            }
            fn visit_i64<E: Error>(self, v: i64) -> Result<Ids, E> {
                let id = u32::try_from(v)
                    .map_err(|_| E::custom("an id must be a whole number above 0"))?;
                Ok(Ids(vec![[id, id]]))
            }
            fn visit_str<E: Error>(self, v: &str) -> Result<Ids, E> {
                ids_from_text(v).ok_or_else(|| {
                    E::custom(format!(
                        "`{v}` is not a list of ids, expected text such as \"1 THRU 5000\""
                    ))
                })
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut s: A) -> Result<Ids, A::Error> {
                let mut out = Ids::default();
                while let Some(id) = s.next_element::<u32>()? {
                    out.0.push([id, id]);
                }
                Ok(out)
            }
        }
        d.deserialize_any(V)
    }
}

impl PropertyIds {
    fn of_text(text: &str) -> Self {
        match ids_from_text(text) {
            Some(ids) => Self {
                ids,
                names: Vec::new(),
            },
            None => Self {
                ids: Ids::default(),
                names: vec![text.trim().to_owned()],
            },
        }
    }

    fn of_id<E: Error>(v: i64) -> Result<Self, E> {
        let id = u32::try_from(v).map_err(|_| E::custom("an id must be a whole number above 0"))?;
        Ok(Self {
            ids: Ids(vec![[id, id]]),
            names: Vec::new(),
        })
    }
}

const ID_OR_NAME: &str =
    "properties: an id, a name of the deck, a list of both, or text such as \"1 THRU 5000\"";

impl<'de> Deserialize<'de> for PropertyIds {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = PropertyIds;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(ID_OR_NAME)
            }
            fn visit_i64<E: Error>(self, v: i64) -> Result<PropertyIds, E> {
                PropertyIds::of_id(v)
            }
            fn visit_str<E: Error>(self, v: &str) -> Result<PropertyIds, E> {
                Ok(PropertyIds::of_text(v))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut s: A) -> Result<PropertyIds, A::Error> {
                let mut out = PropertyIds::default();
                while let Some(entry) = s.next_element::<PropertyIds>()? {
                    out.ids.0.extend(entry.ids.0);
                    out.names.extend(entry.names);
                }
                Ok(out)
            }
        }
        d.deserialize_any(V)
    }
}

/// One text, or a list of texts. The form in the job is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Texts {
    /// `"all"`, a file name.
    One(String),
    /// A list.
    Many(Vec<String>),
}

impl<'de> Deserialize<'de> for Texts {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Texts;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("text, or a list of texts")
            }
            fn visit_str<E: Error>(self, v: &str) -> Result<Texts, E> {
                Ok(Texts::One(v.to_owned()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut s: A) -> Result<Texts, A::Error> {
                let mut out = Vec::new();
                while let Some(t) = s.next_element::<String>()? {
                    out.push(t);
                }
                Ok(Texts::Many(out))
            }
        }
        d.deserialize_any(V)
    }
}

/// A number, or a word.
#[derive(Clone, Debug, PartialEq)]
pub enum NumberOrWord {
    /// A number.
    Number(f64),
    /// A word.
    Word(String),
}

impl<'de> Deserialize<'de> for NumberOrWord {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl Visitor<'_> for V {
            type Value = NumberOrWord;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number or a word")
            }
            fn visit_i64<E: Error>(self, v: i64) -> Result<NumberOrWord, E> {
                Ok(NumberOrWord::Number(v as f64))
            }
            fn visit_f64<E: Error>(self, v: f64) -> Result<NumberOrWord, E> {
                Ok(NumberOrWord::Number(v))
            }
            fn visit_str<E: Error>(self, v: &str) -> Result<NumberOrWord, E> {
                Ok(NumberOrWord::Word(v.to_owned()))
            }
        }
        d.deserialize_any(V)
    }
}

/// One number, or one number for each name.
#[derive(Clone, Debug, PartialEq)]
pub enum NumberOrNumbers {
    /// One for all.
    One(f64),
    /// A number for each name, in alphabetical order.
    ByName(BTreeMap<String, f64>),
}

impl<'de> Deserialize<'de> for NumberOrNumbers {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = NumberOrNumbers;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number, or numbers by name such as { G1 = 0.5, G2 = 1.0 }")
            }
            fn visit_i64<E: Error>(self, v: i64) -> Result<NumberOrNumbers, E> {
                Ok(NumberOrNumbers::One(v as f64))
            }
            fn visit_f64<E: Error>(self, v: f64) -> Result<NumberOrNumbers, E> {
                Ok(NumberOrNumbers::One(v))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut m: A) -> Result<NumberOrNumbers, A::Error> {
                let mut out = BTreeMap::new();
                while let Some((name, value)) = m.next_entry()? {
                    out.insert(name, value);
                }
                Ok(NumberOrNumbers::ByName(out))
            }
        }
        d.deserialize_any(V)
    }
}

/// Damping: a number, a list of bands, or a word.
#[derive(Clone, Debug, PartialEq)]
pub enum DampingValue {
    /// One for all modes.
    One(f64),
    /// A damping for each band of frequency.
    Bands(Vec<DampingBand>),
    /// A word.
    Word(String),
}

/// Damping of the modes up to a frequency.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DampingBand {
    /// Upper end of the band, Hz.
    pub up_to_hz: f64,
    /// Damping, share of critical.
    pub damping: f64,
}

impl<'de> Deserialize<'de> for DampingValue {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = DampingValue;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(
                    "a number, a list such as [{ up_to_hz = 5, damping = 0.2 }, { up_to_hz = 50, damping = 0.02 }], or \"estimate\"",
                )
            }
            fn visit_i64<E: Error>(self, v: i64) -> Result<DampingValue, E> {
                Ok(DampingValue::One(v as f64))
            }
            fn visit_f64<E: Error>(self, v: f64) -> Result<DampingValue, E> {
                Ok(DampingValue::One(v))
            }
            fn visit_str<E: Error>(self, v: &str) -> Result<DampingValue, E> {
                Ok(DampingValue::Word(v.to_owned()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut s: A) -> Result<DampingValue, A::Error> {
                let mut out = Vec::new();
                while let Some(band) = s.next_element::<DampingBand>()? {
                    out.push(band);
                }
                Ok(DampingValue::Bands(out))
            }
        }
        d.deserialize_any(V)
    }
}

/// One whole number, or a list of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counts(pub Vec<u32>);

impl<'de> Deserialize<'de> for Counts {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        struct V;
        impl<'de> Visitor<'de> for V {
            type Value = Counts;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a whole number, or a list of whole numbers")
            }
            fn visit_i64<E: Error>(self, v: i64) -> Result<Counts, E> {
                u32::try_from(v)
                    .map(|n| Counts(vec![n]))
                    .map_err(|_| E::custom("a count must be 0 or more"))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut s: A) -> Result<Counts, A::Error> {
                let mut out = Vec::new();
                while let Some(n) = s.next_element::<u32>()? {
                    out.push(n);
                }
                Ok(Counts(out))
            }
        }
        d.deserialize_any(V)
    }
}

/// Implements a JSON schema for each of these types, inlined where the type is used.
macro_rules! schema {
    ($type:ty, $schema:tt) => {
        impl JsonSchema for $type {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                stringify!($type).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        }
    };
}

schema!(Ids, {
    "type": ["integer", "string", "array"],
    "items": { "type": "integer" },
    "minimum": 1
});
schema!(PropertyIds, {
    "type": ["integer", "string", "array"],
    "items": { "type": ["integer", "string"] },
    "minimum": 1
});
schema!(Texts, { "type": ["string", "array"], "items": { "type": "string" } });
schema!(NumberOrWord, { "type": ["number", "string"] });
schema!(NumberOrNumbers, {
    "type": ["number", "object"],
    "additionalProperties": { "type": "number" }
});
schema!(DampingValue, {
    "type": ["number", "string", "array"],
    "items": {
        "type": "object",
        "properties": {
            "up_to_hz": { "type": "number" },
            "damping": { "type": "number" }
        },
        "required": ["up_to_hz", "damping"],
        "additionalProperties": false
    }
});
schema!(Counts, {
    "type": ["integer", "array"],
    "items": { "type": "integer", "minimum": 0 },
    "minimum": 0
});
