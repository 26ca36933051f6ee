//! A record from the bytes of a CSV file.

use super::channels::Channels;
use super::error::SeriesError;
use super::even_record::check_even;
use super::record::csv::Csv;
use super::record::{Record, read_channels};
use std::sync::Arc;

/// The record in a table of text, a column a channel, a row a sample, as [`super::record::csv`] reads it. A column of time gives the
/// sample rate; without it `declared_hz` does.
///
/// # Errors
/// [`SeriesError`] naming the line: ragged rows, text where a number belongs, uneven time steps, a rate other than the declared one.
pub fn read_csv(bytes: &[u8], declared_hz: Option<f64>) -> Result<Channels, SeriesError> {
    let record = Record::new(
        Box::new(Csv::new(Arc::new(bytes.to_vec()))?),
        declared_hz,
        None,
    )?;
    check_even(&record)?;
    read_channels(&record)
}
