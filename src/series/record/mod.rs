//! Records of any length and origin, read a piece at a time: names with units split off, one clock, pieces that decode in parallel.
//!
//! A format is a [`RecordReader`]: [`csv`], the binary record of strainbridge, RPC III, Parquet, Feather, MDF4, TDMS, UFF 58. [`open_record`]
//! identifies the format by the first bytes of the file and passes once over the times ([`Clock`]). It returns a [`Record`], whose samples have even
//! steps whatever the steps of the file. Only the list of parts of a file is kept.

#[cfg(feature = "parquet")]
mod arrow;
mod clock;
mod column;
pub mod csv;
mod even;
mod even_step_formats;
#[cfg(feature = "parquet")]
mod feather;
#[cfg(feature = "parquet")]
mod flat_buffer;
#[cfg(feature = "mdf")]
mod mdf;
mod memory_record;
mod open;
#[cfg(feature = "parquet")]
mod pages;
#[cfg(feature = "parquet")]
mod parquet;
#[cfg(feature = "parquet")]
mod parquet_bytes;
mod reader;
#[cfg(feature = "parquet")]
mod rows;
#[cfg(feature = "parquet")]
mod runs;
mod simultaneous_channels;
mod source;
mod span;
#[cfg(feature = "parquet")]
mod strip;
mod tdms;
#[cfg(any(feature = "parquet", feature = "mdf"))]
mod tile;
mod time_conversion;
mod time_unit;
#[cfg(feature = "parquet")]
mod typed_columns;
mod uff;

pub use clock::{Clock, Evenness, RateChange};
pub use column::{Clash, Column, Header, is_time, name_and_unit, seconds_in, take_unit_below};
pub use even::Record;
pub use memory_record::MemoryRecord;
pub use open::{Format, Options, format_of, is_format, open_record, open_source, read_channels};
pub use reader::{Block, Bytes, OtherChannel, Pick, RecordReader, Sink, Times};
#[cfg(feature = "parquet")]
pub use runs::runs_as_csv;
pub use source::{Parts, Source, is_read_in_parts};
pub use span::{EVEN, Gap};
pub use time_unit::{TimeUnit, USUAL_RATES_HZ, is_usual};

#[cfg(test)]
mod tests;
