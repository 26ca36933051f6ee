//! Errors of a record.

use std::fmt;

/// Errors of a record: samples, times, columns or file format.
#[derive(Clone, Debug, PartialEq)]
pub enum SeriesError {
    /// Two channels differ in length.
    Length {
        /// Offending channel.
        name: String,
        /// Length of the channel.
        found: usize,
        /// The first channel.
        first: String,
        /// The first channel's length.
        expected: usize,
    },
    /// No channel of this name.
    Missing {
        /// Wanted name.
        name: String,
        /// Names present.
        present: Vec<String>,
    },
    /// A line of a table can't be read.
    Line {
        /// Line number, from 1.
        line: usize,
        /// Message about the fault.
        what: String,
        /// Remedy.
        remedy: &'static str,
    },
    /// The time column and the declared sample rate disagree.
    Rate {
        /// Rate from the time column.
        found_hz: f64,
        /// Rate from the job.
        declared_hz: f64,
    },
    /// The time steps are unequal.
    UnevenTime {
        /// Line number, from 1.
        line: usize,
        /// Step at this line.
        found_s: f64,
        /// Median step.
        expected_s: f64,
    },
    /// Neither a time column nor a declared rate.
    NoRate,
    /// A record shorter than its use needs.
    TooShort {
        /// Duration.
        found_s: f64,
        /// Needed duration.
        needed_s: f64,
        /// Lower band edge.
        low_hz: f64,
    },
    /// A file of a known format that can't be read.
    Broken {
        /// Message about the fault.
        wrong: String,
        /// Remedy.
        remedy: &'static str,
    },
    /// Times that do not ascend.
    NotAscending {
        /// Line or sample, from 1.
        line: usize,
        /// Time at this line or sample.
        time_s: f64,
        /// The preceding time.
        before_s: f64,
    },
    /// A time that is missing or not a number.
    NoTime {
        /// Line or sample, from 1.
        line: usize,
    },
    /// A file without samples.
    Empty,
    /// No sample for most of the record's span.
    Hole {
        /// Last time before the hole.
        from_s: f64,
        /// First time after the hole.
        to_s: f64,
        /// Samples that even steps would place in the hole.
        missing: u64,
    },
    /// A kind of file that this build does not read.
    NotBuilt {
        /// Name of the kind of file.
        name: &'static str,
        /// The feature that reads the format.
        feature: &'static str,
    },
    /// Channels that were not sampled together.
    Apart {
        /// Names of these channels.
        names: Vec<String>,
    },
    /// A band that the sample rate can't represent.
    Band {
        /// Lower edge.
        low_hz: f64,
        /// Upper edge.
        high_hz: f64,
        /// Sample rate.
        rate_hz: f64,
    },
}

impl SeriesError {
    /// Returns the message and the remedy.
    pub fn parts(&self) -> (String, String) {
        let (wrong, remedy) = match self {
            Self::Length {
                name,
                found,
                first,
                expected,
            } => (
                format!("channel `{name}` has {found} samples, `{first}` has {expected}"),
                "cut or resample both to one length",
            ),
            Self::Missing { name, present } => (
                format!(
                    "no channel `{name}`; the record contains {}",
                    present.join(", ")
                ),
                "name it in the job or rename the column",
            ),
            Self::Line { line, what, remedy } => (format!("line {line}: {what}"), *remedy),
            Self::Rate {
                found_hz,
                declared_hz,
            } => (
                format!(
                    "the time column gives {found_hz:.6} Hz, the job states {declared_hz:.6} Hz"
                ),
                "correct `sample_rate`, or resample the file",
            ),
            Self::UnevenTime {
                line,
                found_s,
                expected_s,
            } => (
                format!(
                    "the time step at line {line} is {found_s:.6} s, elsewhere {expected_s:.6} s"
                ),
                "samples are missing or repeated; resample the file to even steps",
            ),
            Self::NoRate => (
                "the record has neither a `t` or `time` column nor a `sample_rate`".to_owned(),
                "state one of them",
            ),
            Self::TooShort {
                found_s,
                needed_s,
                low_hz,
            } => (
                format!(
                    "the record lasts {found_s:.2} s, at least {needed_s:.2} s are needed for a band from {low_hz} Hz"
                ),
                "record longer or raise the lower band edge",
            ),
            Self::Broken { wrong, remedy } => (wrong.clone(), *remedy),
            Self::NotAscending {
                line,
                time_s,
                before_s,
            } => (
                format!("time {time_s} s at line {line} comes after {before_s} s"),
                "samples are out of order or repeated; write each sample once, in order of time",
            ),
            Self::NoTime { line } => (
                format!("the time at line {line} is missing"),
                "give every sample its time",
            ),
            Self::Empty => (
                "it contains a header and no samples".to_owned(),
                "record again, or leave the file out",
            ),
            Self::Hole {
                from_s,
                to_s,
                missing,
            } => (
                format!(
                    "{missing} samples are missing between {from_s} s and {to_s} s, more than the record contains"
                ),
                "cut the record there, or correct its times",
            ),
            Self::NotBuilt { name, feature } => {
                let wrong = format!("it is {name}, which this build of strainbridge does not read");
                let remedy = format!(
                    "use a released binary, build with `--features {feature}`, or export the record as CSV or RPC III"
                );
                return (wrong, remedy);
            }
            Self::Apart { names } => (
                format!(
                    "channels {} were sampled at other times than the rest",
                    names.join(", ")
                ),
                "resample all of them to the same times first (`resample` of asammdf does it)",
            ),
            Self::Band {
                low_hz,
                high_hz,
                rate_hz,
            } => {
                let wrong = format!(
                    "the band {low_hz} to {high_hz} Hz does not fit a sample rate of {rate_hz} Hz"
                );
                let remedy = format!("need 0 < low < high < {:.3} Hz", rate_hz / 2.0);
                return (wrong, remedy);
            }
        };
        (wrong, remedy.to_owned())
    }
}

impl fmt::Display for SeriesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (wrong, remedy) = self.parts();
        write!(f, "{wrong}: {remedy}")
    }
}

impl std::error::Error for SeriesError {}
