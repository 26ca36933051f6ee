//! Net readings: a run's mean minus the unloaded run's mean, with the noise of both, and whether a gauge gives a signal.

/// A net reading, strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Net {
    /// Mean of the run minus mean of the zero, strain.
    pub value: f64,
    /// Standard deviation of the value, strain.
    pub sigma: f64,
}

impl Net {
    /// Returns the size divided by the noise. NaN for a gauge without a reading.
    pub fn signal_to_noise(&self) -> f64 {
        self.value.abs() / self.sigma
    }
}

/// Sums over consecutive readings, for a record that is never completely in memory.
///
/// The sums use readings minus the first reading, so that a large mean does not reduce the precision of a small scatter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Series {
    n: u64,
    first: f64,
    last: f64,
    sum: f64,
    squares: f64,
    /// Products of neighbours.
    products: f64,
}

impl Series {
    /// Adds a reading. A reading that is not finite is ignored.
    pub fn add(&mut self, reading: f64) {
        if !reading.is_finite() {
            return;
        }
        if self.n == 0 {
            self.first = reading;
        }
        let (x, before) = (reading - self.first, self.last - self.first);
        if self.n > 0 {
            self.products += x * before;
        }
        self.n += 1;
        self.sum += x;
        self.squares += x * x;
        self.last = reading;
    }

    /// Returns the mean of the readings; `None` without readings.
    pub fn mean(&self) -> Option<f64> {
        (self.n > 0).then(|| self.first + self.sum / self.n as f64)
    }

    /// Returns the number of effective samples, like [`effective_samples`] of all readings.
    pub fn effective_samples(&self) -> f64 {
        let n = self.n as f64;
        let mean = self.sum / n;
        let var = (self.squares - n * mean * mean).max(0.0);
        // Sum without the last reading plus sum without the first reading, which is zero relative to itself.
        let ends = 2.0 * self.sum - (self.last - self.first);
        let lag = self.products - mean * ends + (n - 1.0) * mean * mean;
        effective_count(n, var, lag)
    }

    /// Returns the net reading, like [`mean_of`] of all readings.
    pub fn net(&self, noise: f64) -> Net {
        let n = self.n as f64;
        let Some(value) = self.mean() else {
            return NOTHING;
        };
        let var = (self.squares - self.sum * self.sum / n).max(0.0) / (n - 1.0);
        net_of(n, value, var, noise, || self.effective_samples())
    }
}

/// No reading.
const NOTHING: Net = Net {
    value: f64::NAN,
    sigma: f64::NAN,
};

/// Ratio of signal to noise below which a gauge is too weak for the job.
pub const WEAK: f64 = 3.0;

/// Returns the number of samples of white noise whose mean scatters as much as the mean of this record: `n (1 - r) / (1 + r)`, at least 1. r is the
/// correlation of neighbouring samples.
///
/// # Reference
/// G. V. Bayley and J. M. Hammersley, J. R. Stat. Soc. Suppl. 8 (1946) 184, for a first-order process.
pub fn effective_samples(v: &[f64]) -> f64 {
    let n = v.len() as f64;
    let mean = v.iter().sum::<f64>() / n;
    let var: f64 = v.iter().map(|x| (x - mean).powi(2)).sum();
    let lag: f64 = v.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum();
    effective_count(n, var, lag)
}

fn effective_count(n: f64, var: f64, lag: f64) -> f64 {
    let r = if var > 0.0 {
        (lag / var).clamp(0.0, 0.999)
    } else {
        0.0
    };
    (n * (1.0 - r) / (1.0 + r)).max(1.0)
}

/// Returns the mean of the finite readings and its standard deviation. This is the scatter of the record over its effective samples, or `noise` for a
/// single reading. NaN without readings.
pub fn mean_of(readings: &[f64], noise: f64) -> Net {
    let v: Vec<f64> = readings.iter().copied().filter(|x| x.is_finite()).collect();
    let n = v.len() as f64;
    if v.is_empty() {
        return NOTHING;
    }
    let mean = v.iter().sum::<f64>() / n;
    let var = v.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    net_of(n, mean, var, noise, || effective_samples(&v))
}

fn net_of(n: f64, value: f64, var: f64, noise: f64, effective: impl Fn() -> f64) -> Net {
    if n < FEW {
        return Net {
            value,
            sigma: noise / n.sqrt(),
        };
    }
    // If a record is constant by chance, the variance of its mean is still at least `noise^2 / n`.
    Net {
        value,
        sigma: (var / effective()).max(noise * noise / n).sqrt(),
    }
}

/// Number of samples below which the stated noise replaces the scatter of the record.
const FEW: f64 = 8.0;

/// Returns the net reading of a run: the run minus its zero.
pub fn net(run: Net, zero: Option<Net>) -> Net {
    match zero {
        None => run,
        Some(z) => Net {
            value: run.value - z.value,
            sigma: run.sigma.hypot(z.sigma),
        },
    }
}
