//! A record: channels sampled together.

use super::error::SeriesError;

/// One measured signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name in the file, such as `a_body`.
    pub name: String,
    /// Unit as declared, such as `m/s2`; empty if the file declares none.
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

impl Channels {
    /// Creates a record of the given channels.
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

    /// Returns the number of samples of each channel.
    pub fn n_samples(&self) -> usize {
        self.list.first().map_or(0, |c| c.samples.len())
    }

    /// Returns the duration, s.
    pub fn duration_s(&self) -> f64 {
        self.n_samples() as f64 / self.rate_hz
    }

    /// Returns whether a channel of this name is present.
    pub fn has(&self, name: &str) -> bool {
        self.list.iter().any(|c| c.name == name)
    }

    /// Returns the samples of a channel.
    ///
    /// # Errors
    /// [`SeriesError::Missing`] if no channel has this name.
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

    /// Returns a copy in which straight lines between neighbours fill missing samples (NaN, infinities), and the number of filled samples by channel.
    /// A channel without any finite sample becomes zero.
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
