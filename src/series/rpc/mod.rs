//! RPC III time histories, the exchange format of durability laboratories.
//!
//! The header consists of records of 128 bytes, four to a block of 512 bytes. A record has a key in 32 bytes and its value in 96, padded with zeros.
//! The first keys are `FORMAT`, `NUM_HEADER_BLOCKS` and `NUM_PARAMS`.
//!
//! Then follow groups of `PTS_PER_GROUP` numbers of the first channel, of the second, and so on. A number is a 32-bit real, or a 16-bit integer whose
//! value is the integer times `SCALE.CHAN_n`. `FRAMES` frames of `PTS_PER_FRAME` samples contain data. The last group is stored whole. Some writers
//! state the exact number of samples as `SAMPLES`.
//!
//! [`read_header`] and [`read_samples`] read any part of a file, and [`read_rpc`] reads a whole record. [`write_rpc`] writes 16-bit integers.

mod header;
mod samples;
mod write;

pub use header::{Header, RpcChannel, RpcError, is_rpc, read_header};
pub use samples::{read_rpc, read_samples};
pub use write::{Target, write_rpc};

impl From<RpcError> for super::error::SeriesError {
    fn from(e: RpcError) -> Self {
        let (wrong, remedy) = e.parts();
        Self::Broken { wrong, remedy }
    }
}

#[cfg(test)]
mod tests;
