//! Numbers of a Feather file as they are stored.

use crate::series::record::arrow::ColumnStorage;
use crate::series::record::strip::of_half;
use std::borrow::Cow;

/// Values of one field in one batch.
pub(super) struct Values<'a> {
    pub stored: ColumnStorage,
    /// One bit for each row, which states whether the row has a value. Empty if no value is missing.
    pub validity: Cow<'a, [u8]>,
    pub data: Cow<'a, [u8]>,
    /// Dictionary, if the stored values are indices into a dictionary.
    pub dictionary: Option<Vec<f64>>,
}

impl Values<'_> {
    /// Writes the rows from number `first` on, multiplied by `worth` and with `off` subtracted. A null gives NaN.
    pub(super) fn write_rows(&self, first: usize, worth: f64, off: f64, out: &mut [f64]) {
        let data = &*self.data;
        match self.stored {
            ColumnStorage::Bits => {
                for (slot, i) in out.iter_mut().zip(first..) {
                    *slot = f64::from(u8::from(bit(data, i)));
                }
            }
            ColumnStorage::Integer {
                bytes, is_signed, ..
            } => match (bytes, is_signed) {
                (1, true) => decode_numbers(data, first, out, |b| f64::from(i8::from_le_bytes(b))),
                (1, false) => decode_numbers(data, first, out, |b| f64::from(u8::from_le_bytes(b))),
                (2, true) => decode_numbers(data, first, out, |b| f64::from(i16::from_le_bytes(b))),
                (2, false) => {
                    decode_numbers(data, first, out, |b| f64::from(u16::from_le_bytes(b)))
                }
                (4, true) => decode_numbers(data, first, out, |b| f64::from(i32::from_le_bytes(b))),
                (4, false) => {
                    decode_numbers(data, first, out, |b| f64::from(u32::from_le_bytes(b)))
                }
                (_, true) => decode_numbers(data, first, out, |b| i64::from_le_bytes(b) as f64),
                (_, false) => decode_numbers(data, first, out, |b| u64::from_le_bytes(b) as f64),
            },
            ColumnStorage::Real { bytes: 2 } => {
                decode_numbers(data, first, out, |b| of_half(u16::from_le_bytes(b)));
            }
            ColumnStorage::Real { bytes: 4 } => {
                decode_numbers(data, first, out, |b| f64::from(f32::from_le_bytes(b)));
            }
            ColumnStorage::Real { .. } => decode_numbers(data, first, out, f64::from_le_bytes),
            ColumnStorage::Text { .. } | ColumnStorage::TextView | ColumnStorage::Other => {}
        }
        for (slot, i) in out.iter_mut().zip(first..) {
            if !is_valid(&self.validity, i) {
                *slot = f64::NAN;
                continue;
            }
            if let Some(entries) = &self.dictionary {
                let number = if *slot >= 0.0 {
                    *slot as usize
                } else {
                    usize::MAX
                };
                *slot = entries.get(number).copied().unwrap_or(f64::NAN);
            }
            *slot = *slot * worth - off;
        }
    }
}

fn decode_numbers<const N: usize>(
    data: &[u8],
    first: usize,
    out: &mut [f64],
    of: impl Fn([u8; N]) -> f64,
) {
    let stored = data.as_chunks().0.get(first..).unwrap_or_default();
    for (slot, bytes) in out.iter_mut().zip(stored) {
        *slot = of(*bytes);
    }
}

fn bit(bits: &[u8], i: usize) -> bool {
    bits.get(i / 8).is_some_and(|b| b >> (i % 8) & 1 == 1)
}

/// Returns whether a row has a value. No bits are stored if every row has a value.
pub(super) fn is_valid(validity: &[u8], i: usize) -> bool {
    validity.is_empty() || bit(validity, i)
}
