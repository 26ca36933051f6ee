//! Records of other programs read whole: Parquet and MDF4.

use super::channels::Channels;
use super::error::SeriesError;
use super::record::{Evenness, Options, Record, open_record, read_channels};
use std::sync::Arc;

/// Kinds of file, each behind a feature of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foreign {
    /// Apache Parquet: a column a channel.
    Parquet,
    /// ASAM MDF 4.
    Mdf,
}

impl Foreign {
    /// The kind that the bytes begin as.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"PAR1") {
            Some(Self::Parquet)
        } else if bytes.starts_with(b"MDF ") || bytes.starts_with(b"UnFinMF") {
            Some(Self::Mdf)
        } else {
            None
        }
    }

    /// Its name, and that of the feature.
    pub fn words(self) -> [&'static str; 2] {
        match self {
            Self::Parquet => ["Parquet", "parquet"],
            Self::Mdf => ["MDF4", "mdf"],
        }
    }
}

/// The record in such a file: channels sampled together. `wanted` names the channels that must be among them; none: as many as were
/// sampled together.
///
/// # Errors
/// A build without the feature, a file that can't be read, uneven or missing times, a rate other than the declared one, wanted
/// channels that were not sampled together.
pub fn read_foreign(
    _: Foreign,
    bytes: &[u8],
    declared_hz: Option<f64>,
    wanted: &[String],
) -> Result<Channels, SeriesError> {
    let options = Options {
        declared_hz,
        wanted: wanted.to_vec(),
    };
    let record = open_record(Arc::new(bytes.to_vec()), &options)?;
    check_even(&record)?;
    read_channels(&record)
}

/// Refuses a record whose samples are not the stored ones, all of them.
pub(super) fn check_even(record: &Record) -> Result<(), SeriesError> {
    if let Some(change) = record.clock.change {
        return Err(SeriesError::Broken {
            wrong: change.words(1.0),
            remedy: "resample the file to one rate, or cut it there",
        });
    }
    let expected_s = 1.0 / record.clock.rate_hz;
    let at = |row: usize, found_s: f64| {
        Err(SeriesError::UnevenTime {
            line: record.line_of_row(row),
            found_s,
            expected_s,
        })
    };
    match (record.clock.evenness, record.clock.gaps.first()) {
        (_, Some(gap)) => at(gap.after_row, gap.to_s - gap.from_s),
        (Evenness::Resampled { largest, row }, None) => at(row, expected_s * (1.0 + largest)),
        (Evenness::Even, None) => Ok(()),
    }
}
