//! What every format gives.

use crate::series::error::SeriesError;
use crate::units::{UNITS, find_unit, microstrain_in};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Bytes of a file, in memory or mapped.
pub type Bytes = Arc<dyn AsRef<[u8]> + Send + Sync>;

/// Rows decoded at a time: their numbers stay in the processor's cache.
pub(super) const BLOCK: usize = 512;

/// A channel of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name, without the unit.
    pub name: String,
    /// Its unit as the file states it; empty where it doesn't.
    pub unit: String,
}

/// Where the times of the samples come from.
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
    },
    /// A time with each sample.
    Stored {
        /// Largest error of a stored time by the digits or the unit it is stored in, s.
        rounding_s: f64,
        /// What the file's absolute times begin with, s since 1970; stored times count from there.
        epoch_s: Option<f64>,
        /// Whether the file states the unit of its times.
        unit_stated: bool,
    },
    /// None: the rate must be stated elsewhere.
    None {
        /// Samples, where they are counted.
        samples: Option<usize>,
    },
}

/// What is asked of each row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pick {
    /// Its time, s.
    Time,
    /// A column, as stored.
    Column(usize),
    /// NaN.
    Nothing,
}

/// Consecutive rows.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a> {
    /// Number of the first within the piece.
    pub first: usize,
    /// How many.
    pub rows: usize,
    /// Row-major, as many numbers a row as were picked; NaN where nothing was measured.
    pub values: &'a [f64],
}

/// Takes blocks in order until it has enough.
pub type Sink<'a> = dyn FnMut(Block<'_>) -> ControlFlow<()> + 'a;

/// A file as rows of numbers, in pieces that can be decoded by themselves and in parallel.
pub trait RecordReader: Send + Sync {
    /// Its columns but time, in file order.
    fn columns(&self) -> &[Column];
    /// Where its times come from.
    fn times(&self) -> Times;
    /// How many pieces it is read in.
    fn n_pieces(&self) -> usize;
    /// Decodes what is picked of a piece, a block at a time.
    ///
    /// # Errors
    /// What can't be decoded, with its place.
    fn read(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError>;
    /// Decodes what is picked of the first rows of a piece: one block.
    ///
    /// # Errors
    /// As [`RecordReader::read`].
    fn head(&self, piece: usize, picks: &[Pick], sink: &mut Sink) -> Result<(), SeriesError> {
        self.read(piece, picks, &mut |block| {
            let _ = sink(block);
            ControlFlow::Break(())
        })
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

/// Name and unit of a header such as `P01 [um/m]` or `a_body (m/s2)`; the last bracket is the unit's: `SG1 (left) (um/m)`.
pub fn name_and_unit(header: &str) -> Column {
    let text = bare_name(header);
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(body) = text.strip_suffix(close)
            && let Some((name, unit)) = split_at_bracket(body, open, close)
        {
            return Column {
                name: name.trim().to_owned(),
                unit: unit.trim().to_owned(),
            };
        }
    }
    Column {
        name: text.to_owned(),
        unit: String::new(),
    }
}

fn bare_name(header: &str) -> &str {
    header.trim().trim_matches('"').trim()
}

/// What stands before and after the bracket that a bracket at the end would close; `N/(mm)` is one unit.
fn split_at_bracket(body: &str, open: char, close: char) -> Option<(&str, &str)> {
    let mut depth = 0_usize;
    for (at, c) in body.char_indices().rev() {
        if c == close {
            depth += 1;
        } else if c == open {
            if depth == 0 {
                let unit = body.get(at..)?.strip_prefix(open)?;
                return Some((body.get(..at)?, unit));
            }
            depth -= 1;
        }
    }
    None
}

/// Whether a field of a row of units states none: blank, `-`, or what such a row is called.
pub(super) fn states_no_unit(field: &str) -> bool {
    let word = field.trim().trim_matches(['[', ']', '(', ')']);
    matches!(
        word.to_lowercase().as_str(),
        "" | "-" | "unit" | "units" | "einheit" | "einheiten"
    )
}

/// Gives a column the unit in the row below its header. A unit of the same quantity beside the name goes before it; anything else in
/// brackets there is part of the name: `SG1 (left)`.
pub fn take_unit_below(column: &mut Column, header: &str, below: &str) {
    if states_no_unit(below) {
        return;
    }
    let below = below.trim().trim_matches(['[', ']', '(', ')']);
    if !states_no_unit(&column.unit) {
        if is_same_quantity(&column.unit, below) {
            return;
        }
        bare_name(header).clone_into(&mut column.name);
    }
    below.clone_into(&mut column.unit);
}

/// Whether this is a unit of time, strain or a quantity that a job may name.
pub(super) fn is_unit(word: &str) -> bool {
    is_same_quantity_known(word, word)
}

/// Whether two units are the same, or known ones of one quantity.
fn is_same_quantity(a: &str, b: &str) -> bool {
    a.eq_ignore_ascii_case(b) || is_same_quantity_known(a, b)
}

fn is_same_quantity_known(a: &str, b: &str) -> bool {
    [a, b].iter().all(|u| seconds_in(u).is_some())
        || [a, b].iter().all(|u| microstrain_in(u).is_some())
        || UNITS.iter().any(|known| {
            [a, b]
                .iter()
                .all(|u| find_unit(known.quantity, u).is_some())
        })
}

/// Whether a column of this name, the first of its file or not, is that of time.
pub fn is_time(name: &str, first: bool) -> bool {
    let word = name.trim().to_lowercase();
    match word.as_str() {
        "time" | "t" if name != "T" => true,
        "t_s" | "time_s" | "zeit" | "timestamp" | "datetime" | "date_time" | "date time"
        | "date/time" | "datum" | "date" => true,
        // Measuring programs add the name of the clock: `Time  1 - default sample rate`.
        _ => {
            first
                && (name == "T"
                    || ["time ", "zeit ", "datum ", "date ", "timestamp "]
                        .iter()
                        .any(|w| word.starts_with(w)))
        }
    }
}

/// Seconds in one of a unit of time; none stated means seconds.
pub fn seconds_in(unit: &str) -> Option<f64> {
    match unit.trim().to_lowercase().as_str() {
        "" | "s" | "sec" | "secs" | "second" | "seconds" | "sek" => Some(1.0),
        "ms" | "msec" | "millisecond" | "milliseconds" => Some(1e-3),
        "us" | "µs" | "μs" | "microseconds" => Some(1e-6),
        "ns" | "nanoseconds" => Some(1e-9),
        "min" | "minutes" => Some(60.0),
        "h" | "hours" => Some(3600.0),
        _ => None,
    }
}
