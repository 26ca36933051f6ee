//! Columns of files that state a type for each: numbers, points in time, durations. Parquet and Feather.

use super::column::{Column, is_time, name_and_unit, seconds_in, take_unit_below};
use super::reader::Times;
use super::time_unit::single_rounding_s;
use crate::series::error::SeriesError;

/// Meaning of the values of a column, with the worth of one stored unit: a plain number, or s.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Meaning {
    Number(f64),
    Instant(f64),
    /// Time that has passed.
    Duration(f64),
}

/// Storage of the values of a column.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Precision {
    Integer,
    /// Reals of 32 bits.
    Single,
    /// Other reals.
    Double,
}

/// Column of time of a file.
pub(super) struct TimeColumn {
    /// Number of the column in the file.
    pub at: usize,
    pub meaning: Meaning,
    pub unit: String,
}

/// Channels of a file, each with its number in the file and the worth of one stored unit, and the column of time.
pub(super) struct TypedChannels {
    pub time: Option<TimeColumn>,
    pub channels: Vec<((usize, f64), Column)>,
}

impl Meaning {
    pub(super) fn unit_factor(self) -> f64 {
        match self {
            Self::Number(w) | Self::Instant(w) | Self::Duration(w) => w,
        }
    }
}

impl TypedChannels {
    /// Returns the channels and the time column of a list of columns. Each entry has the number of the column in the file, its name, its meaning, and
    /// its unit. The unit is blank if the file states it only in the name.
    ///
    /// A column named `time`, `t` or `timestamp` gives the times. Otherwise the first column of timestamps or durations does, such as the index that
    /// pandas writes.
    pub(super) fn from_columns<'a>(
        list: impl Iterator<Item = (usize, &'a str, Meaning, &'a str)>,
    ) -> Self {
        let mut time: Option<(TimeColumn, bool)> = None;
        let mut found = Vec::new();
        for (at, name, meaning, unit) in list {
            let mut column = name_and_unit(name);
            take_unit_below(&mut column, unit);
            let is_named = is_time(&column.name, at == 0);
            let is_typed = !matches!(meaning, Meaning::Number(_));
            let is_better = match &time {
                None => is_named || is_typed,
                Some((_, named)) => is_named && !named,
            };
            if is_better {
                let unit = column.unit.clone();
                time = Some((TimeColumn { at, meaning, unit }, is_named));
            }
            found.push((at, meaning, column));
        }
        let time = time.map(|t| t.0);
        let of_time = time.as_ref().map(|t| t.at);
        let channels = found
            .into_iter()
            // A row number left by pandas or other programs is not a channel.
            .filter(|(at, _, c)| Some(*at) != of_time && !c.name.starts_with("__index_level_"))
            .map(|(at, meaning, c)| ((at, meaning.unit_factor()), c));
        Self {
            channels: channels.collect(),
            time,
        }
    }
}

impl TimeColumn {
    /// Returns the length of one stored unit in s. The type of the column takes precedence over its name.
    ///
    /// # Errors
    /// A unit in brackets that is no unit of time.
    pub(super) fn factor(&self) -> Result<f64, SeriesError> {
        match self.meaning {
            Meaning::Instant(worth) | Meaning::Duration(worth) => Ok(worth),
            Meaning::Number(worth) => {
                let s = seconds_in(&self.unit).ok_or_else(|| SeriesError::Broken {
                    wrong: format!("`{}` is not a unit of time", self.unit),
                    remedy: "give times in s or ms",
                })?;
                Ok(worth * s)
            }
        }
    }

    /// Returns whether the values are points in time, which count from 1970.
    pub(super) fn is_instant(&self) -> bool {
        matches!(self.meaning, Meaning::Instant(_))
    }

    /// Returns the times of the record. `factor` is the length of one stored unit in s. `epoch` (s since 1970) is subtracted from points in time.
    pub(super) fn times(&self, precision: Precision, factor: f64, epoch: f64) -> Times {
        let is_instant = self.is_instant();
        Times::Stored {
            // An integer is accurate to half a stored unit, and seconds since 1970 in 64 bits to a quarter of a microsecond. A 32-bit real is
            // accurate to 2^-24 of its value, for which the end of a day's record is taken.
            rounding_s: match (is_instant, precision) {
                (true, _) => 0.5 * factor + 2.5e-7,
                (false, Precision::Integer) => 0.5 * factor,
                (false, Precision::Single) => single_rounding_s(factor),
                (false, Precision::Double) => 0.0,
            },
            epoch_s: is_instant.then_some(epoch),
            unit_stated: !matches!(self.meaning, Meaning::Number(_)) || !self.unit.is_empty(),
        }
    }
}
