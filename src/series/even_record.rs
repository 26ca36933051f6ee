//! Records of any format read whole, whose samples are the stored ones.

use super::error::SeriesError;
use super::record::{Bytes, Evenness, Options, Record, open_record};

/// Opens a record of even steps without gaps.
///
/// # Errors
/// A build without the format's feature, a file that can't be read, uneven or missing times, a rate other than the declared one, wanted
/// channels that were not sampled together.
pub fn open_even(bytes: Bytes, options: &Options) -> Result<Record, SeriesError> {
    let record = open_record(bytes, options)?;
    check_even(&record)?;
    Ok(record)
}

/// Refuses a record whose samples are not the stored ones, all of them.
pub(super) fn check_even(record: &Record) -> Result<(), SeriesError> {
    if let Some(change) = record.clock.change {
        return Err(SeriesError::Broken {
            wrong: change.words(),
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
