//! `[compare]`.

use super::runs::Runs;

/// `[compare]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Compare {
    /// File of the recorded loads, with its columns, units and noise.
    pub recorded: Runs,
    /// Time added to the times of the file.
    pub shift: TimeShift,
    /// Seconds in the unit of the column `time`, where the job states it.
    pub time_unit_s: Option<f64>,
    /// Line of the job.
    pub line: u32,
}

/// Time added to the times of recorded loads to get the times of the strain record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeShift {
    /// Estimated from recovered and recorded loads.
    Estimate,
    /// Stated, s.
    Stated(f64),
}
