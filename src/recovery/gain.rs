//! The one linear estimate of loads that runs and records share, with its covariance.

use super::errors::ErrorModel;
use super::types::{Shift, ShiftKind, Widening};
use crate::estimate::{LinearEstimate, LinearGaussian, ReadingErrors};
use crate::linalg::Matrix;
use crate::sensitivity::{LoadForms, Sensitivity, Uncertainty};

/// Linear estimate of loads, `f = gain y`, for readings `y` of the gauges [`Self::used`]. The model's error is weighted at typical loads.
///
/// The covariance of the errors is `gain (N + M(f)) gain' + (gain S - 1) P (gain S - 1)' + C(f)`. `N` is the noise. `M(f)` are the errors of single
/// coefficients and `C(f)` the errors of whole columns, both at loads `f`. `P` are the stated sizes of nuisance loads. If the model error is weighted
/// at `f` itself, it is the covariance of the posterior.
///
/// # Example
/// The gain inverts S: `gain S = 1`, and readings `S f` give `f` without the third gauge too.
/// ```
/// use strainbridge::linalg::Matrix;
/// use strainbridge::recovery::{ErrorModel, Gain, Widening};
/// use strainbridge::sensitivity::{Load, Sensitivity};
///
/// let s = Sensitivity {
///     gauges: ["G1", "G2", "G3"].map(str::to_owned).to_vec(),
///     loads: vec![Load::from_name("left"), Load::from_name("right")],
///     values: 1e-6 * Matrix::from_row_slice(3, 2, &[2.0, 1.0, -1.0, 3.0, 1.0, 1.0]),
///     uncertainty: None,
///     noise: None,
/// };
/// let errors = ErrorModel { noise: 1e-6, model_rel: 0.0 };
/// let readings = [5e-6, f64::NAN, 3e-6]; // S f for f = (2, 1); G2 gave nothing
/// let gain = Gain::new(&s, &[0, 2], errors, 1.0, &[0.0, 0.0]).unwrap();
/// assert!(gain.loads(&readings).iter().zip([2.0, 1.0]).all(|(f, exact)| (f - exact).abs() < 1e-9));
///
/// let all = Gain::new(&s, &[0, 1, 2], errors, 1.0, &[0.0, 0.0]).unwrap();
/// assert!((&all.gain * &s.values - Matrix::identity(2, 2)).amax() < 1e-12);
/// // More gauges never widen an interval.
/// let [few, many] = [&gain, &all].map(|g| g.sigma(&[2.0, 1.0], &Widening::none()));
/// assert!(many.iter().zip(&few).all(|(m, f)| m <= f));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Gain {
    /// Gauges of S that read, ascending.
    pub used: Vec<usize>,
    /// `n_loads x n_used`.
    pub gain: Matrix,
    /// Leverage of each used gauge.
    pub leverage: Vec<f64>,
    /// Rank of the system; under the number of loads, some loads are arbitrary ([`Self::is_seen`]).
    pub rank: usize,
    /// `n_used x n_loads`.
    s: Matrix,
    /// `n_loads x n_loads`, from noise and nuisance loads, sums among them; infinite on the diagonal for a load that the readings do not determine.
    base: Matrix,
    /// `n_loads x n_loads`: variance of load l for the square of load m, from errors of single coefficients and of whole columns.
    model_variance: Matrix,
    /// Loads and factors behind every row of `gain`: itself, or a sum of loads.
    rows: Vec<Vec<(usize, f64)>>,
    errors: ErrorModel,
    /// Covariance of a calibrated S for the gauges used, and the variance of each row of `gain` as a function of the loads of S.
    calibrated: Option<(Uncertainty, LoadForms)>,
}

impl Gain {
    /// Returns the estimate from the gauges `used`. `noise_factor` multiplies the noise variance. `typical` are the loads at which the model error is
    /// weighted. `None` if numbers are not finite.
    pub fn new(
        s: &Sensitivity,
        used: &[usize],
        errors: ErrorModel,
        noise_factor: f64,
        typical: &[f64],
    ) -> Option<Self> {
        let (n, k) = (used.len(), s.loads.len());
        let rows = Matrix::from_fn(n, k, |i, l| s.values[(used[i], l)]);
        let variances = errors.variances(&rows, typical, noise_factor);
        let priors = s.priors();
        let known = s.uncertainty.as_ref().map(|u| u.of_gauges(used));
        let noise = errors.noise_covariance(s, used, noise_factor);
        let correlated = (known.is_some() || noise.is_some()).then(|| {
            let mut covariance = match &known {
                Some(known) => known.strain_covariance(n, typical),
                None => vec![0.0; n * n],
            };
            for (g, v) in variances.iter().enumerate() {
                covariance[g * n + g] += v;
            }
            if let Some(noise) = &noise {
                let as_stated = errors.noise_variance(noise_factor);
                for (i, v) in covariance.iter_mut().enumerate() {
                    let stated = if i / n == i % n { as_stated } else { 0.0 };
                    *v += noise[(i / n, i % n)] - stated;
                }
            }
            covariance
        });
        let model = LinearGaussian {
            rows: &rows,
            errors: match &correlated {
                None => ReadingErrors::Variances(&variances),
                Some(covariance) => ReadingErrors::Covariance(covariance),
            },
            prior_sd: &priors,
            scales: &s.scales(),
        };
        let LinearEstimate {
            covariance,
            gain,
            leverage,
            rank,
            ..
        } = model.estimate(&vec![0.0; n])?;
        let mut base = match &noise {
            None => (&gain * gain.transpose()) * errors.noise_variance(noise_factor),
            Some(noise) => &gain * noise * gain.transpose(),
        };
        let passed = &gain * &rows;
        for (m, prior) in priors.iter().enumerate() {
            let Some(sd) = prior else { continue };
            let column: Vec<f64> = (0..k)
                .map(|l| (passed[(l, m)] - f64::from(u8::from(l == m))) * sd)
                .collect();
            for a in 0..k {
                for b in 0..k {
                    base[(a, b)] += column[a] * column[b];
                }
            }
        }
        // The factor on sigma from runs left out of the calibration applies to every part of sigma.
        if let Some(u) = &known {
            base *= u.scale * u.scale;
        }
        for l in (0..k).filter(|&l| covariance[(l, l)].is_infinite()) {
            base[(l, l)] = f64::INFINITY;
        }
        let rel2 = errors.model_rel * errors.model_rel;
        let model_variance = Matrix::from_fn(k, k, |l, m| {
            let single: f64 = (0..n).map(|i| (gain[(l, i)] * rows[(i, m)]).powi(2)).sum();
            rel2 * (single + if l == m { 1.0 } else { 0.0 })
        });
        Some(Self {
            used: used.to_vec(),
            leverage,
            rank,
            s: rows,
            base,
            model_variance,
            rows: (0..k).map(|l| vec![(l, 1.0)]).collect(),
            errors,
            calibrated: known.map(|u| {
                let forms = u.load_forms(&gain);
                (u, forms)
            }),
            gain,
        })
    }

    /// Returns this gain with an additional covariance of its readings, `n_used x n_used`, strain^2.
    pub fn with_noise(&self, of_readings: &Matrix) -> Self {
        Self {
            base: &self.base + &self.gain * of_readings * self.gain.transpose(),
            ..self.clone()
        }
    }

    /// Returns the weights of the used gauges in load `l`, or in a sum of loads.
    pub fn weights(&self, l: usize) -> Vec<f64> {
        self.gain.row(l).iter().copied().collect()
    }

    /// Returns this gain with a row for each sum of loads (loads and factors), so that sums have their own intervals.
    pub fn with_sums(&self, sums: &[Vec<(usize, f64)>]) -> Self {
        let (k, n) = self.gain.shape();
        let own = (0..k).map(|l| vec![(l, 1.0)]);
        let rows: Vec<Vec<(usize, f64)>> = own.chain(sums.iter().cloned()).collect();
        let gain = Matrix::from_fn(rows.len(), n, |a, i| {
            rows[a].iter().map(|(l, c)| c * self.gain[(*l, i)]).sum()
        });
        let base = Matrix::from_fn(rows.len(), rows.len(), |a, b| {
            let pairs = rows[a]
                .iter()
                .flat_map(|x| rows[b].iter().map(move |y| (x, y)));
            pairs
                .map(|((i, c), (j, d))| c * d * self.base[(*i, *j)])
                .sum()
        });
        let rel2 = self.errors.model_rel * self.errors.model_rel;
        let model_variance = Matrix::from_fn(rows.len(), self.s.ncols(), |a, m| {
            let single: f64 = (0..n)
                .map(|i| (gain[(a, i)] * self.s[(i, m)]).powi(2))
                .sum();
            let column: f64 = rows[a].iter().filter(|t| t.0 == m).map(|t| t.1).sum();
            rel2 * (single + column * column)
        });
        let calibrated = self.calibrated.as_ref();
        let calibrated = calibrated.map(|(u, _)| (u.clone(), u.load_forms(&gain)));
        Self {
            gain,
            base,
            model_variance,
            rows,
            calibrated,
            ..self.clone()
        }
    }

    /// Returns the number of loads, including sums.
    pub fn n_loads(&self) -> usize {
        self.gain.nrows()
    }

    /// Returns whether the readings determine load `l`.
    pub fn is_seen(&self, l: usize) -> bool {
        self.base[(l, l)].is_finite()
    }

    /// Returns the loads from the strain of all gauges of S.
    pub fn loads(&self, strain: &[f64]) -> Vec<f64> {
        (0..self.n_loads())
            .map(|l| {
                let terms = self.used.iter().enumerate();
                terms.map(|(i, &g)| self.gain[(l, i)] * strain[g]).sum()
            })
            .collect()
    }

    /// Returns the covariance of the estimate at loads `f`, by rows.
    pub fn covariance(&self, f: &[f64], widening: &Widening) -> Vec<f64> {
        let k = self.n_loads();
        let model: Vec<f64> = self
            .s
            .row_iter()
            .map(|row| {
                self.errors
                    .model_error_covariance(row.iter().copied(), f, f)
            })
            .collect();
        let calibrated = self.calibrated_covariance(f);
        let shifts = self.shifts(f, widening);
        let mut out = vec![0.0; k * k];
        for a in 0..k {
            for b in 0..k {
                let single: f64 = model
                    .iter()
                    .enumerate()
                    .map(|(i, m)| self.gain[(a, i)] * self.gain[(b, i)] * m)
                    .sum();
                let pairs = self.rows[a]
                    .iter()
                    .flat_map(|x| self.rows[b].iter().map(move |y| (x, y)));
                let column: f64 = pairs
                    .filter(|(x, y)| x.0 == y.0)
                    .map(|(x, y)| x.1 * y.1 * self.errors.column_variance(f[x.0]))
                    .sum();
                let gauges: f64 = shifts.iter().map(|c| c[a] * c[b]).sum();
                out[a * k + b] = widening.variance_factor * (self.base[(a, b)] + single + column)
                    + calibrated.get(a * k + b).copied().unwrap_or(0.0)
                    + gauges;
            }
        }
        out
    }

    /// Returns the standard deviation of each load at loads `f`: the roots of the diagonal of [`Self::covariance`].
    pub fn sigma(&self, f: &[f64], widening: &Widening) -> Vec<f64> {
        let shifts = self.shifts(f, widening);
        (0..self.n_loads())
            .map(|l| {
                let own = self.base[(l, l)] + self.model_part(l, f);
                let gauges: f64 = shifts.iter().map(|c| c[l] * c[l]).sum();
                (widening.variance_factor * own + gauges).sqrt()
            })
            .collect()
    }

    /// Returns the standard deviation of each load from noise and nuisance loads: the part that no two runs have in common.
    pub fn own_sigma(&self) -> Vec<f64> {
        (0..self.n_loads())
            .map(|l| self.base[(l, l)].sqrt())
            .collect()
    }

    /// Returns the standard deviation of a change of load `l` between two samples, at the change `change` of all loads. Noise enters twice. Both
    /// samples share the model error, which enters with the change only. Nuisance loads enter as if they changed as well.
    pub fn sigma_of_change(&self, l: usize, change: &[f64], widening: &Widening) -> f64 {
        let shifts: f64 = self
            .shifts_of(change, widening, |kind| kind == ShiftKind::Gain)
            .iter()
            .map(|c| c[l] * c[l])
            .sum();
        let calibrated = self.calibrated.as_ref().map_or(0.0, |(_, forms)| {
            forms.variance_of_change(l, self.of_s(change))
        });
        let own = 2.0 * self.base[(l, l)] + self.stated_part(l, change) + calibrated;
        (widening.variance_factor * own + shifts).sqrt()
    }

    fn model_part(&self, l: usize, f: &[f64]) -> f64 {
        self.stated_part(l, f) + self.calibrated_part(l, f)
    }

    /// Variance of load `l` at loads `f` that the stated error of a model makes.
    fn stated_part(&self, l: usize, f: &[f64]) -> f64 {
        let row = self.model_variance.row(l);
        row.iter().zip(f).map(|(b, v)| b * v * v).sum()
    }

    /// Variance of load `l` at loads `f` that the uncertainty of a calibrated S and the scatter of repeats make.
    fn calibrated_part(&self, l: usize, f: &[f64]) -> f64 {
        let forms = self.calibrated.as_ref().map(|c| &c.1);
        forms.map_or(0.0, |forms| forms.variance(l, self.of_s(f)))
    }

    /// Loads of S in a list whose last entries are sums.
    fn of_s<'f>(&self, f: &'f [f64]) -> &'f [f64] {
        f.get(..self.s.ncols()).unwrap_or(f)
    }

    /// `scale^2 gain Cov(eps | f) gain'` of a calibrated S, by rows; empty without one.
    fn calibrated_covariance(&self, f: &[f64]) -> Vec<f64> {
        let Some((known, _)) = &self.calibrated else {
            return Vec::new();
        };
        let n = self.used.len();
        let strain = Matrix::from_row_slice(n, n, &known.strain_covariance(n, self.of_s(f)));
        let loads = &self.gain * strain * self.gain.transpose() * (known.scale * known.scale);
        loads.iter().copied().collect()
    }

    fn shifts(&self, f: &[f64], widening: &Widening) -> Vec<Vec<f64>> {
        self.shifts_of(f, widening, |_| true)
    }

    /// Returns the change of every load by the errors of single gauges.
    fn shifts_of(
        &self,
        f: &[f64],
        widening: &Widening,
        taken: impl Fn(ShiftKind) -> bool,
    ) -> Vec<Vec<f64>> {
        let list = widening.shifts.iter().filter(|s| taken(s.kind));
        list.filter_map(|s| self.shift(f, s)).collect()
    }

    /// Returns the change of every load by the error of one gauge, at loads `f`; `None` if the gauge does not read.
    pub fn shift(&self, f: &[f64], shift: &Shift) -> Option<Vec<f64>> {
        let i = self.used.binary_search(&shift.gauge).ok()?;
        let strain = match shift.kind {
            ShiftKind::Offset => shift.size,
            ShiftKind::Gain => {
                let row = self.s.row(i);
                shift.size * row.iter().zip(f).map(|(s, f)| s * f).sum::<f64>()
            }
        };
        let k = self.n_loads();
        Some((0..k).map(|l| self.gain[(l, i)] * strain).collect())
    }
}
