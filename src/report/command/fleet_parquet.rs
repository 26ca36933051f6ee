//! `fleet.parquet`: the table of `fleet.csv` for programs.

use super::mistake;
use crate::host::fault::Faults;
use crate::workflow::fleet::Fleet;
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use std::sync::Arc;

const SCHEMA: &str = "message fleet {
    required binary vehicle (UTF8);
    required int64 files;
    required double hours;
    required binary load (UTF8);
    required binary unit (UTF8);
    required double max;
    required double min;
    required double damage;
    required double damage_low;
    required double damage_high;
}";

/// Returns the bytes of the Parquet file.
///
/// # Errors
/// Errors of the writer.
pub(super) fn bytes(fleet: &Fleet) -> Result<Vec<u8>, Faults> {
    encode_fleet(fleet).map_err(|e| mistake("fleet.parquet", &e).into())
}

fn encode_fleet(fleet: &Fleet) -> Result<Vec<u8>, ParquetError> {
    let schema = Arc::new(parse_message_type(SCHEMA)?);
    let properties = WriterProperties::builder()
        .set_created_by("strainbridge".into())
        .build();
    let rows: Vec<_> = fleet.rows().collect();
    let mut out = Vec::new();
    let mut file = SerializedFileWriter::new(&mut out, schema, Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    let mut number = 0;
    while let Some(mut column) = group.next_column()? {
        let text = |of: &dyn Fn(usize) -> String| -> Vec<ByteArray> {
            (0..rows.len())
                .map(|i| ByteArray::from(of(i).into_bytes()))
                .collect()
        };
        match number {
            0 => column.typed::<ByteArrayType>().write_batch(
                &text(&|i| rows[i].0.name.clone()),
                None,
                None,
            )?,
            1 => {
                let files: Vec<i64> = rows.iter().map(|r| r.0.files as i64).collect();
                column
                    .typed::<Int64Type>()
                    .write_batch(&files, None, None)?
            }
            3 => column.typed::<ByteArrayType>().write_batch(
                &text(&|i| rows[i].1.load.clone()),
                None,
                None,
            )?,
            4 => column.typed::<ByteArrayType>().write_batch(
                &text(&|i| rows[i].1.unit.clone()),
                None,
                None,
            )?,
            n => {
                let values: Vec<f64> = rows
                    .iter()
                    .map(|(_, l)| match n {
                        2 => l.hours,
                        5 => l.max.unwrap_or(f64::NAN),
                        6 => l.min.unwrap_or(f64::NAN),
                        7 => l.damage,
                        8 => l.damage_low,
                        _ => l.damage_high,
                    })
                    .collect();
                column
                    .typed::<DoubleType>()
                    .write_batch(&values, None, None)?
            }
        };
        column.close()?;
        number += 1;
    }
    group.close()?;
    file.close()?;
    Ok(out)
}
