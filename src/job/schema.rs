//! JSON schema of a job. Keys and types come from `super::raw_job`, allowed values and meanings from this module.

use super::raw_job::RawJob;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

/// Table of the keys: path, meaning, unit, default, allowed values.
const KEYS: &str = include_str!("keys.txt");
/// Placeholder in the table for the names of vehicle models.
const MODELS: &str = "@models";

/// Meaning of a key of a job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Key {
    /// Path of the key, such as `load.grid`; sections and lists of sections have the same form.
    pub path: &'static str,
    /// Meaning of the key.
    pub meaning: &'static str,
    /// Unit of the key; `None` for text, counts and fractions.
    pub unit: Option<&'static str>,
    /// Description of the default. `None` for sections, and for groups of keys of which one is required.
    pub default: Option<&'static str>,
    /// Allowed values, if only these are valid.
    pub words: Vec<&'static str>,
}

/// Returns every key of a job, in the order of the reference.
pub fn keys() -> Vec<Key> {
    let lines = KEYS.lines().filter(|l| !l.starts_with('#'));
    lines.filter_map(read_key).collect()
}

fn read_key(line: &'static str) -> Option<Key> {
    let mut parts = line.split(" | ");
    let mut next = || parts.next();
    let (path, meaning, unit, default, words) = (next()?, next()?, next()?, next()?, next()?);
    let stated = |word: &'static str| (word != "-").then_some(word);
    Some(Key {
        path,
        meaning,
        unit: stated(unit),
        default: stated(default),
        words: match words {
            "-" => Vec::new(),
            MODELS => crate::vehicle::preset::MODELS.to_vec(),
            list => list.split(", ").collect(),
        },
    })
}

impl Key {
    /// Meaning, unit and default in one sentence, for editors.
    fn description(&self) -> String {
        let mut text = self.meaning.to_owned();
        if let Some(unit) = self.unit {
            text.push_str(&format!(" [{unit}]"));
        }
        match self.default {
            Some("required") => text.push_str("; required"),
            Some(d) if d.starts_with("required ") => text.push_str(&format!("; {d}")),
            Some(d) => text.push_str(&format!("; default: {d}")),
            None => {}
        }
        text
    }
}

/// Returns the schema as JSON text (draft 2020-12).
pub fn job_schema() -> String {
    let settings = SchemaSettings::draft2020_12().for_deserialize().with(|s| {
        s.inline_subschemas = true;
    });
    let schema = settings.into_generator().into_root_schema_for::<RawJob>();
    let mut value = schema.to_value();
    without_null(&mut value);
    if let Some(top) = value.as_object_mut() {
        top.insert("title".into(), "strainbridge job".into());
    }
    for k in keys() {
        let Some(key) = key_at(&mut value, k.path) else {
            continue;
        };
        key.insert("description".into(), k.description().into());
        if let Some(unit) = k.unit {
            key.insert("x-unit".into(), unit.into());
        }
        if let Some(default) = k.default.filter(|d| !d.starts_with("required")) {
            key.insert("x-default".into(), default.into());
        }
        if k.words.is_empty() {
            continue;
        }
        let words = json!(k.words);
        let other_forms = takes_other_forms(key);
        match key.get_mut("items").and_then(Value::as_object_mut) {
            Some(items) if !other_forms => items.insert("enum".into(), words),
            None if !other_forms => key.insert("enum".into(), words),
            _ => None,
        };
    }
    // A map of plain values can always be serialized.
    serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
}

/// Returns whether a key accepts lists or numbers in addition to its allowed values.
fn takes_other_forms(key: &Map<String, Value>) -> bool {
    key.get("type").is_some_and(Value::is_array)
}

/// The schema of a key such as `load.grid`: through lists, and through tables whose keys are names.
fn key_at<'a>(root: &'a mut Value, path: &str) -> Option<&'a mut Map<String, Value>> {
    let mut at = root;
    for name in path.split('.') {
        let below = if at.get("properties").is_some() {
            at
        } else if at.get("items").is_some() {
            at.get_mut("items")?
        } else {
            at.get_mut("additionalProperties")?
        };
        at = below.get_mut("properties")?.get_mut(name)?;
    }
    at.as_object_mut()
}

/// TOML has no null: an absent key is left out instead.
fn without_null(value: &mut Value) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(without_null),
        Value::Object(map) => {
            if let Some(Value::Array(types)) = map.get_mut("type") {
                types.retain(|t| t != "null");
                if let [only] = types.as_slice() {
                    let only = only.clone();
                    map.insert("type".into(), only);
                }
            }
            if let Some(Value::Array(any)) = map.get_mut("anyOf") {
                any.retain(|s| s.get("type") != Some(&"null".into()));
                if let [Value::Object(only)] = any.as_slice() {
                    let only = only.clone();
                    map.remove("anyOf");
                    map.extend(only);
                }
            }
            if map.get("default").is_some_and(Value::is_null) {
                map.remove("default");
            }
            map.values_mut().for_each(without_null);
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Collects every property below a value, with its path.
    fn walk(value: &Value, path: &str, out: &mut Vec<(String, bool)>) {
        for (name, below) in value
            .get("properties")
            .and_then(Value::as_object)
            .into_iter()
            .flatten()
        {
            let path = format!("{path}{}{name}", if path.is_empty() { "" } else { "." });
            out.push((path.clone(), below.get("description").is_some()));
            walk(below, &path, out);
        }
        for inner in ["items", "additionalProperties"] {
            if let Some(below) = value.get(inner).filter(|b| b.is_object()) {
                walk(below, path, out);
            }
        }
    }

    #[test]
    fn every_key_has_a_meaning_and_every_meaning_a_key() {
        let schema: Value = serde_json::from_str(&job_schema()).unwrap();
        let mut found = Vec::new();
        walk(&schema, "", &mut found);
        let bare: Vec<&String> = found.iter().filter(|f| !f.1).map(|f| &f.0).collect();
        assert!(bare.is_empty(), "without a line in keys.txt: {bare:?}");
        let known: Vec<&str> = keys().iter().map(|k| k.path).collect();
        let gone: Vec<&&str> = known
            .iter()
            .filter(|k| !found.iter().any(|f| f.0 == **k))
            .collect();
        assert!(gone.is_empty(), "in keys.txt and no key: {gone:?}");
        assert_eq!(
            known.len(),
            KEYS.lines().filter(|l| !l.starts_with('#')).count()
        );
        assert!(!job_schema().contains("null"));
    }
}
