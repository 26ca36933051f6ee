//! What can be wrong with a record.

use thiserror::Error;

/// What can be wrong with a record.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SeriesError {
    /// Two channels differ in length.
    #[error(
        "channel `{name}` has {found} samples, `{first}` has {expected}: cut or resample both to one length"
    )]
    Length {
        /// Offending channel.
        name: String,
        /// Its length.
        found: usize,
        /// The first channel.
        first: String,
        /// The first channel's length.
        expected: usize,
    },
    /// No channel of this name.
    #[error("no channel `{name}`; the record holds {}: name it in the job or rename the column", .present.join(", "))]
    Missing {
        /// Wanted name.
        name: String,
        /// Names present.
        present: Vec<String>,
    },
    /// A line of a table can't be read.
    #[error("line {line}: {what}: {remedy}")]
    Line {
        /// Line number, from 1.
        line: usize,
        /// What is wrong.
        what: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The time column and the declared sample rate disagree.
    #[error(
        "the time column says {found_hz:.6} Hz, the job says {declared_hz:.6} Hz: correct `sample_rate`, or resample the file"
    )]
    Rate {
        /// From the time column.
        found_hz: f64,
        /// From the job.
        declared_hz: f64,
    },
    /// The time steps are unequal.
    #[error(
        "the time step at line {line} is {found_s:.6} s, elsewhere {expected_s:.6} s: samples are missing or repeated; resample the file to even steps"
    )]
    UnevenTime {
        /// Line number, from 1.
        line: usize,
        /// Step there.
        found_s: f64,
        /// Median step.
        expected_s: f64,
    },
    /// Neither a time column nor a declared rate.
    #[error("neither a `t` or `time` column nor a `sample_rate`: state one of them")]
    NoRate,
    /// A record shorter than its use needs.
    #[error(
        "the record lasts {found_s:.2} s, at least {needed_s:.2} s are needed for a band from {low_hz} Hz: record longer or raise the lower band edge"
    )]
    TooShort {
        /// Duration.
        found_s: f64,
        /// Needed duration.
        needed_s: f64,
        /// Lower band edge.
        low_hz: f64,
    },
    /// A file of a known format that can't be read; the sentence ends with what to do.
    #[error("{0}")]
    Broken(String),
    /// Times that do not ascend.
    #[error(
        "time {time_s} s at line {line} comes after {before_s} s: samples are out of order or repeated; write each sample once, in order of time"
    )]
    NotAscending {
        /// Line or sample, from 1.
        line: usize,
        /// Time there.
        time_s: f64,
        /// The time before it.
        before_s: f64,
    },
    /// A time that is missing or no number.
    #[error("the time at line {line} is missing: give every sample its time")]
    NoTime {
        /// Line or sample, from 1.
        line: usize,
    },
    /// A file without samples.
    #[error("it holds no samples, only a header: record again, or leave the file out")]
    Empty,
    /// No sample for most of the record's span.
    #[error(
        "{missing} samples are missing between {from_s} s and {to_s} s, more than the record holds: cut the record there, or correct its times"
    )]
    Hole {
        /// Last time before.
        from_s: f64,
        /// First time after.
        to_s: f64,
        /// Samples that would have been there.
        missing: u64,
    },
    /// A kind of file that this build does not read.
    #[error(
        "it is {name}, which this build of strainbridge does not read: take a released binary, build with `--features {feature}`, or export the record as CSV or RPC III"
    )]
    NotBuilt {
        /// What it is.
        name: &'static str,
        /// The feature that reads it.
        feature: &'static str,
    },
    /// Channels that were not sampled together.
    #[error(
        "channels {} were sampled at other times than the rest: bring all to one rate first (`resample` of asammdf does it)", .names.join(", ")
    )]
    Apart {
        /// Their names.
        names: Vec<String>,
    },
    /// A band that the sampling can't hold.
    #[error("the band {low_hz} to {high_hz} Hz does not fit a sample rate of {rate_hz} Hz: need 0 < low < high < {:.3} Hz", .rate_hz / 2.0)]
    Band {
        /// Lower edge.
        low_hz: f64,
        /// Upper edge.
        high_hz: f64,
        /// Sample rate.
        rate_hz: f64,
    },
}
