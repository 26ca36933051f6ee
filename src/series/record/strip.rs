//! Decoded columns of a Parquet file, in memory that is used again.

use crate::series::error::SeriesError;
use parquet::basic::SortOrder;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, FixedLenByteArray};
use parquet::errors::ParquetError;
use parquet::schema::types::ColumnDescriptor;

/// Rows of a column that are decoded at a time.
const ROWS: usize = 8192;

/// Memory for values of one column, which is used again for the next column.
#[derive(Default)]
pub(super) struct Buffers {
    levels: Vec<i16>,
    bools: Vec<bool>,
    i32s: Vec<i32>,
    i64s: Vec<i64>,
    halves: Vec<FixedLenByteArray>,
}

/// Decoded rows of one column. 32-bit reals are stored unchanged, other numbers in 64 bits.
#[derive(Default)]
pub(super) struct Strip {
    singles: Vec<f32>,
    doubles: Vec<f64>,
}

impl Strip {
    /// Decodes the next rows of a column, which replace the previous rows.
    ///
    /// # Errors
    /// Pages that can't be decoded, or too few of them.
    pub(super) fn decode(
        &mut self,
        reader: &mut ColumnReader,
        column: &ColumnDescriptor,
        rows: usize,
        b: &mut Buffers,
    ) -> Result<(), SeriesError> {
        self.singles.clear();
        self.doubles.clear();
        let most = column.max_def_level();
        let unsigned = column.sort_order() == SortOrder::UNSIGNED;
        let (out, levels) = (&mut self.doubles, &mut b.levels);
        let nan = f64::NAN;
        match reader {
            ColumnReader::BoolColumnReader(r) => {
                let of = |v: &bool| f64::from(u8::from(*v));
                numbers(r, most, rows, &mut b.bools, levels, out, nan, of)
            }
            ColumnReader::Int32ColumnReader(r) if unsigned => {
                let of = |v: &i32| f64::from(v.cast_unsigned());
                numbers(r, most, rows, &mut b.i32s, levels, out, nan, of)
            }
            ColumnReader::Int64ColumnReader(r) if unsigned => {
                let of = |v: &i64| v.cast_unsigned() as f64;
                numbers(r, most, rows, &mut b.i64s, levels, out, nan, of)
            }
            ColumnReader::Int32ColumnReader(r) => {
                let of = |v: &i32| f64::from(*v);
                numbers(r, most, rows, &mut b.i32s, levels, out, nan, of)
            }
            ColumnReader::Int64ColumnReader(r) => {
                let of = |v: &i64| *v as f64;
                numbers(r, most, rows, &mut b.i64s, levels, out, nan, of)
            }
            ColumnReader::FloatColumnReader(r) => {
                reals(r, most, rows, levels, &mut self.singles, f32::NAN)
            }
            ColumnReader::DoubleColumnReader(r) => reals(r, most, rows, levels, out, nan),
            ColumnReader::FixedLenByteArrayColumnReader(r) => {
                let of = |v: &FixedLenByteArray| {
                    let bytes = v.data().first_chunk();
                    bytes.map_or(nan, |b| of_half(u16::from_le_bytes(*b)))
                };
                numbers(r, most, rows, &mut b.halves, levels, out, nan, of)
            }
            _ => Ok(()),
        }?;
        if self.singles.len().max(self.doubles.len()) == rows {
            Ok(())
        } else {
            let wrong = "a column ends before its row group";
            Err(read_error(ParquetError::EOF(wrong.into())))
        }
    }

    /// Writes the rows from number `first` on to `out`, multiplied by `worth` and with `off` subtracted.
    pub(super) fn write_rows(&self, first: usize, worth: f64, off: f64, out: &mut [f64]) {
        if let Some(singles) = self.singles.get(first..).filter(|s| !s.is_empty()) {
            pulp::Arch::new().dispatch(|| {
                for (slot, v) in out.iter_mut().zip(singles) {
                    *slot = f64::from(*v) * worth - off;
                }
            });
        } else {
            let doubles = self.doubles.get(first..).unwrap_or_default();
            for (slot, v) in out.iter_mut().zip(doubles) {
                *slot = v * worth - off;
            }
        }
    }
}

/// Decodes `rows` rows of a column into `out`, or as many as there are; `blank` for a null.
fn numbers<T: DataType, O: Clone>(
    reader: &mut ColumnReaderImpl<T>,
    most: i16,
    rows: usize,
    values: &mut Vec<T::T>,
    levels: &mut Vec<i16>,
    out: &mut Vec<O>,
    blank: O,
    number: impl Fn(&T::T) -> O,
) -> Result<(), SeriesError> {
    while out.len() < rows {
        levels.clear();
        values.clear();
        let known = if most > 0 { Some(&mut *levels) } else { None };
        let read = reader.read_records(ROWS.min(rows - out.len()), known, None, values);
        let (records, _, _) = read.map_err(read_error)?;
        if records == 0 {
            return Ok(());
        }
        let mut known = values.iter().map(&number);
        if known.len() == records {
            out.extend(known);
        } else {
            out.extend(levels.iter().map(|l| {
                if *l == most {
                    known.next().unwrap_or_else(|| blank.clone())
                } else {
                    blank.clone()
                }
            }));
        }
    }
    Ok(())
}

/// Decodes texts into `out` up to number `end`. A null becomes a blank.
pub(super) fn texts(
    reader: &mut ColumnReaderImpl<ByteArrayType>,
    most: i16,
    end: usize,
    out: &mut Vec<String>,
) -> Result<(), SeriesError> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    let text = |v: &ByteArray| String::from_utf8_lossy(v.data()).into_owned();
    numbers(
        reader,
        most,
        end,
        &mut values,
        &mut levels,
        out,
        String::new(),
        text,
    )
}

/// [`numbers`] of a column of reals, decoded where they stay.
fn reals<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    most: i16,
    rows: usize,
    levels: &mut Vec<i16>,
    out: &mut Vec<T::T>,
    blank: T::T,
) -> Result<(), SeriesError>
where
    T::T: Copy,
{
    while out.len() < rows {
        levels.clear();
        let first = out.len();
        let known = if most > 0 { Some(&mut *levels) } else { None };
        let read = reader.read_records(ROWS.min(rows - first), known, None, out);
        let (records, _, _) = read.map_err(read_error)?;
        if records == 0 {
            return Ok(());
        }
        // Move each known value to its row, from the last to the first. A value never moves towards the start, so no unmoved value is
        // overwritten.
        let mut known = out.len();
        out.resize(first + records, blank);
        if known == out.len() {
            continue;
        }
        for (i, level) in levels.iter().enumerate().rev() {
            let here = if *level == most && known > first {
                known -= 1;
                out.get(known).copied().unwrap_or(blank)
            } else {
                blank
            };
            if let Some(slot) = out.get_mut(first + i) {
                *slot = here;
            }
        }
    }
    Ok(())
}

/// Returns the value of a 16-bit real (IEEE 754: one bit of sign, five of exponent, ten of fraction).
pub(super) fn of_half(bits: u16) -> f64 {
    let fraction = f64::from(bits & 0x3ff) / 1024.0;
    let size = match i32::from(bits >> 10 & 0x1f) {
        0 => fraction * 2_f64.powi(-14),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        exponent => (1.0 + fraction) * 2_f64.powi(exponent - 15),
    };
    match bits >> 15 {
        0 => size,
        _ => -size,
    }
}

/// Returns the error of a Parquet file, with its remedy.
pub(super) fn read_error(e: ParquetError) -> SeriesError {
    SeriesError::Broken {
        wrong: format!("it cannot be read as Parquet ({e})"),
        remedy: "write it again, columns of numbers and one `time` in seconds",
    }
}

#[cfg(test)]
mod tests {
    use super::of_half;

    #[test]
    fn reals_of_16_bits_are_those_of_the_standard() {
        for (bits, value) in [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x3555, 0.333_251_953_125),
            (0x7bff, 65_504.0),
            (0x0001, 5.960_464_477_539_063e-8),
            (0x7c00, f64::INFINITY),
            (0x0000, 0.0),
        ] {
            assert_eq!(of_half(bits), value, "{bits:#x}");
        }
        assert!(of_half(0x7e00).is_nan());
    }
}
