//! Bytes of a Parquet file, from memory or read part by part, in memory that is used again.

use super::reader::Bytes;
use super::source::Source;
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, Length};
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes of the file for the Parquet library. For a file in memory, a page is a part of it, not a copy.
pub(super) struct ParquetBytes {
    source: Source,
    shared: bytes::Bytes,
    pages: Arc<Mutex<Vec<Vec<u8>>>>,
}

/// Bytes of a page read from a file. Its memory goes back to the pages that were decoded, for the next ones.
struct PooledPage {
    memory: Vec<u8>,
    length: usize,
    pages: Arc<Mutex<Vec<Vec<u8>>>>,
}

/// Memory of larger pages is given back to the system.
const LARGE_PAGE: usize = 8 << 20;

impl AsRef<[u8]> for PooledPage {
    fn as_ref(&self) -> &[u8] {
        self.memory.get(..self.length).unwrap_or_default()
    }
}

impl Drop for PooledPage {
    fn drop(&mut self) {
        if self.memory.len() <= LARGE_PAGE {
            let mut pages = self.pages.lock().unwrap_or_else(PoisonError::into_inner);
            pages.push(std::mem::take(&mut self.memory));
        }
    }
}

/// Lends the bytes of the file.
struct Owner(Bytes);

impl AsRef<[u8]> for Owner {
    fn as_ref(&self) -> &[u8] {
        (*self.0).as_ref()
    }
}

impl ParquetBytes {
    pub(super) fn from_source(source: Source) -> Self {
        let shared = match &source {
            Source::Memory(bytes) => bytes::Bytes::from_owner(Owner(bytes.clone())),
            Source::File(_) => bytes::Bytes::new(),
        };
        Self {
            source,
            shared,
            pages: Arc::default(),
        }
    }

    /// Bytes from `start` on, at most so many; all of these where `all`.
    fn read_bytes(&self, start: u64, most: usize, all: bool) -> Result<bytes::Bytes, ParquetError> {
        let left = self
            .source
            .size()
            .checked_sub(start)
            .ok_or_else(|| ParquetError::EOF(format!("byte {start} is beyond the end")))?;
        let length = most.min(usize::try_from(left).unwrap_or(usize::MAX));
        if all && length < most {
            return Err(ParquetError::EOF("the file ends early".into()));
        }
        match &self.source {
            Source::Memory(_) => {
                let start = start as usize;
                Ok(self.shared.slice(start..start + length))
            }
            Source::File(file) => {
                let mut pages = self.pages.lock().unwrap_or_else(PoisonError::into_inner);
                let mut memory = pages.pop().unwrap_or_default();
                drop(pages);
                memory.resize(memory.len().max(length), 0);
                let out = memory.get_mut(..length).unwrap_or_default();
                file.read_at(start, out)
                    .map_err(|e| ParquetError::General(e.to_string()))?;
                Ok(bytes::Bytes::from_owner(PooledPage {
                    memory,
                    length,
                    pages: Arc::clone(&self.pages),
                }))
            }
        }
    }
}

impl Length for ParquetBytes {
    fn len(&self) -> u64 {
        self.source.size()
    }
}

/// Reads on from a place: the header of a page.
pub(super) struct PageHeaderReader {
    whole: Arc<ParquetBytes>,
    at: u64,
    ahead: bytes::Bytes,
}

impl std::io::Read for PageHeaderReader {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        /// Bytes fetched at a time: a header with its statistics.
        const AHEAD: usize = 512;
        if self.ahead.is_empty() {
            let more = self.whole.read_bytes(self.at, AHEAD.max(out.len()), false);
            self.ahead = more.map_err(std::io::Error::other)?;
            self.at += self.ahead.len() as u64;
        }
        let n = self.ahead.len().min(out.len());
        let taken = self.ahead.split_to(n);
        for (slot, b) in out.iter_mut().zip(&taken) {
            *slot = *b;
        }
        Ok(n)
    }
}

impl ChunkReader for ParquetBytes {
    type T = PageHeaderReader;

    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        self.read_bytes(start, 0, true)?;
        Ok(PageHeaderReader {
            whole: Arc::new(Self {
                source: self.source.clone(),
                shared: self.shared.clone(),
                pages: Arc::clone(&self.pages),
            }),
            at: start,
            ahead: bytes::Bytes::new(),
        })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<bytes::Bytes, ParquetError> {
        self.read_bytes(start, length, true)
    }
}
