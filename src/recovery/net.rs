//! Net readings: a run's mean less the unloaded run's, with the noise of both, and whether a gauge says anything.

/// A net reading, strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Net {
    /// Mean of the run less mean of the zero.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

impl Net {
    /// Size over noise; NaN where the gauge gave nothing.
    pub fn signal_to_noise(&self) -> f64 {
        self.value.abs() / self.sigma
    }
}

/// Signal to noise under which a gauge is too weak for the job.
pub const WEAK: f64 = 3.0;

/// Samples of white noise whose mean scatters as much as this record's: `n (1 - r) / (1 + r)`, r the correlation of neighbours; at least 1.
///
/// # Reference
/// G. V. Bayley and J. M. Hammersley, J. R. Stat. Soc. Suppl. 8 (1946) 184, for a first-order process.
pub fn effective_samples(v: &[f64]) -> f64 {
    let n = v.len() as f64;
    let mean = v.iter().sum::<f64>() / n;
    let var: f64 = v.iter().map(|x| (x - mean).powi(2)).sum();
    let lag: f64 = v.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum();
    let r = if var > 0.0 {
        (lag / var).clamp(0.0, 0.999)
    } else {
        0.0
    };
    (n * (1.0 - r) / (1.0 + r)).max(1.0)
}

/// Mean of the finite readings and its standard deviation: the scatter of the record over its effective samples, `noise` for a single
/// reading. NaN without readings.
pub fn mean_of(readings: &[f64], noise: f64) -> Net {
    let v: Vec<f64> = readings.iter().copied().filter(|x| x.is_finite()).collect();
    let n = v.len() as f64;
    if v.is_empty() {
        return Net {
            value: f64::NAN,
            sigma: f64::NAN,
        };
    }
    let mean = v.iter().sum::<f64>() / n;
    if v.len() < FEW {
        return Net {
            value: mean,
            sigma: noise / n.sqrt(),
        };
    }
    let var = v.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    // A record that happens to stand still is no better than its gauge over the same number of samples.
    Net {
        value: mean,
        sigma: (var / effective_samples(&v)).max(noise * noise / n).sqrt(),
    }
}

/// Samples under which a record's own scatter says too little.
const FEW: usize = 8;

/// A run less its zero.
pub fn net(run: Net, zero: Option<Net>) -> Net {
    match zero {
        None => run,
        Some(z) => Net {
            value: run.value - z.value,
            sigma: run.sigma.hypot(z.sigma),
        },
    }
}
