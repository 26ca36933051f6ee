//! Records of any length: one gain matrix, samples streamed through it in blocks, constant memory.

use super::errors::ErrorModel;
use super::kernel::Samples;
use super::solve::fit;
use crate::linalg::Matrix;
use crate::sensitivity::Sensitivity;

/// `f = gain (eps - zero)`, and what a sample's interval takes.
#[derive(Clone, Debug)]
pub struct Filter {
    n: usize,
    k: usize,
    /// `k x n`, by rows.
    gain: Vec<f64>,
    /// `n x k`, S by rows.
    s: Vec<f64>,
    /// Subtracted from each sample, strain.
    zero: Vec<f64>,
    /// Noise variance of each load.
    noise_variance: Vec<f64>,
    /// `k x k`: variance of load l for the square of load m, from errors of single influence coefficients and of whole columns.
    model_variance: Vec<f64>,
    /// Leverage of each gauge.
    pub leverage: Vec<f64>,
    /// Rank of the system.
    pub rank: usize,
}

/// Sums over a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Sums {
    /// Samples without a gap.
    pub samples: u64,
    /// Samples left out because a gauge gave nothing.
    pub gaps: u64,
    /// Smallest of each load.
    pub min: Vec<f64>,
    /// Largest of each load.
    pub max: Vec<f64>,
    /// Sum of each load.
    pub sum: Vec<f64>,
    /// Sum of squares of each load.
    pub sum_of_squares: Vec<f64>,
    /// Sum of squared residuals by gauge, strain^2.
    pub residual: Vec<f64>,
    /// Sum of squared readings by gauge, strain^2.
    pub reading: Vec<f64>,
}

impl Sums {
    /// Nothing yet.
    pub fn new(n: usize, k: usize) -> Self {
        Self {
            samples: 0,
            gaps: 0,
            min: vec![f64::INFINITY; k],
            max: vec![f64::NEG_INFINITY; k],
            sum: vec![0.0; k],
            sum_of_squares: vec![0.0; k],
            residual: vec![0.0; n],
            reading: vec![0.0; n],
        }
    }

    /// Both together.
    pub fn merge(&mut self, other: &Self) {
        self.samples += other.samples;
        self.gaps += other.gaps;
        let add = |a: &mut Vec<f64>, b: &[f64]| a.iter_mut().zip(b).for_each(|(x, y)| *x += y);
        self.min
            .iter_mut()
            .zip(&other.min)
            .for_each(|(x, y)| *x = x.min(*y));
        self.max
            .iter_mut()
            .zip(&other.max)
            .for_each(|(x, y)| *x = x.max(*y));
        add(&mut self.sum, &other.sum);
        add(&mut self.sum_of_squares, &other.sum_of_squares);
        add(&mut self.residual, &other.residual);
        add(&mut self.reading, &other.reading);
    }
}

impl Filter {
    /// The filter for `s` with `zero` (strain by gauge) subtracted; weights are those of the model error at `typical` loads.
    /// `None` where numbers are not finite.
    pub fn new(
        s: &Sensitivity,
        zero: Vec<f64>,
        errors: ErrorModel,
        noise_factor: f64,
        typical: &[f64],
    ) -> Option<Self> {
        let (n, k) = (s.gauges.len(), s.loads.len());
        let variances: Vec<f64> = errors
            .variances(&s.values, typical, noise_factor)
            .iter()
            .map(|v| v.max(f64::MIN_POSITIVE))
            .collect();
        let priors: Vec<Option<f64>> = s
            .loads
            .iter()
            .map(|l| {
                if l.wanted {
                    None
                } else {
                    l.expected.filter(|e| *e > 0.0)
                }
            })
            .collect();
        let fit = fit(&s.values, &vec![0.0; n], &variances, &priors, &s.scales())?;
        let own = errors.noise * errors.noise * noise_factor;
        let noise_variance: Vec<f64> = (0..k)
            .map(|l| {
                let unseen = fit.covariance[(l, l)].is_infinite();
                if unseen {
                    f64::INFINITY
                } else {
                    own * (0..n).map(|g| fit.gain[(l, g)].powi(2)).sum::<f64>()
                }
            })
            .collect();
        let rel2 = errors.model_rel * errors.model_rel;
        let model_variance = Matrix::from_fn(k, k, |l, m| {
            let single: f64 = (0..n)
                .map(|g| (fit.gain[(l, g)] * s.values[(g, m)]).powi(2))
                .sum();
            rel2 * (single + if l == m { 1.0 } else { 0.0 })
        });
        Some(Self {
            n,
            k,
            gain: (0..k)
                .flat_map(|l| (0..n).map(move |g| (l, g)))
                .map(|(l, g)| fit.gain[(l, g)])
                .collect(),
            s: (0..n)
                .flat_map(|g| (0..k).map(move |l| (g, l)))
                .map(|(g, l)| s.values[(g, l)])
                .collect(),
            zero,
            noise_variance,
            model_variance: model_variance.transpose().iter().copied().collect(),
            leverage: fit.leverage,
            rank: fit.rank,
        })
    }

    /// Loads of samples (`n_gauges` strains each, times `to_strain`), appended to `out` (`n_loads` each) and to `sums`.
    /// A sample with a reading that is not finite has loads NaN and counts as a gap.
    pub fn apply(&self, samples: &[f64], to_strain: f64, out: &mut Vec<f64>, sums: &mut Sums) {
        pulp::Arch::new().dispatch(Samples {
            gain: &self.gain,
            s: &self.s,
            zero: &self.zero,
            samples,
            to_strain,
            out,
            sums,
        });
    }

    /// Standard deviation of each load of a sample with loads `f`.
    pub fn sigma(&self, f: &[f64]) -> Vec<f64> {
        (0..self.k)
            .map(|l| {
                let model: f64 = self.model_variance[l * self.k..(l + 1) * self.k]
                    .iter()
                    .zip(f)
                    .map(|(b, v)| b * v * v)
                    .sum();
                (self.noise_variance[l] + model).sqrt()
            })
            .collect()
    }

    /// Standard deviation of a change of load `l` between two samples, `change` that of all loads. Noise enters twice; errors of the
    /// model, which both samples share, with what changes.
    pub fn sigma_of_change(&self, l: usize, change: &[f64]) -> f64 {
        let model: f64 = self
            .model_variance
            .iter()
            .skip(l * self.k)
            .zip(change)
            .map(|(b, v)| b * v * v)
            .sum();
        let noise = self.noise_variance.get(l).copied().unwrap_or(f64::NAN);
        (2.0 * noise + model).sqrt()
    }

    /// Number of loads.
    pub fn n_loads(&self) -> usize {
        self.k
    }

    /// Number of gauges.
    pub fn n_gauges(&self) -> usize {
        self.n
    }
}
