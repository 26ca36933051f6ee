//! Where the bytes of a record come from.

use super::reader::Bytes;
use std::sync::Arc;

/// A file that is read part by part, by many threads at a time.
pub trait Parts: Send + Sync {
    /// Returns the length in bytes.
    fn size(&self) -> u64;

    /// Fills `out` with the bytes from number `from` on.
    ///
    /// # Errors
    /// Errors of the system, or [`std::io::ErrorKind::UnexpectedEof`] if the file is too short.
    fn read_at(&self, from: u64, out: &mut [u8]) -> std::io::Result<()>;
}

/// The bytes of a record.
#[derive(Clone)]
pub enum Source {
    /// All of them in memory.
    Memory(Bytes),
    /// In a file. Bytes are read when they are decoded, and are not kept.
    File(Arc<dyn Parts>),
}

impl Source {
    /// Returns the length in bytes.
    pub fn size(&self) -> u64 {
        match self {
            Self::Memory(bytes) => (**bytes).as_ref().len() as u64,
            Self::File(file) => file.size(),
        }
    }

    /// Returns all bytes, in memory.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn read_all(self) -> std::io::Result<Bytes> {
        match self {
            Self::Memory(bytes) => Ok(bytes),
            Self::File(file) => {
                let size = usize::try_from(file.size());
                let mut out = vec![0; size.map_err(|_| std::io::ErrorKind::OutOfMemory)?];
                file.read_at(0, &mut out)?;
                Ok(Arc::new(out))
            }
        }
    }
}

/// Returns whether a file that begins with these bytes is read part by part.
pub fn is_read_in_parts(begin: &[u8]) -> bool {
    cfg!(feature = "parquet") && begin.starts_with(b"PAR1")
}
