//! Tables of runs in Parquet and Feather files, as text: what reads a table of text then reads them too.

use super::column::Column;
use super::feather::Feather;
use super::open::{Format, format_of};
use super::parquet::Parquet;
use super::reader::{Bytes, Pick, RecordReader};
use super::source::Source;
use crate::series::error::SeriesError;
use std::fmt::Write;
use std::ops::ControlFlow;

/// Numbers that a table may hold.
const MOST_NUMBERS: usize = 20_000_000;
/// The column that names the runs.
const RUN: &str = "run";

/// Returns the table of a Parquet or Feather file as CSV with the column names of the file. The file must have a column `run` in upper or lower case.
/// The result is `None` for any other file.
///
/// # Errors
/// A file that is damaged, or larger than tables are.
pub fn runs_as_csv(bytes: Bytes) -> Result<Option<String>, SeriesError> {
    match format_of((*bytes).as_ref()) {
        Some(Format::Parquet) => {
            let file = Parquet::new(Source::Memory(bytes))?;
            as_csv(&file, || file.texts(RUN))
        }
        Some(Format::Feather) => {
            let file = Feather::new(bytes)?;
            as_csv(&file, || file.texts(RUN))
        }
        _ => Ok(None),
    }
}

/// Returns the table of a file as CSV; `texts` reads its column `run` where that is text.
fn as_csv(
    file: &dyn RecordReader,
    texts: impl Fn() -> Result<Option<Vec<String>>, SeriesError>,
) -> Result<Option<String>, SeriesError> {
    let of_numbers = file.columns().iter().position(Column::is_run);
    let Some(names) = (match of_numbers {
        Some(_) => Some(Vec::new()),
        None => texts()?,
    }) else {
        return Ok(None);
    };
    let is_value = |c: &(usize, &Column)| Some(c.0) != of_numbers;
    let values: Vec<(usize, &Column)> =
        file.columns().iter().enumerate().filter(is_value).collect();
    let pieces = 0..file.n_pieces();
    let rows: usize = pieces.clone().filter_map(|p| file.rows(p)).sum();
    if rows.saturating_mul(values.len() + 1) > MOST_NUMBERS {
        return Err(SeriesError::Broken {
            wrong: format!("a table of {rows} runs and {} columns", values.len()),
            remedy: "divide the file",
        });
    }
    let mut text = RUN.to_owned();
    for (_, column) in &values {
        text.push(',');
        text.push_str(&quote_field(&column.header.whole));
    }
    text.push('\n');
    let mut picks: Vec<Pick> = values.iter().map(|(i, _)| Pick::Column(*i)).collect();
    picks.push(of_numbers.map_or(Pick::Nothing, Pick::Column));
    let mut names = names.into_iter();
    for piece in pieces {
        file.read(piece, &picks, &mut |block| {
            for row in block.values.chunks_exact(picks.len()) {
                let Some((number, values)) = row.split_last() else {
                    continue;
                };
                let name = match of_numbers {
                    Some(_) => number.to_string(),
                    None => names.next().unwrap_or_default(),
                };
                text.push_str(&quote_field(&name));
                for v in values {
                    text.push(',');
                    if v.is_finite() {
                        let _ = write!(text, "{v}");
                    }
                }
                text.push('\n');
            }
            ControlFlow::Continue(())
        })?;
    }
    Ok(Some(text))
}

/// A field of CSV.
fn quote_field(field: &str) -> String {
    match field.contains([',', ';', '\t', '"', '\n', '\r', '#']) {
        true => format!(
            "\"{}\"",
            field.replace('"', "\"\"").replace(['\n', '\r'], " ")
        ),
        false => field.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::basic::{Compression, ZstdLevel};
    use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType};
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    use std::sync::Arc;

    /// Returns three runs of two gauges. The second gauge has no reading in the second run.
    fn runs(name: &str, compression: Compression) -> Vec<u8> {
        let schema = format!(
            "message m {{ required binary {name} (STRING); required double P01; optional float P02; }}"
        );
        let schema = Arc::new(parse_message_type(&schema).unwrap());
        let properties = WriterProperties::builder().set_compression(compression);
        let mut bytes = Vec::new();
        let mut file =
            SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties.build())).unwrap();
        let mut group = file.next_row_group().unwrap();
        let names = ["R1", "R2, again", "R3"].map(ByteArray::from);
        let mut column = group.next_column().unwrap().unwrap();
        let typed = column.typed::<ByteArrayType>();
        typed.write_batch(&names, None, None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        let typed = column.typed::<DoubleType>();
        typed.write_batch(&[1.5, -2.0, 1e-3], None, None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        let typed = column.typed::<FloatType>();
        let levels = [1, 0, 1];
        typed
            .write_batch(&[10.0, 30.0], Some(&levels), None)
            .unwrap();
        column.close().unwrap();
        group.close().unwrap();
        file.close().unwrap();
        bytes
    }

    #[test]
    fn runs_in_every_compression_are_a_table_of_text() {
        for compression in [
            Compression::UNCOMPRESSED,
            Compression::SNAPPY,
            Compression::ZSTD(ZstdLevel::default()),
            Compression::GZIP(Default::default()),
            Compression::BROTLI(Default::default()),
            Compression::LZ4,
            Compression::LZ4_RAW,
        ] {
            let text = runs_as_csv(Arc::new(runs("run", compression))).unwrap();
            let expected = "run,P01,P02\nR1,1.5,10\n\"R2, again\",-2,\nR3,0.001,30\n";
            assert_eq!(text.as_deref(), Some(expected), "{compression:?}");
        }
    }

    #[test]
    fn the_case_of_run_does_not_matter() {
        for name in ["Run", "RUN"] {
            let text = runs_as_csv(Arc::new(runs(name, Compression::SNAPPY))).unwrap();
            assert!(text.is_some_and(|t| t.starts_with("run,P01,P02\nR1,1.5,10\n")));
        }
    }

    #[test]
    fn damaged_files_of_runs_are_refused_or_read_without_a_panic() {
        let bytes = runs("run", Compression::UNCOMPRESSED);
        for i in 0..bytes.len() {
            for bit in [1, 0x80, 0xff] {
                let mut other = bytes.clone();
                other[i] ^= bit;
                let _ = runs_as_csv(Arc::new(other));
            }
            // A file that begins with fewer bytes is not a Parquet file.
            let cut = runs_as_csv(Arc::new(bytes[..i].to_vec()));
            assert!(i < 4 || cut.is_err());
        }
    }

    #[test]
    fn a_record_is_no_table_of_runs() {
        let names = ["A".to_owned()];
        let fill = |from: usize, to: usize, out: &mut Vec<f64>| out.resize(to - from, 1.0);
        let bytes = crate::series::parquet::parquet_bytes(&names, &[], [0.0, 0.01], 10, fill);
        assert_eq!(runs_as_csv(Arc::new(bytes.unwrap())), Ok(None));
    }
}
