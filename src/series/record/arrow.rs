//! Arrow schemas: the columns of a Feather file with their types. A Parquet file also contains such a schema, which marks durations, a type that
//! Parquet lacks.

use super::flat_buffer::Buffer;
use super::typed_columns::Meaning;
use crate::series::parquet::UNIT_OF;
use parquet::file::metadata::FileMetaData;
use std::collections::HashMap;

/// The key under which Arrow keeps its schema in a Parquet file.
const KEY: &str = "ARROW:schema";
/// First four bytes of a message, before its length. Old messages begin with the length.
const CONTINUED: u32 = u32::MAX;
/// Field of a message: what it contains.
const HEADER: usize = 2;
/// Columns in columns that are read at most.
const DEPTH: usize = 32;

/// Storage of the values of a column.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum ColumnStorage {
    /// A bit each.
    Bits,
    Integer {
        bytes: usize,
        is_signed: bool,
        meaning: Meaning,
    },
    /// Reals of 2, 4 or 8 bytes.
    Real { bytes: usize },
    /// Text between offsets of 4 or 8 bytes.
    Text { bytes: usize },
    /// Text in place, or in one of several buffers.
    TextView,
    /// Values that are no channel.
    Other,
}

/// A column of a schema.
#[derive(Clone)]
pub(super) struct Field {
    pub name: String,
    /// Unit that the notes on the column state. Empty if they state none.
    pub unit: String,
    pub stored: ColumnStorage,
    /// Number of buffers of the column in a batch, without the buffers of its children. For views it counts only the fixed buffers.
    pub buffers: usize,
    /// Whether each batch states the number of additional buffers of the column.
    pub is_view: bool,
    /// Whether the first buffer of the column marks missing values.
    pub has_validity: bool,
    /// Identifier and storage of the dictionary, if the values are indices into a dictionary.
    pub dictionary: Option<(usize, ColumnStorage)>,
    pub children: Vec<Field>,
}

/// Notes of a Parquet file on its columns, by name of the column.
#[derive(Default)]
pub(super) struct Notes {
    /// Seconds in one unit of the durations.
    pub durations: HashMap<String, f64>,
    /// Units.
    pub units: HashMap<String, String>,
}

/// Returns the notes of a Parquet file on its columns. A schema that can't be read gives no notes.
///
/// Units are in the notes of a column, under the key `unit` or `units`. They may also be in the notes of the file, under the key `unit of` with the
/// column name, as `recover` writes them.
///
/// # Reference
/// Apache Arrow, Columnar format 1.5: Schema.fbs, Message.fbs.
pub(super) fn notes(file: &FileMetaData) -> Notes {
    let list = || file.key_value_metadata().into_iter().flatten();
    let value = list()
        .filter(|kv| kv.key == KEY)
        .find_map(|kv| kv.value.as_ref());
    let bytes = value.and_then(|text| from_base64(text));
    let mut notes = bytes.and_then(|b| of_schema(&b)).unwrap_or_default();
    notes.units.extend(list().filter_map(|kv| {
        let column = kv.key.strip_prefix(UNIT_OF)?;
        Some((column.to_owned(), kv.value.clone()?))
    }));
    notes
}

fn of_schema(bytes: &[u8]) -> Option<Notes> {
    let buffer = Buffer(bytes);
    let schema = buffer.child(message(buffer, 0)?, HEADER)?;
    let mut notes = Notes::default();
    for f in fields(buffer, schema)? {
        if let ColumnStorage::Integer {
            meaning: Meaning::Duration(worth),
            ..
        } = f.stored
        {
            notes.durations.insert(f.name.clone(), worth);
        }
        if !f.unit.is_empty() {
            notes.units.insert(f.name, f.unit);
        }
    }
    Some(notes)
}

/// Returns the unit in the notes on a field; `None` where they state none, or are damaged.
fn unit_in_notes(buffer: Buffer<'_>, field: usize) -> Option<String> {
    let notes = buffer.list(field, 6, 4)?.into_iter();
    let notes = notes.filter_map(|at| {
        let note = buffer.follow(at)?;
        let [key, value] = [0, 1].map(|n| buffer.child(note, n).and_then(|t| buffer.text(t)));
        Some((key?.to_lowercase(), value?.to_owned()))
    });
    let mut units = notes.filter(|(key, _)| matches!(key.as_str(), "unit" | "units"));
    units.next().map(|(_, unit)| unit)
}

/// Returns the table of the message that begins at a place.
pub(super) fn message(buffer: Buffer<'_>, at: usize) -> Option<usize> {
    let before = if buffer.word(at)? == CONTINUED { 8 } else { 4 };
    buffer.follow(at.checked_add(before)?)
}

/// Returns the content of a message: its kind and its table.
pub(super) fn content(buffer: Buffer<'_>, message: usize) -> Option<(u8, usize)> {
    let kind = buffer.byte(buffer.field(message, HEADER - 1)?)?;
    Some((kind, buffer.child(message, HEADER)?))
}

/// Returns the columns of a schema. `None` if the schema is damaged, or if its numbers are not in little-endian order.
pub(super) fn fields(buffer: Buffer<'_>, schema: usize) -> Option<Vec<Field>> {
    let order = buffer.field(schema, 0);
    let is_little = order.is_none_or(|at| buffer.half(at) == Some(0));
    let list = buffer.list(schema, 1, 4)?.into_iter();
    let read = |at: usize| field(buffer, buffer.follow(at)?, DEPTH);
    is_little.then(|| list.map(read).collect())?
}

fn field(buffer: Buffer<'_>, at: usize, depth: usize) -> Option<Field> {
    let depth = depth.checked_sub(1)?;
    let name = buffer.child(at, 0).and_then(|text| buffer.text(text));
    let kind = buffer.byte(buffer.field(at, 2)?)?;
    let details = buffer.child(at, 3)?;
    let children = buffer.list(at, 5, 4)?.into_iter();
    let children = children.map(|c| field(buffer, buffer.follow(c)?, depth));
    let stored = read_storage(buffer, kind, details)?;
    let plain = Field {
        name: name.unwrap_or_default().to_owned(),
        unit: unit_in_notes(buffer, at).unwrap_or_default(),
        stored,
        buffers: match kind {
            NULL | RUN_ENDS => 0,
            // A buffer of types and, for the dense form, a buffer of offsets.
            UNION => 1 + usize::from(half(buffer, details, 0, 0)? == 1),
            STRUCT | FIXED_LIST => 1,
            BINARY | UTF8 | LARGE_BINARY | LARGE_UTF8 | LIST_VIEW | LARGE_LIST_VIEW => 3,
            _ => 2,
        },
        is_view: matches!(kind, BINARY_VIEW | UTF8_VIEW),
        has_validity: !matches!(kind, NULL | RUN_ENDS | UNION),
        dictionary: None,
        children: children.collect::<Option<_>>()?,
    };
    let Some(dictionary) = buffer.child(at, 4) else {
        return Some(plain);
    };
    let id = buffer.field(dictionary, 0);
    let id = id.map_or(Some(0), |at| buffer.size(at))?;
    let index = match buffer.child(dictionary, 1) {
        Some(details) => self::read_storage(buffer, INT, details)?,
        None => integer(4, true, Meaning::Number(1.0)),
    };
    Some(Field {
        stored: index,
        buffers: 2,
        is_view: false,
        has_validity: true,
        dictionary: Some((id, stored)),
        children: Vec::new(),
        ..plain
    })
}

// Type codes of the Arrow schema.
const NULL: u8 = 1;
const INT: u8 = 2;
const REAL: u8 = 3;
const BINARY: u8 = 4;
const UTF8: u8 = 5;
const BOOL: u8 = 6;
const TIME: u8 = 9;
const TIMESTAMP: u8 = 10;
const STRUCT: u8 = 13;
const UNION: u8 = 14;
const FIXED_LIST: u8 = 16;
const DURATION: u8 = 18;
const LARGE_BINARY: u8 = 19;
const LARGE_UTF8: u8 = 20;
const RUN_ENDS: u8 = 22;
const BINARY_VIEW: u8 = 23;
const UTF8_VIEW: u8 = 24;
const LIST_VIEW: u8 = 25;
const LARGE_LIST_VIEW: u8 = 26;

fn integer(bytes: usize, is_signed: bool, meaning: Meaning) -> ColumnStorage {
    ColumnStorage::Integer {
        bytes,
        is_signed,
        meaning,
    }
}

/// Returns a number of 16 bits in a table; `otherwise` where it was left out.
fn half(buffer: Buffer<'_>, table: usize, number: usize, otherwise: u16) -> Option<u16> {
    let at = buffer.field(table, number);
    at.map_or(Some(otherwise), |at| buffer.half(at))
}

/// Returns how the values of a type are stored; `None` where its details are damaged.
fn read_storage(buffer: Buffer<'_>, kind: u8, details: usize) -> Option<ColumnStorage> {
    let bits = |number: usize, otherwise: u32| {
        let at = buffer.field(details, number);
        at.map_or(Some(otherwise), |at| buffer.word(at))
    };
    let bytes = |bits: u32| matches!(bits, 8 | 16 | 32 | 64).then_some(bits as usize / 8);
    // Without a stated unit, timestamps count in s, times and durations in ms.
    let unit = |otherwise: u16| match half(buffer, details, 0, otherwise)? {
        0 => Some(1.0),
        1 => Some(1e-3),
        2 => Some(1e-6),
        3 => Some(1e-9),
        _ => None,
    };
    Some(match kind {
        INT => {
            let at = buffer.field(details, 1);
            let is_signed = at.is_some_and(|at| buffer.byte(at) == Some(1));
            integer(bytes(bits(0, 0)?)?, is_signed, Meaning::Number(1.0))
        }
        REAL => ColumnStorage::Real {
            bytes: match half(buffer, details, 0, 0)? {
                0 => 2,
                1 => 4,
                2 => 8,
                _ => return None,
            },
        },
        UTF8 => ColumnStorage::Text { bytes: 4 },
        LARGE_UTF8 => ColumnStorage::Text { bytes: 8 },
        UTF8_VIEW => ColumnStorage::TextView,
        BOOL => ColumnStorage::Bits,
        TIME => integer(bytes(bits(1, 32)?)?, true, Meaning::Instant(unit(1)?)),
        TIMESTAMP => integer(8, true, Meaning::Instant(unit(0)?)),
        DURATION => integer(8, true, Meaning::Duration(unit(1)?)),
        _ => ColumnStorage::Other,
    })
}

/// Decodes base64 (RFC 4648, section 4).
pub(super) fn from_base64(text: &str) -> Option<Vec<u8>> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => Some(c - b'A'),
        b'a'..=b'z' => Some(c - b'a' + 26),
        b'0'..=b'9' => Some(c - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    for four in text.trim_end_matches('=').as_bytes().chunks(4) {
        let mut bits = 0_u32;
        for c in four {
            bits = bits << 6 | u32::from(digit(*c)?);
        }
        // Two, three or four digits encode one, two or three bytes.
        bits <<= 6 * (4 - four.len()) + 8;
        let bytes = bits.to_be_bytes();
        out.extend(bytes.iter().take(four.len() * 6 / 8));
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Schema by pyarrow 19 of a column `time` of durations in milliseconds and a column `G0 [um/m]` of reals.
    const MILLISECONDS: &str = "/////6gAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAIAAABMAAAABAAAAMz///8AAAEDEAAAACAAAAAEAAAAAAAAAAkAAABHMCBbdW0vbV0ABgAIAAYABgAAAAAAAgAQABQACAAGAAcADAAAABAAEAAAAAAAARIQAAAAHAAAAAQAAAAAAAAABAAAAHRpbWUAAAAABAAEAAQAAAA=";
    /// Schema by pyarrow 19 of a column `time` of durations in nanoseconds and a column `G0 [um/m]` of reals.
    const NANOSECONDS: &str = "/////6gAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAIAAABIAAAABAAAAND///8AAAEDEAAAABwAAAAEAAAAAAAAAAkAAABHMCBbdW0vbV0AAADG////AAACABAAFAAIAAYABwAMAAAAEAAQAAAAAAABEhAAAAAcAAAABAAAAAAAAAAEAAAAdGltZQAABgAIAAYABgAAAAAAAwA=";

    /// Schema written by pyarrow 19. Its columns are `time`, `P` (note unit = kN), `G1` (notes Units = mm/m and note = x), and `n`.
    const UNITS: &str = "/////6ABAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAQAAABAAQAA0AAAADwAAAAEAAAA4P7//wAAAQIQAAAAHAAAAAQAAAAAAAAAAQAAAG4AAAAIAAwACAAHAAgAAAAAAAABQAAAAIL///8AAAEDFAAAAGwAAAAIAAAAEAAAAAAAAAACAAAARzEAAAIAAAAoAAAABAAAAHT///8QAAAABAAAAAEAAAB4AAAABAAAAG5vdGUAAAAAlP///xQAAAAEAAAABAAAAG1tL20AAAAABQAAAFVuaXRzAAYABgAEAAYAAAABABIAGAAIAAYABwAMAAAAEAAUABIAAAAAAAEDFAAAAEgAAAAIAAAAEAAAAAAAAAABAAAAUAAAAAEAAAAMAAAACAAMAAQACAAIAAAAEAAAAAQAAAACAAAAa04AAAQAAAB1bml0AAAAAMb///8AAAIAEAAUAAgABgAHAAwAAAAQABAAAAAAAAEDEAAAABwAAAAEAAAAAAAAAAQAAAB0aW1lAAAGAAgABgAGAAAAAAACAA==";

    #[test]
    fn units_are_in_the_notes_of_columns() {
        let bytes = from_base64(UNITS).unwrap();
        let units = [("P", "kN"), ("G1", "mm/m")].map(|(c, u)| (c.to_owned(), u.to_owned()));
        assert_eq!(of_schema(&bytes).unwrap().units, HashMap::from(units));
        for i in 0..bytes.len() {
            let _ = of_schema(&bytes[..i]);
        }
    }

    #[test]
    fn durations_are_reported_with_their_unit_and_a_damaged_schema_gives_no_wrong_unit() {
        for (text, worth) in [(MILLISECONDS, 1e-3), (NANOSECONDS, 1e-9)] {
            let bytes = from_base64(text).unwrap();
            let read = of_schema(&bytes).unwrap();
            assert_eq!(read.durations, HashMap::from([("time".to_owned(), worth)]));
            assert!(read.units.is_empty());
            for i in 0..bytes.len() {
                let _ = of_schema(&bytes[..i]);
                let mut other = bytes.clone();
                other[i] ^= 0xff;
                let _ = of_schema(&other);
            }
        }
        assert_eq!(from_base64("Zm9vYmE=").as_deref(), Some(&b"fooba"[..]));
        assert_eq!(from_base64("Zg==").as_deref(), Some(&b"f"[..]));
        assert_eq!(from_base64("a b"), None);
    }

    #[test]
    fn times_that_are_durations_are_in_the_unit_of_their_type() {
        use crate::series::record::{Options, open_record};
        use parquet::data_type::{DoubleType, Int64Type};
        use parquet::file::metadata::KeyValue;
        use parquet::file::properties::WriterProperties;
        use parquet::file::writer::SerializedFileWriter;
        use parquet::schema::parser::parse_message_type;
        use std::sync::Arc;
        for (schema, step) in [(MILLISECONDS, 10), (NANOSECONDS, 10_000_000)] {
            let columns = "message m { required int64 time; required double G0; }";
            let columns = Arc::new(parse_message_type(columns).unwrap());
            let notes = vec![KeyValue::new(KEY.to_owned(), schema.to_owned())];
            let properties = WriterProperties::builder().set_key_value_metadata(Some(notes));
            let mut bytes = Vec::new();
            let mut file =
                SerializedFileWriter::new(&mut bytes, columns, Arc::new(properties.build()))
                    .unwrap();
            let mut group = file.next_row_group().unwrap();
            let times: Vec<i64> = (0..50).map(|i| i * step).collect();
            let mut column = group.next_column().unwrap().unwrap();
            let typed = column.typed::<Int64Type>();
            typed.write_batch(&times, None, None).unwrap();
            column.close().unwrap();
            let mut column = group.next_column().unwrap().unwrap();
            let typed = column.typed::<DoubleType>();
            typed.write_batch(&[1.0; 50], None, None).unwrap();
            column.close().unwrap();
            group.close().unwrap();
            file.close().unwrap();
            let record = open_record(Arc::new(bytes), &Options::default()).unwrap();
            assert!(record.is_time_unit_stated());
            let names: Vec<&str> = record.columns().iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names, ["G0"]);
            assert!(
                (record.clock.rate_hz - 100.0).abs() < 1e-6,
                "{}",
                record.clock.rate_hz
            );
        }
    }
}
