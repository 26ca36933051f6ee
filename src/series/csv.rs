//! A record from the bytes of a CSV file.

use super::channels::Channels;
use super::error::SeriesError;
use super::even_record::check_even;
use super::record::csv::Csv;
use super::record::{Record, read_channels};
use std::sync::Arc;

/// Reads a table of text into a record: a column for each channel, a row for each sample. [`super::record::csv`] states what it accepts.
///
/// A column of time gives the sample rate; without it `declared_hz` does.
///
/// # Errors
/// [`SeriesError`] naming the line: ragged rows, text where a number belongs, uneven time steps, a rate other than the declared one.
///
/// # Example
/// ```
/// use strainbridge::series::csv::read_csv;
///
/// // Semicolons and decimal commas, with a unit in the header.
/// let record = read_csv(b"time;P01 [um/m]\n0,00;1,5\n0,01;2,5\n0,02;-3,5\n", None)?;
/// assert!((record.rate_hz - 100.0).abs() < 1e-9);
/// assert_eq!(record.samples("P01")?, [1.5, 2.5, -3.5]);
/// assert_eq!(record.list[0].unit, "um/m");
///
/// let ragged = read_csv(b"time,P01\n0.00,1.5\n0.01\n", None).unwrap_err();
/// assert!(ragged.to_string().contains("line 3"), "{ragged}");
/// # Ok::<(), strainbridge::series::SeriesError>(())
/// ```
pub fn read_csv(bytes: &[u8], declared_hz: Option<f64>) -> Result<Channels, SeriesError> {
    let record = Record::new(
        Box::new(Csv::new(Arc::new(bytes.to_vec()))?),
        declared_hz,
        None,
    )?;
    check_even(&record)?;
    read_channels(&record)
}
