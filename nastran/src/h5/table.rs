//! Reads a dataset of records by field name, in windows of rows.

use super::H5Error;
use super::chunk::Chunks;
use hdf5_pure::{Dataset, Datatype, DatatypeByteOrder, File};

/// Largest compression ratio of deflate, 1032 to 1 (zlib, technical details). A table that states a larger size is damaged.
const MOST_DEFLATE: u64 = 1032;
/// Approximate size in bytes of the windows in which records are read. Memory use follows this size.
const WINDOW_BYTES: u64 = 4 << 20;
/// The largest chunk that is unpacked; writers stay near 1 MB.
const MOST_CHUNK_BYTES: u64 = 16 << 20;

/// A dataset whose elements are records.
pub(super) struct Table<'f> {
    pub path: String,
    pub rows: u64,
    file: &'f [u8],
    dataset: Dataset,
    chunks: Option<Chunks>,
    record: usize,
    fields: Vec<(String, Field)>,
}

/// One field of the record: `count` numbers of `size` bytes from `offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Field {
    offset: usize,
    size: usize,
    big_endian: bool,
    number: Number,
    /// Entries of an array field, 1 otherwise.
    pub count: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    Signed,
    Unsigned,
    Float,
}

impl<'f> Table<'f> {
    /// Opens the dataset `path` and checks that its sizes are possible in a file of that size.
    pub(super) fn open(file: &'f File, path: &str) -> Result<Self, H5Error> {
        let fail = |e: hdf5_pure::Error| H5Error::Container {
            path: path.to_string(),
            reason: e.to_string(),
        };
        let dataset = file.dataset(path).map_err(fail)?;
        let Datatype::Compound { size, members } = dataset.datatype().map_err(fail)? else {
            return Err(H5Error::NotDecoded {
                path: path.to_string(),
            });
        };
        let record = size as usize;
        let rows = match *dataset.shape().map_err(fail)? {
            [n] => n,
            ref other => {
                return Err(H5Error::Container {
                    path: path.to_string(),
                    reason: format!("{} dimensions, expected 1", other.len()),
                });
            }
        };
        let file_bytes = file.as_bytes().len() as u64;
        let (claimed, possible) = (
            rows.saturating_mul(u64::from(size)),
            file_bytes.saturating_mul(MOST_DEFLATE),
        );
        let rows_a_chunk = dataset
            .chunk_shape()
            .map_err(fail)?
            .map_or(0, |c| c.iter().fold(1_u64, |a, &b| a.saturating_mul(b)));
        let chunk = rows_a_chunk.saturating_mul(u64::from(size));
        if claimed > possible
            || chunk > MOST_CHUNK_BYTES.max(2 * claimed.min(file_bytes))
            || size == 0
        {
            return Err(H5Error::TooLarge {
                path: path.to_string(),
                claimed: claimed.max(chunk),
                possible,
            });
        }
        let fields = members
            .iter()
            .filter_map(|m| Some((m.name.clone(), field(m.byte_offset, &m.datatype, record)?)))
            .collect();
        let chunks = Chunks::from_dataset(&dataset, rows_a_chunk).map_err(fail)?;
        Ok(Self {
            path: path.to_string(),
            rows,
            file: file.as_bytes(),
            dataset,
            chunks,
            record,
            fields,
        })
    }

    /// Returns the field of this name, if the table has it and it is a number or an array of numbers.
    pub(super) fn field(&self, name: &str) -> Option<Field> {
        self.fields.iter().find(|(n, _)| n == name).map(|&(_, f)| f)
    }

    /// Returns the field of this name, or an error with the name.
    pub(super) fn need(&self, name: &'static str) -> Result<Field, H5Error> {
        self.field(name).ok_or_else(|| H5Error::MissingField {
            path: self.path.clone(),
            field: name,
        })
    }

    /// Calls `each` with the bytes of every record of rows `start .. start + count`.
    pub(super) fn each_record(
        &self,
        start: u64,
        count: u64,
        mut each: impl FnMut(&[u8]) -> Result<(), H5Error>,
    ) -> Result<(), H5Error> {
        let end = start.saturating_add(count).min(self.rows);
        let window = (WINDOW_BYTES / self.record as u64).max(1);
        let mut at = start;
        while at < end {
            if let Some(chunks) = &self.chunks {
                let (bytes, next) = chunks.records(self.file, &self.path, at, self.record)?;
                let n = usize::try_from(next.min(end) - at).unwrap_or(usize::MAX);
                bytes
                    .chunks_exact(self.record)
                    .take(n)
                    .try_for_each(&mut each)?;
                at = next;
                continue;
            }
            let n = window.min(end - at);
            let bytes = self
                .dataset
                .read_raw_rows(at, n)
                .map_err(|e| self.damage_error(e.to_string()))?;
            if bytes.len() as u64 != n * self.record as u64 {
                return Err(self.damage_error(format!("{} bytes for {n} records", bytes.len())));
            }
            bytes.chunks_exact(self.record).try_for_each(&mut each)?;
            at += n;
        }
        Ok(())
    }

    fn damage_error(&self, reason: String) -> H5Error {
        H5Error::Container {
            path: self.path.clone(),
            reason,
        }
    }
}

fn field(offset: u64, datatype: &Datatype, record: usize) -> Option<Field> {
    let offset = usize::try_from(offset).ok()?;
    let (scalar, count) = match datatype {
        Datatype::Array {
            base_type,
            dimensions,
        } => (
            base_type.as_ref(),
            dimensions
                .iter()
                .try_fold(1_usize, |a, &d| a.checked_mul(d as usize))?,
        ),
        other => (other, 1),
    };
    let (size, order, number) = match scalar {
        Datatype::FixedPoint {
            size,
            byte_order,
            layout,
        } => (
            *size,
            byte_order,
            if layout.signed {
                Number::Signed
            } else {
                Number::Unsigned
            },
        ),
        Datatype::FloatingPoint {
            size, byte_order, ..
        } => (*size, byte_order, Number::Float),
        _ => return None,
    };
    let size = size as usize;
    let known = matches!(
        (number, size),
        (Number::Float, 4 | 8) | (Number::Signed | Number::Unsigned, 1 | 2 | 4 | 8)
    );
    let inside = offset.checked_add(size.checked_mul(count)?)? <= record;
    (known && inside && count > 0).then_some(Field {
        offset,
        size,
        big_endian: *order == DatatypeByteOrder::BigEndian,
        number,
        count,
    })
}

impl Field {
    fn bits(self, record: &[u8], k: usize) -> Option<u64> {
        let start = self.offset.checked_add(k.checked_mul(self.size)?)?;
        let bytes = record.get(start..start.checked_add(self.size)?)?;
        let push = |acc: u64, b: &u8| acc << 8 | u64::from(*b);
        Some(if self.big_endian {
            bytes.iter().fold(0, push)
        } else {
            bytes.iter().rev().fold(0, push)
        })
    }

    /// Returns entry `k` as a real; NaN outside the array.
    pub(super) fn read_real(self, record: &[u8], k: usize) -> f64 {
        match (self.bits(record, k), self.number, self.size) {
            (None, ..) => f64::NAN,
            (Some(b), Number::Float, 4) => f64::from(f32::from_bits(b as u32)),
            (Some(b), Number::Float, _) => f64::from_bits(b),
            (Some(_), ..) => self.integer(record, k) as f64,
        }
    }

    /// Returns entry `k` as an integer; 0 outside the array and for reals.
    pub(super) fn integer(self, record: &[u8], k: usize) -> i64 {
        let Some(bits) = self.bits(record, k) else {
            return 0;
        };
        let unused = 64_u32.saturating_sub(8 * self.size as u32);
        match self.number {
            Number::Signed => (bits << unused) as i64 >> unused,
            Number::Unsigned => i64::try_from(bits).unwrap_or(i64::MAX),
            Number::Float => 0,
        }
    }

    /// Returns entry `k` as an id; 0 if it is negative or too large.
    pub(super) fn id(self, record: &[u8], k: usize) -> u32 {
        u32::try_from(self.integer(record, k)).unwrap_or(0)
    }
}
