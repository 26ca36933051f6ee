//! Interface of the readers of all formats.

use super::column::Column;
use crate::series::error::SeriesError;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Bytes of a file, in memory or mapped.
pub type Bytes = Arc<dyn AsRef<[u8]> + Send + Sync>;

/// Number of rows that are decoded at a time. Their numbers fit into the processor's cache.
pub(super) const BLOCK: usize = 512;

/// Source of the times of the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Times {
    /// Even steps by the format itself.
    Even {
        /// Time of the first sample, s.
        start_s: f64,
        /// Time between samples, s.
        step_s: f64,
        /// Samples.
        samples: usize,
        /// Whether the file states the unit of its times, or its format does.
        unit_stated: bool,
    },
    /// A time with each sample.
    Stored {
        /// Largest error of a stored time by the digits or the unit it is stored in, s.
        rounding_s: f64,
        /// Origin of the file's absolute times, s since 1970; stored times count from it.
        epoch_s: Option<f64>,
        /// Whether the file states the unit of its times.
        unit_stated: bool,
    },
    /// None: the rate must be stated elsewhere.
    None {
        /// Number of samples, if known.
        samples: Option<usize>,
    },
}

/// Value that a caller picks from each row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pick {
    /// Time of the row, s.
    Time,
    /// A column, as stored.
    Column(usize),
    /// NaN.
    Nothing,
}

/// Consecutive rows.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// Number of the first row within the piece.
    pub first: usize,
    /// Number of rows.
    pub rows: usize,
    /// Values by rows, one for each pick. NaN if nothing was measured.
    pub values: &'a [f64],
}

/// A channel of a file that is not part of the record, because its samples were taken at other times or are not numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherChannel {
    /// Name of the group. Empty if the file states none.
    pub group: String,
    /// Name, without the unit.
    pub name: String,
    /// Unit as the file states it. Empty if the file states none.
    pub unit: String,
    /// Number of samples.
    pub samples: usize,
    /// Sample rate, Hz, if the file states one.
    pub rate_hz: Option<f64>,
}

/// Receiver of blocks in order, until it has enough.
pub type Sink<'a> = dyn FnMut(Block<'_>) -> ControlFlow<()> + 'a;

/// File as rows of numbers, in pieces that can be decoded separately and in parallel.
pub trait RecordReader: Send + Sync {
    /// Returns the columns but time, in file order.
    fn columns(&self) -> &[Column];
    /// Name of the group of a column; empty where the format or the file has none.
    fn group(&self, _column: usize) -> &str {
        ""
    }
    /// Channels of the file that are not among the columns, in file order.
    fn other_channels(&self) -> &[OtherChannel] {
        &[]
    }
    /// Returns the source of the times.
    fn times(&self) -> Times;
    /// Returns the number of pieces in which the record is read.
    fn n_pieces(&self) -> usize;
    /// Decodes the picks of a piece, a block at a time.
    ///
    /// # Errors
    /// Data that can't be decoded, with its place.
    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError>;
    /// Decodes the picks of the first rows of a piece, as one block.
    ///
    /// # Errors
    /// Errors of [`RecordReader::read`].
    fn head(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        self.read(piece, picks, &mut |block| {
            let _ = sink(block);
            ControlFlow::Break(())
        })
    }
    /// The last line of the file, where it may be cut and is left out.
    fn left_out(&self) -> Option<usize> {
        None
    }
    /// Returns the length in seconds of the unit of time that the file states, or `None` if the file states no unit.
    fn stated_time_unit_s(&self) -> Option<f64> {
        None
    }
    /// Returns whether the times are times of day, which restart at midnight.
    fn are_times_of_day(&self) -> bool {
        false
    }
    /// Rows of a piece, where they are known without decoding it.
    fn rows(&self, _piece: usize) -> Option<usize> {
        None
    }
    /// The line in the file of a row of a piece that is the `row`th of the file, both from 0; for a fault.
    fn line(&self, _piece: usize, _row_in_piece: usize, row: usize) -> usize {
        row + 1
    }
}
