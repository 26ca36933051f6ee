//! Writes result tables as OP2: 32-bit little-endian with the header of PARAM,POST,-1, a block at a time.
//!
//! - [`writer`] what a caller uses; [`stream`] keys and records; [`head`] identification records; [`entries`] rows into words, the
//!   inverse of [`super::rows`].

mod entries;
mod error;
mod head;
mod stream;
mod writer;

pub use error::WriteError;
pub use writer::{EncodedBlock, Op2Writer, write_blocks};
