//! Parquet: records read, histories written.

use super::channels::{Channel, Channels, SeriesError};
use super::csv::{name_and_unit, rate_of};
use bytes::Bytes;
use parquet::basic::{
    Compression, ConvertedType, LogicalType, Repetition, SortOrder, TimeUnit, Type as Kind,
};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType, FloatType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnDescriptor, Type};
use std::sync::Arc;

/// Values taken at a time.
const BATCH: usize = 65_536;
/// Samples a row group.
const GROUP: usize = 131_072;

/// The record in a table: a column a channel, a row a sample. A column `t` or `time` gives the times: seconds, or a timestamp. Columns of
/// numbers alone are read; a name `a_body [m/s2]` carries a unit; a null is a missing sample (NaN).
///
/// # Errors
/// A file that can't be read, uneven times, a rate other than the declared one.
pub fn read_parquet(bytes: &[u8], declared_hz: Option<f64>) -> Result<Channels, SeriesError> {
    let file = SerializedFileReader::new(Bytes::copy_from_slice(bytes)).map_err(broken)?;
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    // Column of the file, its name and unit, the number of one stored unit.
    let columns: Vec<(usize, (String, String), f64)> = schema
        .columns()
        .iter()
        .enumerate()
        .filter(|(_, c)| c.max_rep_level() == 0)
        .filter_map(|(i, c)| Some((i, name_and_unit(c.name().as_bytes()), scale(c)?)))
        .collect();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group).map_err(broken)?;
        for ((i, _, scale), out) in columns.iter().zip(&mut values) {
            let descriptor = schema.column(*i);
            let reader = group.get_column_reader(*i).map_err(broken)?;
            append(reader, &descriptor, *scale, out)?;
        }
    }
    let is_time = |name: &str| matches!(name.to_ascii_lowercase().as_str(), "t" | "time");
    let time = columns.iter().position(|c| is_time(&c.1.0));
    let (rate_hz, start_s) = match time.and_then(|t| values.get(t)) {
        Some(t) => rate_of(t, &(1..=t.len()).collect::<Vec<_>>(), declared_hz)?,
        None => (declared_hz.ok_or(SeriesError::NoRate)?, 0.0),
    };
    let list = columns
        .into_iter()
        .zip(values)
        .enumerate()
        .filter(|(k, _)| Some(*k) != time)
        .map(|(_, ((_, (name, unit), _), samples))| Channel {
            name,
            unit,
            samples,
        })
        .collect();
    Ok(Channels {
        start_s,
        ..Channels::from_list(rate_hz, list)?
    })
}

fn broken(e: ParquetError) -> SeriesError {
    SeriesError::Parquet(e.to_string())
}

/// What one stored unit is worth: seconds for timestamps, 1 for plain numbers; `None` for what is no number.
fn scale(c: &ColumnDescriptor) -> Option<f64> {
    let of_unit = |unit: &TimeUnit| match unit {
        TimeUnit::MILLIS => 1e-3,
        TimeUnit::MICROS => 1e-6,
        TimeUnit::NANOS => 1e-9,
    };
    match (c.physical_type(), c.logical_type_ref()) {
        (Kind::INT32 | Kind::INT64, Some(LogicalType::Timestamp(t))) => Some(of_unit(&t.unit)),
        (Kind::INT32 | Kind::INT64, Some(LogicalType::Time(t))) => Some(of_unit(&t.unit)),
        (Kind::INT32 | Kind::INT64, Some(LogicalType::Decimal(d))) => Some(10_f64.powi(-d.scale)),
        (Kind::INT32 | Kind::INT64, Some(LogicalType::Date)) => None,
        (Kind::INT32 | Kind::INT64, _) => match c.converted_type() {
            ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIME_MILLIS => Some(1e-3),
            ConvertedType::TIMESTAMP_MICROS | ConvertedType::TIME_MICROS => Some(1e-6),
            _ => Some(1.0),
        },
        (Kind::BOOLEAN | Kind::FLOAT | Kind::DOUBLE, _) => Some(1.0),
        _ => None,
    }
}

/// Appends a column of a row group.
fn append(
    reader: ColumnReader,
    column: &ColumnDescriptor,
    scale: f64,
    out: &mut Vec<f64>,
) -> Result<(), SeriesError> {
    let max_def = column.max_def_level();
    let unsigned = column.sort_order() == SortOrder::UNSIGNED;
    match reader {
        ColumnReader::BoolColumnReader(r) => {
            numbers(r, max_def, |v| f64::from(u8::from(*v)), scale, out)
        }
        ColumnReader::Int32ColumnReader(r) if unsigned => {
            numbers(r, max_def, |v| f64::from(v.cast_unsigned()), scale, out)
        }
        ColumnReader::Int64ColumnReader(r) if unsigned => {
            numbers(r, max_def, |v| v.cast_unsigned() as f64, scale, out)
        }
        ColumnReader::Int32ColumnReader(r) => numbers(r, max_def, |v| f64::from(*v), scale, out),
        ColumnReader::Int64ColumnReader(r) => numbers(r, max_def, |v| *v as f64, scale, out),
        ColumnReader::FloatColumnReader(r) => numbers(r, max_def, |v| f64::from(*v), scale, out),
        ColumnReader::DoubleColumnReader(r) => numbers(r, max_def, |v| *v, scale, out),
        _ => Ok(()),
    }
}

fn numbers<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    max_def: i16,
    number: impl Fn(&T::T) -> f64,
    scale: f64,
    out: &mut Vec<f64>,
) -> Result<(), SeriesError> {
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    loop {
        levels.clear();
        values.clear();
        let read = reader.read_records(BATCH, Some(&mut levels), None, &mut values);
        let (records, _, _) = read.map_err(broken)?;
        if records == 0 {
            return Ok(());
        }
        let mut known = values.iter().map(|v| scale * number(v));
        if max_def == 0 {
            out.extend(known);
        } else {
            out.extend(levels.iter().map(|l| {
                if *l == max_def {
                    known.next().unwrap_or(f64::NAN)
                } else {
                    f64::NAN
                }
            }));
        }
    }
}

/// A file with a column `time` (s, 64 bits) and one a name (32 bits, NaN where nothing was measured), `notes` as its key-value metadata.
/// `read` appends samples `from .. to`, `names.len()` numbers each.
///
/// # Errors
/// What the writer refuses.
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
    let mut fields = vec![column("time", Kind::DOUBLE).map_err(broken)?];
    for name in names {
        fields.push(column(name, Kind::FLOAT).map_err(broken)?);
    }
    let schema = Type::group_type_builder("loads")
        .with_fields(fields)
        .build()
        .map_err(broken)?;
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
        .map_err(broken)?;
    let n = names.len();
    let mut rows = Vec::new();
    for from in (0..samples).step_by(GROUP) {
        let to = (from + GROUP).min(samples);
        rows.clear();
        read(from, to, &mut rows);
        let mut group = file.next_row_group().map_err(broken)?;
        let times: Vec<f64> = (from..to).map(|i| t0 + dt * i as f64).collect();
        let mut next = 0;
        while let Some(mut column) = group.next_column().map_err(broken)? {
            let written = if next == 0 {
                column.typed::<DoubleType>().write_batch(&times, None, None)
            } else {
                let values = rows.iter().skip(next - 1).step_by(n);
                let values: Vec<f32> = values.map(|v| *v as f32).collect();
                column.typed::<FloatType>().write_batch(&values, None, None)
            };
            written.map_err(broken)?;
            column.close().map_err(broken)?;
            next += 1;
        }
        group.close().map_err(broken)?;
    }
    file.close().map_err(broken)?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::schema::parser::parse_message_type;

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
}
