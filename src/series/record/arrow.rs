//! Which columns of a Parquet file hold durations: Parquet has no such type, and Arrow says it in a schema of its own beside the file's.

use parquet::file::metadata::FileMetaData;
use std::collections::HashMap;

/// The key under which Arrow keeps its schema.
const KEY: &str = "ARROW:schema";
/// What a message begins with, before its length; old ones begin with the length.
const CONTINUED: u32 = u32::MAX;
/// Number of the type of durations.
const DURATION: u8 = 18;
/// Field of a message: the schema.
const HEADER: usize = 2;
/// Field of a schema: the list of columns.
const FIELDS: usize = 1;
/// Field of a column: its name.
const NAME: usize = 0;
/// Field of a column: the number of its type.
const TYPE: usize = 2;
/// Field of a column: its type.
const DETAILS: usize = 3;
/// Field of a duration.
const UNIT: usize = 0;

/// Seconds in one unit of the durations of a file, by column; nothing of a schema that can't be read.
///
/// # Reference
/// Apache Arrow, Columnar format 1.5: Schema.fbs, Message.fbs; FlatBuffers, internals.
pub(super) fn durations(file: &FileMetaData) -> HashMap<String, f64> {
    let list = file.key_value_metadata().into_iter().flatten();
    let value = list
        .filter(|kv| kv.key == KEY)
        .find_map(|kv| kv.value.as_ref());
    let bytes = value.and_then(|text| from_base64(text));
    bytes.and_then(|b| of_schema(&b)).unwrap_or_default()
}

fn of_schema(bytes: &[u8]) -> Option<HashMap<String, f64>> {
    let buffer = Buffer(bytes);
    let begin = if buffer.word(0)? == CONTINUED { 8 } else { 4 };
    let message = buffer.follow(begin)?;
    let schema = buffer.follow(buffer.field(message, HEADER)?)?;
    let list = buffer.follow(buffer.field(schema, FIELDS)?)?;
    let mut out = HashMap::new();
    for i in 0..buffer.word(list)? as usize {
        let field = buffer.follow(list.checked_add(4 + 4 * i)?)?;
        let kind = buffer.field(field, TYPE).and_then(|at| bytes.get(at));
        if kind != Some(&DURATION) {
            continue;
        }
        let (Some(name), Some(details)) = (
            buffer.text(buffer.follow(buffer.field(field, NAME)?)?),
            buffer
                .field(field, DETAILS)
                .and_then(|at| buffer.follow(at)),
        ) else {
            continue;
        };
        // Milliseconds are what is left out.
        let unit = buffer
            .field(details, UNIT)
            .map_or(Some(1), |at| buffer.half(at));
        let worth = match unit {
            Some(0) => 1.0,
            Some(1) => 1e-3,
            Some(2) => 1e-6,
            Some(3) => 1e-9,
            _ => continue,
        };
        out.insert(name.to_owned(), worth);
    }
    Some(out)
}

/// Tables of FlatBuffers: places count from the first byte.
struct Buffer<'a>(&'a [u8]);

impl<'a> Buffer<'a> {
    fn word(&self, at: usize) -> Option<u32> {
        let bytes = self.0.get(at..)?.first_chunk()?;
        Some(u32::from_le_bytes(*bytes))
    }

    fn half(&self, at: usize) -> Option<u16> {
        let bytes = self.0.get(at..)?.first_chunk()?;
        Some(u16::from_le_bytes(*bytes))
    }

    /// Where the offset at a place leads.
    fn follow(&self, at: usize) -> Option<usize> {
        at.checked_add(self.word(at)? as usize)
    }

    /// Where field `number` of a table stands; `None` where it was left out.
    fn field(&self, table: usize, number: usize) -> Option<usize> {
        let back = self.word(table)? as i32;
        let list = (table as i64).checked_sub(i64::from(back))?;
        let list = usize::try_from(list).ok()?;
        let place = 4 + 2 * number;
        if place >= usize::from(self.half(list)?) {
            return None;
        }
        let offset = self.half(list.checked_add(place)?)?;
        (offset > 0).then(|| table.checked_add(usize::from(offset)))?
    }

    fn text(&self, at: usize) -> Option<&'a str> {
        let length = self.word(at)? as usize;
        let bytes = self.0.get(at.checked_add(4)?..)?.get(..length)?;
        std::str::from_utf8(bytes).ok()
    }
}

/// RFC 4648, section 4.
fn from_base64(text: &str) -> Option<Vec<u8>> {
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
        // Two, three or four digits are one, two or three bytes.
        bits <<= 6 * (4 - four.len()) + 8;
        let bytes = bits.to_be_bytes();
        out.extend(bytes.iter().take(four.len() * 6 / 8));
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As pyarrow 19 writes it of a column `time` of durations in milliseconds and one `G0 [um/m]` of reals.
    const MILLISECONDS: &str = "/////6gAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAIAAABMAAAABAAAAMz///8AAAEDEAAAACAAAAAEAAAAAAAAAAkAAABHMCBbdW0vbV0ABgAIAAYABgAAAAAAAgAQABQACAAGAAcADAAAABAAEAAAAAAAARIQAAAAHAAAAAQAAAAAAAAABAAAAHRpbWUAAAAABAAEAAQAAAA=";
    /// The same in nanoseconds.
    const NANOSECONDS: &str = "/////6gAAAAQAAAAAAAKAAwABgAFAAgACgAAAAABBAAMAAAACAAIAAAABAAIAAAABAAAAAIAAABIAAAABAAAAND///8AAAEDEAAAABwAAAAEAAAAAAAAAAkAAABHMCBbdW0vbV0AAADG////AAACABAAFAAIAAYABwAMAAAAEAAQAAAAAAABEhAAAAAcAAAABAAAAAAAAAAEAAAAdGltZQAABgAIAAYABgAAAAAAAwA=";

    #[test]
    fn durations_are_told_with_their_unit_and_a_damaged_schema_tells_nothing_wrong() {
        for (text, worth) in [(MILLISECONDS, 1e-3), (NANOSECONDS, 1e-9)] {
            let bytes = from_base64(text).unwrap();
            let read = of_schema(&bytes).unwrap();
            assert_eq!(read, HashMap::from([("time".to_owned(), worth)]));
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
