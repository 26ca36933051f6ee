//! Parquet: histories written.

use super::error::SeriesError;
use parquet::basic::{Compression, Repetition, Type as Kind};
use parquet::data_type::{DoubleType, FloatType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::sync::Arc;

/// Samples a row group.
const GROUP: usize = 131_072;

/// Beginning of the key of a note on the unit of a column, before its name.
pub const UNIT_OF: &str = "unit of ";

fn parquet_write_error(e: ParquetError) -> SeriesError {
    SeriesError::Broken {
        wrong: format!("it cannot be written as Parquet ({e})"),
        remedy: "report this as an error of the program",
    }
}

/// Returns a Parquet file with a column `time` (s, 64 bits) and a column for each name (32 bits, NaN for missing readings). `notes` become its
/// key-value metadata. `read` appends samples `from .. to`, `names.len()` numbers each.
///
/// # Errors
/// Errors of the writer.
pub fn parquet_bytes(
    names: &[String],
    notes: &[(String, String)],
    [t0, dt]: [f64; 2],
    samples: usize,
    mut read: impl FnMut(usize, usize, &mut Vec<f64>),
) -> Result<Vec<u8>, SeriesError> {
    let column = |name: &str, kind| {
        Type::primitive_type_builder(name, kind)
            .with_repetition(Repetition::REQUIRED)
            .build()
            .map(Arc::new)
    };
    let mut fields = vec![column("time", Kind::DOUBLE).map_err(parquet_write_error)?];
    for name in names {
        fields.push(column(name, Kind::FLOAT).map_err(parquet_write_error)?);
    }
    let schema = Type::group_type_builder("loads")
        .with_fields(fields)
        .build()
        .map_err(parquet_write_error)?;
    let notes = notes
        .iter()
        .map(|(k, v)| KeyValue::new(k.clone(), v.clone()));
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by("strainbridge".into())
        .set_key_value_metadata(Some(notes.collect()))
        .build();
    let mut out = Vec::new();
    let mut file = SerializedFileWriter::new(&mut out, Arc::new(schema), Arc::new(properties))
        .map_err(parquet_write_error)?;
    let n = names.len();
    let mut rows = Vec::new();
    for from in (0..samples).step_by(GROUP) {
        let to = (from + GROUP).min(samples);
        rows.clear();
        read(from, to, &mut rows);
        let mut group = file.next_row_group().map_err(parquet_write_error)?;
        let times: Vec<f64> = (from..to).map(|i| t0 + dt * i as f64).collect();
        let mut next = 0;
        while let Some(mut column) = group.next_column().map_err(parquet_write_error)? {
            let written = if next == 0 {
                column.typed::<DoubleType>().write_batch(&times, None, None)
            } else {
                let values = rows.iter().skip(next - 1).step_by(n);
                let values: Vec<f32> = values.map(|v| *v as f32).collect();
                column.typed::<FloatType>().write_batch(&values, None, None)
            };
            written.map_err(parquet_write_error)?;
            column.close().map_err(parquet_write_error)?;
            next += 1;
        }
        group.close().map_err(parquet_write_error)?;
    }
    file.close().map_err(parquet_write_error)?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::record::{Options, open_record, read_channels};
    use parquet::schema::parser::parse_message_type;

    fn read_parquet(bytes: &[u8], hz: Option<f64>) -> Result<crate::series::Channels, SeriesError> {
        let options = Options {
            declared_hz: hz,
            ..Options::default()
        };
        read_channels(&open_record(Arc::new(bytes.to_vec()), &options)?)
    }

    #[test]
    fn what_is_written_is_read_back_and_damaged_files_are_refused() {
        let names = ["A.FZ".to_owned(), "B [kN]".to_owned()];
        let value = |i: usize, k: usize| (i * 2 + k) as f64;
        let bytes = parquet_bytes(&names, &[], [0.5, 0.01], 200_000, |from, to, out| {
            out.extend((from..to).flat_map(|i| [value(i, 0), value(i, 1)]));
        })
        .unwrap();
        let read = read_parquet(&bytes, None).unwrap();
        assert!((read.rate_hz - 100.0).abs() < 1e-6);
        assert_eq!(read.start_s, 0.5);
        assert_eq!(
            (read.list[1].name.as_str(), read.list[1].unit.as_str()),
            ("B", "kN")
        );
        for k in 0..2 {
            let samples = &read.list[k].samples;
            assert_eq!(samples.len(), 200_000);
            assert!((0..200_000).all(|i| samples[i] == value(i, k)));
        }
        for cut in [0, 4, 100, bytes.len() / 2, bytes.len() - 1] {
            assert!(read_parquet(&bytes[..cut], None).is_err(), "{cut}");
        }
    }

    #[test]
    fn counts_without_a_sign_stay_positive() {
        let schema = "message m { required int32 n (INTEGER(32,false)); required int32 z; }";
        let schema = std::sync::Arc::new(parse_message_type(schema).unwrap());
        let mut bytes = Vec::new();
        let mut file = SerializedFileWriter::new(&mut bytes, schema, Default::default()).unwrap();
        let mut group = file.next_row_group().unwrap();
        while let Some(mut column) = group.next_column().unwrap() {
            let typed = column.typed::<parquet::data_type::Int32Type>();
            typed.write_batch(&[7, -1], None, None).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
        file.close().unwrap();
        let read = read_parquet(&bytes, Some(1.0)).unwrap();
        assert_eq!(read.list[0].samples, [7.0, f64::from(u32::MAX)]);
        assert_eq!(read.list[1].samples, [7.0, -1.0]);
    }

    #[test]
    fn columns_of_a_type_that_is_not_read_are_named_with_it() {
        let schema = "message m { required int32 time (DATE); required fixed_len_byte_array(8) P1 (DECIMAL(12,2)); required int32 P2; }";
        let schema = std::sync::Arc::new(parse_message_type(schema).unwrap());
        let mut bytes = Vec::new();
        let mut file = SerializedFileWriter::new(&mut bytes, schema, Default::default()).unwrap();
        let mut group = file.next_row_group().unwrap();
        for is_decimal in [false, true, false] {
            let mut column = group.next_column().unwrap().unwrap();
            if is_decimal {
                let value = parquet::data_type::FixedLenByteArray::from(vec![0; 8]);
                let typed = column.typed::<parquet::data_type::FixedLenByteArrayType>();
                typed.write_batch(&[value], None, None).unwrap();
            } else {
                let typed = column.typed::<parquet::data_type::Int32Type>();
                typed.write_batch(&[1], None, None).unwrap();
            }
            column.close().unwrap();
        }
        group.close().unwrap();
        file.close().unwrap();
        let open = |wanted: &str, declared_hz| {
            let options = Options {
                declared_hz,
                wanted: vec![wanted.to_owned()],
                ..Options::default()
            };
            open_record(Arc::new(bytes.clone()), &options)
                .err()
                .map(|e| e.to_string())
        };
        let time = open("P2", None).unwrap();
        assert!(
            time.contains("`time` contains dates without a time of day"),
            "{time}"
        );
        let decimal = open("P1", Some(1.0)).unwrap();
        assert!(
            decimal.contains("`P1` contains decimal numbers as bytes"),
            "{decimal}"
        );
        assert_eq!(open("P2", Some(1.0)), None);
    }
}
