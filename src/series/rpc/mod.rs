//! RPC III time histories: what durability laboratories exchange.
//!
//! A header of records of 128 bytes (a key in 32, its value in 96, padded with zeros), four to a block of 512 bytes, beginning with
//! `FORMAT`, `NUM_HEADER_BLOCKS` and `NUM_PARAMS`; then groups of `PTS_PER_GROUP` numbers of the first channel, of the second, and so
//! on. A number is a 16-bit integer, its value the integer times `SCALE.CHAN_n`, or a 32-bit real. `FRAMES` frames of
//! `PTS_PER_FRAME` samples hold something; the last group is stored whole. Some writers state the exact number as `SAMPLES`.
//!
//! [`read_header`] and [`read_samples`] read any part, [`read_rpc`] a whole record, [`write_rpc`] writes 16-bit integers.

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
