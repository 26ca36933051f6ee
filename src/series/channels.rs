//! A record: channels sampled together.

use thiserror::Error;

/// One measured signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name in the file, such as `a_body`.
    pub name: String,
    /// Unit as declared, such as `m/s2`; empty where the file does not say.
    pub unit: String,
    /// Samples; NaN where one is missing.
    pub samples: Vec<f64>,
}

/// Channels of one length and one sample rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Channels {
    /// Samples per second.
    pub rate_hz: f64,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// The channels in file order.
    pub list: Vec<Channel>,
}

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
    /// An RPC III file that can't be read.
    #[error(transparent)]
    Rpc(#[from] super::rpc::RpcError),
    /// A kind of file that this build does not read.
    #[error(
        "it is a {} file, which this build of strainbridge does not read: take a released binary, build with `--features {}`, or export the record as CSV or RPC III",
        .kind.words()[0], .kind.words()[1]
    )]
    NotBuilt {
        /// What it is.
        kind: super::foreign::Foreign,
    },
    /// A Parquet file that can't be read.
    #[error(
        "it can't be read as Parquet ({0}): write it again, columns of numbers and one `time` in seconds"
    )]
    Parquet(String),
    /// An MDF file that can't be read.
    #[error(
        "it can't be read as MDF4 ({0}): save it as MDF 4.1 with its measuring program or asammdf"
    )]
    Mdf(String),
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

impl Channels {
    /// A record of the given channels.
    ///
    /// # Errors
    /// [`SeriesError::Length`] when lengths differ, [`SeriesError::NoRate`] when the rate is not a positive number.
    pub fn from_list(rate_hz: f64, list: Vec<Channel>) -> Result<Self, SeriesError> {
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(SeriesError::NoRate);
        }
        if let Some(first) = list.first() {
            let expected = first.samples.len();
            if let Some(bad) = list.iter().find(|c| c.samples.len() != expected) {
                return Err(SeriesError::Length {
                    name: bad.name.clone(),
                    found: bad.samples.len(),
                    first: first.name.clone(),
                    expected,
                });
            }
        }
        Ok(Self {
            rate_hz,
            start_s: 0.0,
            list,
        })
    }

    /// Number of samples of each channel.
    pub fn n_samples(&self) -> usize {
        self.list.first().map_or(0, |c| c.samples.len())
    }

    /// Duration, s.
    pub fn duration_s(&self) -> f64 {
        self.n_samples() as f64 / self.rate_hz
    }

    /// Whether a channel of this name is present.
    pub fn has(&self, name: &str) -> bool {
        self.list.iter().any(|c| c.name == name)
    }

    /// Samples of a channel.
    ///
    /// # Errors
    /// [`SeriesError::Missing`] when there is none of this name.
    pub fn samples(&self, name: &str) -> Result<&[f64], SeriesError> {
        self.list
            .iter()
            .find(|c| c.name == name)
            .map(|c| c.samples.as_slice())
            .ok_or_else(|| SeriesError::Missing {
                name: name.to_owned(),
                present: self.list.iter().map(|c| c.name.clone()).collect(),
            })
    }

    /// The same record with missing samples (NaN, infinities) filled by straight lines between neighbours, and how many were
    /// filled in each channel. A channel without any finite sample becomes zero.
    pub fn with_gaps_filled(&self) -> (Self, Vec<usize>) {
        let mut filled = self.clone();
        let counts = filled
            .list
            .iter_mut()
            .map(|c| fill_gaps(&mut c.samples))
            .collect();
        (filled, counts)
    }
}

fn fill_gaps(x: &mut [f64]) -> usize {
    let good: Vec<usize> = (0..x.len()).filter(|&i| x[i].is_finite()).collect();
    let missing = x.len() - good.len();
    if missing == 0 {
        return 0;
    }
    let (Some(&first), Some(&last)) = (good.first(), good.last()) else {
        x.fill(0.0);
        return missing;
    };
    let (head, tail) = (x[first], x[last]);
    x[..first].fill(head);
    x[last..].fill(tail);
    for pair in good.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let (xa, xb) = (x[a], x[b]);
        for i in a + 1..b {
            x[i] = xa + (xb - xa) * (i - a) as f64 / (b - a) as f64;
        }
    }
    missing
}
