//! Records whose samples are the stored ones.

use super::error::SeriesError;
use super::record::{Evenness, Record};

/// Refuses a record whose samples are not exactly all stored samples.
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
