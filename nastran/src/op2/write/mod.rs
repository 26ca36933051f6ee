//! Writes result tables as OP2, one block at a time: 32-bit little-endian with the header of PARAM,POST,-1.
//!
//! - [`writer`]: the public writer. [`stream`]: keys and records. [`head`]: identification records. [`entries`]: encoding of rows as words, the
//!   inverse of [`super::rows`].

mod entries;
mod error;
mod head;
mod stream;
mod writer;

pub use error::WriteError;
pub use writer::{EncodedBlock, Op2Writer, write_blocks};
