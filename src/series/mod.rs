//! Sampled signals: records of data loggers, checked and made comparable.
//!
//! - [`channels`]: a record of equally long, equally sampled channels with units
//! - [`record`]: records of any length and origin, read a piece at a time on one clock
//! - [`binary`]: the long record of strainbridge, read a piece at a time
//! - [`butterworth`]: low-pass and high-pass filters without phase shift
//! - [`cell`]: names that a spreadsheet would read as formulas
//! - [`csv`]: bytes of a CSV file to a record in memory
//! - [`rpc`]: RPC III files, read and written
//! - `foreign`: Parquet and MDF4 in memory
//! - [`number`]: numbers read and written fast
//! - [`quality`]: dead, clipped, spiky, drifting channels as findings
//! - [`detrend`]: mean, line and zero-run removal
//! - [`plans`]: plans of transforms, kept between calls
//! - [`constant_columns`]: columns without readings, or with one constant value
//! - [`spectrum`]: zero-padded transforms, band limiting and integration in one pass
//! - [`integrate`]: velocity and displacement from acceleration
//! - [`window`]: tapered transforms with independent bins
//! - [`welch`]: power and cross spectra
//! - [`level_crossing`]: how often a signal crosses levels
//! - [`content`]: highest frequency at which a signal has content
//! - [`align`]: shift by a part of a sample
//! - [`resample`]: values between samples
//! - [`shift`]: the time shift between two recordings of the same signals
//! - [`rainflow`]: cycles and pseudo-damage

pub mod align;
pub mod binary;
pub mod butterworth;
pub mod cell;
pub mod channels;
pub mod constant_columns;
pub mod content;
pub mod csv;
pub mod detrend;
pub mod error;
pub mod even_record;
pub mod integrate;
pub mod level_crossing;
pub mod number;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod plans;
pub mod quality;
pub mod rainflow;
pub mod record;
pub mod resample;
pub mod rpc;
pub mod shift;
pub mod spectrum;
pub mod welch;
pub mod window;

pub use channels::{Channel, Channels};
pub use error::SeriesError;

#[cfg(test)]
mod tests;
