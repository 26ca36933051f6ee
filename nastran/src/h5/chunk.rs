//! Unpacks the chunks of a compressed table.
//!
//! MSC Nastran 2020 applies deflate first and shuffle after it, so the shuffled bytes may have any length. The HDF5 library then shuffles whole
//! elements and copies the leftover bytes after them. `hdf5-pure` 0.47 refuses such a length, so this file unpacks the chunks.
//!
//! # Reference
//! HDF5 library, `H5Zshuffle.c` (leftover bytes) and file format specification, filter pipeline message.

use super::H5Error;
use hdf5_pure::{Chunk, Dataset, Filter};
use std::io::Read;

const DEFLATE: u16 = 1;
const SHUFFLE: u16 = 2;
const FLETCHER32: u16 = 3;

/// Chunks of a one-dimensional table, by first row.
pub(super) struct Chunks {
    filters: Vec<Filter>,
    rows_a_chunk: u64,
    list: Vec<Chunk>,
}

impl Chunks {
    /// Returns `None` if the table is not chunked, or is packed with filters other than deflate, shuffle and Fletcher's checksum.
    pub(super) fn from_dataset(
        dataset: &Dataset,
        rows_a_chunk: u64,
    ) -> Result<Option<Self>, hdf5_pure::Error> {
        let filters = dataset.filter_pipeline();
        let ours = filters
            .iter()
            .all(|f| matches!(f.id, DEFLATE | SHUFFLE | FLETCHER32));
        if !dataset.is_chunked() || !ours || rows_a_chunk == 0 {
            return Ok(None);
        }
        let mut list = dataset.chunks()?;
        list.sort_by_key(|c| c.offset.first().copied());
        Ok(Some(Self {
            filters,
            rows_a_chunk,
            list,
        }))
    }

    /// Returns the records of rows `start .. end`, and `end`, where `end` is the end of the chunk that contains row `start`.
    ///
    /// # Errors
    /// [`H5Error::Container`] if no chunk contains the row, or if the chunk's bytes do not unpack to a chunk of records.
    pub(super) fn records(
        &self,
        file: &[u8],
        path: &str,
        start: u64,
        record: usize,
    ) -> Result<(Vec<u8>, u64), H5Error> {
        let damaged = |reason: &str| H5Error::Container {
            path: path.to_string(),
            reason: format!("row {start}: {reason}"),
        };
        let first = start / self.rows_a_chunk * self.rows_a_chunk;
        let at = self
            .list
            .binary_search_by_key(&Some(first), |c| c.offset.first().copied());
        let chunk = at
            .ok()
            .and_then(|i| self.list.get(i))
            .ok_or_else(|| damaged("no chunk is stored for it"))?;
        let stored = usize::try_from(chunk.address)
            .ok()
            .zip(usize::try_from(chunk.storage_size).ok());
        let stored = stored
            .and_then(|(a, n)| file.get(a..a.checked_add(n)?))
            .ok_or_else(|| damaged("its chunk is outside the file"))?;
        let whole = usize::try_from(self.rows_a_chunk)
            .unwrap_or(usize::MAX)
            .saturating_mul(record);
        let mut bytes = stored.to_vec();
        for (i, filter) in self.filters.iter().enumerate().rev() {
            if chunk.filter_mask.checked_shr(i as u32).unwrap_or(0) & 1 == 1 {
                continue;
            }
            bytes = match filter.id {
                // The four bytes of Fletcher's checksum may still follow the content.
                DEFLATE => inflate(&bytes, whole.saturating_add(4))
                    .ok_or_else(|| damaged("its chunk does not inflate"))?,
                SHUFFLE => unshuffle(
                    &bytes,
                    filter.client_data.first().map_or(0, |&n| n as usize),
                ),
                _ => bytes
                    .get(..bytes.len().saturating_sub(4))
                    .unwrap_or(&[])
                    .to_vec(),
            };
        }
        if bytes.len() != whole {
            return Err(damaged("its chunk has another size than declared"));
        }
        let skipped = usize::try_from(start - first)
            .unwrap_or(usize::MAX)
            .saturating_mul(record);
        Ok((
            bytes.split_off(skipped.min(whole)),
            first.saturating_add(self.rows_a_chunk),
        ))
    }
}

/// Inflates at most `limit` bytes of a zlib stream; `None` if the stream is damaged or longer.
fn inflate(packed: &[u8], limit: usize) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    let most = u64::try_from(limit).ok()?.checked_add(1)?;
    flate2::read::ZlibDecoder::new(packed)
        .take(most)
        .read_to_end(&mut out)
        .ok()?;
    (out.len() <= limit).then_some(out)
}

/// Undoes the byte shuffle. Plane `j` contains byte `j` of every element; leftover bytes follow the planes.
fn unshuffle(data: &[u8], element: usize) -> Vec<u8> {
    let n = data.len().checked_div(element).unwrap_or(0);
    if element <= 1 || n <= 1 {
        return data.to_vec();
    }
    let (planes, rest) = data.split_at(n * element);
    let mut out = vec![0; planes.len()];
    for (j, plane) in planes.chunks_exact(n).enumerate() {
        out.iter_mut()
            .skip(j)
            .step_by(element)
            .zip(plane)
            .for_each(|(o, &b)| *o = b);
    }
    out.extend_from_slice(rest);
    out
}
