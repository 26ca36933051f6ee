//! Forms of a covariance of the noise, fitted to residuals by maximum likelihood.

use crate::linalg::{Matrix, spd};
use crate::sensitivity::GaugeNoise;

/// Sample covariance of residuals.
pub(super) struct Sample {
    /// Orthonormal rows to which no load contributes, `m x n`.
    pub t: Matrix,
    /// Covariance of `T y`, `m x m`.
    pub covariance: Matrix,
    /// Effective degrees of freedom of the form.
    pub dof: f64,
}

impl Sample {
    /// Returns `-dof / 2 (ln |T N T'| + tr((T N T')^-1 C))`; `None` where `T N T'` is not positive definite.
    fn log_likelihood(&self, noise: &Matrix) -> Option<f64> {
        let m = self.t.nrows();
        let sigma = &self.t * noise * self.t.transpose();
        let l = spd::cholesky(sigma.as_slice(), m)?;
        let inverse = spd::gram_of_lower(&spd::inverse_lower(&l, m), m);
        let trace = spd::trace_of_product(&inverse, self.covariance.as_slice());
        Some(-0.5 * self.dof * (spd::log_det(&l, m) + trace))
    }

    /// Returns the log likelihood of the sample covariance itself, the largest of all.
    pub fn largest_log_likelihood(&self) -> Option<f64> {
        let m = self.t.nrows();
        let l = spd::cholesky(self.covariance.as_slice(), m)?;
        Some(-0.5 * self.dof * (spd::log_det(&l, m) + m as f64))
    }
}

/// Form of a covariance of the noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form {
    /// Whether each gauge has a separate standard deviation.
    pub by_gauge: bool,
    /// Whether any two gauges have a common correlation.
    pub correlated: bool,
}

/// Fit of a form.
pub(super) struct Fit {
    /// `n x n`.
    pub covariance: Matrix,
    /// Number of parameters.
    pub parameters: usize,
    /// Log likelihood.
    pub log_likelihood: f64,
}

/// Rules of the search for the largest likelihood.
struct Search {
    /// Steps at most; a search that needs more ends at its last step.
    steps: usize,
    /// Gain of log likelihood below which the fit stops. It is far below a gain that a test can detect.
    found: f64,
    /// Damping beyond which no step gains: the step is then smaller than rounding.
    most_damping: f64,
    /// Change of a logarithm in one step at most: a factor of e on a standard deviation.
    ln_step: f64,
}

const SEARCH: Search = Search {
    steps: 60,
    found: 1e-6,
    most_damping: 1e8,
    ln_step: 1.0,
};

/// Parameters of a form.
#[derive(Clone)]
struct Parameters {
    ln_sd: Vec<f64>,
    correlation: f64,
}

impl Parameters {
    /// Returns equal and independent noise of the size that the sample has.
    fn with_equal_noise(r: &Sample) -> Self {
        let (m, n) = r.t.shape();
        let mean = r.covariance.diagonal().sum() / m as f64;
        Self {
            ln_sd: vec![0.5 * mean.ln(); n],
            correlation: 0.0,
        }
    }

    fn sd(&self) -> Vec<f64> {
        self.ln_sd.iter().map(|v| v.exp()).collect()
    }

    fn covariance(&self) -> Matrix {
        let noise = GaugeNoise::with_correlation(&self.sd(), self.correlation);
        noise.covariance().clone()
    }

    /// Returns the deviation of each logarithm from the mean over the gauges.
    fn deviations(&self) -> Vec<f64> {
        let mean = self.ln_sd.iter().sum::<f64>() / self.ln_sd.len().max(1) as f64;
        self.ln_sd.iter().map(|v| v - mean).collect()
    }
}

impl Form {
    /// Derivatives of the covariance by the parameters: logarithms of the standard deviations, then the correlation.
    fn derivatives(self, p: &Parameters) -> Vec<Matrix> {
        let n = p.ln_sd.len();
        let whole = p.covariance();
        let mut out: Vec<Matrix> = match self.by_gauge {
            false => vec![&whole * 2.0],
            true => {
                let times = |i: usize, j: usize, g: usize| {
                    f64::from(u8::from(i == g)) + f64::from(u8::from(j == g))
                };
                let of_gauge = |g| Matrix::from_fn(n, n, |i, j| times(i, j, g) * whole[(i, j)]);
                (0..n).map(of_gauge).collect()
            }
        };
        if self.correlated {
            let sd = p.sd();
            let entry = |i: usize, j: usize| if i == j { 0.0 } else { sd[i] * sd[j] };
            out.push(Matrix::from_fn(n, n, entry));
        }
        out
    }

    /// Returns Rao's score statistic of equal and independent noise against this form. It is about the gain of a fit in twice the log likelihood.
    pub fn score_statistic(self, r: &Sample) -> Option<f64> {
        let (score, information) = self.score(r, &Parameters::with_equal_noise(r), 0.0)?;
        let step = solve(&information, &score)?;
        Some(spd::dot(&step, &score))
    }

    /// Returns the fit by scoring with Levenberg's damping. `ln_sd_between` is the prior standard deviation of the logarithm of the noise of a gauge
    /// about the mean. Without this prior, the variance of a gauge with large leverage can be estimated as zero. `None` if numbers are not finite.
    pub fn fit(self, r: &Sample, ln_sd_between: f64) -> Option<Fit> {
        let n = r.t.ncols();
        let precision = match self.by_gauge {
            true => ln_sd_between.powi(-2),
            false => 0.0,
        };
        let value = |p: &Parameters| -> Option<(f64, f64)> {
            let l = r.log_likelihood(&p.covariance())?;
            let off = p.deviations();
            Some((l, l - 0.5 * precision * spd::dot(&off, &off)))
        };
        let mut at = Parameters::with_equal_noise(r);
        let (mut likelihood, mut now) = value(&at)?;
        let mut damping = 1e-3;
        let least = -0.5 / n.saturating_sub(1).max(1) as f64;
        let parameters = self.derivatives(&at).len();
        for _ in 0..SEARCH.steps {
            let (score, information) = self.score(r, &at, precision)?;
            let next = loop {
                if damping > SEARCH.most_damping {
                    break None;
                }
                let mut damped = information.clone();
                for i in 0..parameters {
                    damped[i * parameters + i] *= 1.0 + damping;
                }
                let step = solve(&damped, &score);
                let mut next = at.clone();
                if let Some(step) = &step {
                    for (g, v) in next.ln_sd.iter_mut().enumerate() {
                        *v += step[if self.by_gauge { g } else { 0 }]
                            .clamp(-SEARCH.ln_step, SEARCH.ln_step);
                    }
                    if self.correlated {
                        let to = at.correlation + step[parameters - 1];
                        // One step goes at most halfway to full correlation.
                        next.correlation = to.clamp(least, 0.5 * (1.0 + at.correlation));
                    }
                }
                match value(&next).filter(|v| step.is_some() && v.1 >= now) {
                    Some(found) => break Some((next, found)),
                    None => damping *= 10.0,
                }
            };
            let Some((next, (l, penalised))) = next else {
                break;
            };
            let gained = penalised - now;
            (at, likelihood, now) = (next, l, penalised);
            damping = (damping / 10.0).max(1e-9);
            if gained < SEARCH.found {
                break;
            }
        }
        Some(Fit {
            covariance: at.covariance(),
            parameters,
            log_likelihood: likelihood,
        })
    }

    /// Returns the derivatives of the penalised log likelihood and Fisher's information, by rows.
    fn score(self, r: &Sample, at: &Parameters, precision: f64) -> Option<(Vec<f64>, Vec<f64>)> {
        let (m, n) = r.t.shape();
        let sigma = &r.t * at.covariance() * r.t.transpose();
        let l = spd::cholesky(sigma.as_slice(), m)?;
        let inverse = spd::gram_of_lower(&spd::inverse_lower(&l, m), m);
        let back = r.t.transpose() * Matrix::from_row_slice(m, m, &inverse);
        let w = &back * &r.t;
        let off = &back * &r.covariance * back.transpose() - &w;
        let derivatives = self.derivatives(at);
        let half = 0.5 * r.dof;
        let mut score: Vec<f64> = derivatives.iter().map(|d| half * d.dot(&off)).collect();
        let through: Vec<Matrix> = derivatives.iter().map(|d| d * &w).collect();
        let turned: Vec<Matrix> = through.iter().map(Matrix::transpose).collect();
        let q = derivatives.len();
        let mut information = vec![0.0; q * q];
        for a in 0..q {
            for b in 0..=a {
                let entry = half * through[a].dot(&turned[b]);
                information[a * q + b] = entry;
                information[b * q + a] = entry;
            }
        }
        if self.by_gauge {
            for (g, d) in at.deviations().iter().enumerate() {
                score[g] -= precision * d;
                for h in 0..n {
                    let own = f64::from(u8::from(g == h));
                    information[g * q + h] += precision * (own - 1.0 / n as f64);
                }
            }
        }
        Some((score, information))
    }
}

/// Solves `a x = b` for a symmetric positive definite `a`, by rows.
fn solve(a: &[f64], b: &[f64]) -> Option<Vec<f64>> {
    let k = b.len();
    let inverse = spd::inverse_lower(&spd::cholesky(a, k)?, k);
    let mut x = vec![0.0; k];
    spd::times(&spd::gram_of_lower(&inverse, k), b, &mut x);
    Some(x)
}
