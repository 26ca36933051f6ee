//! Noise by gauge and its correlation, estimated from residuals that contradict equal and independent noise.
//!
//! Residuals `z = T y` are the part of the readings that no load causes. First their mean and the part that depends linearly on the recovered loads
//! are subtracted. This part includes errors of S. The remainder has the covariance `T N T'`. Three forms of `N` are fitted: one standard deviation
//! with a correlation common to all pairs, one for each gauge, and both. The simplest form that the residuals do not contradict is used.
//!
//! # Reference
//! K. G. Jöreskog, Psychometrika 43 (1978) 443 (fit of structured covariances, likelihood ratio); M. W. Browne, Br. J. Math. Stat. Psychol. 37
//! (1984) 62 (factor for heavy tails); M. S. Bartlett, J. R. Stat. Soc. B 16 (1954) 296 (factor for few runs).

mod form;

use super::errors::ErrorModel;
use super::gain::Gain;
use super::residuals::complement;
use super::types::Readings;
use super::verdict::{CERTAIN_CHANCE, SIGNIFICANT};
use crate::estimate::{chi_square_tail, effective_rows, independent_share};
use crate::finding::{Finding, Severity};
use crate::linalg::{Matrix, dense, spd};
use crate::sensitivity::{GaugeNoise, Sensitivity};
use crate::units::{MICROSTRAIN, number};
use form::{Fit, Form, Sample};
use std::collections::BTreeMap;

/// Code of findings on noise that the job does not state, or that is not as stated.
pub const NOISE_ASSUMED: &str = "noise-assumed";

/// Rules of the estimate of noise.
struct Rules {
    /// Standard deviation of a load over its value by stated noise up to which the stated noise is used. An interval of 95 % then contains 92.5 %.
    too_narrow: f64,
    /// Standard deviation of a load by stated noise over its value by the best estimate, up to which the stated noise is used.
    too_wide: f64,
    /// Effective runs for each dimension of the residuals from which they are tested: with fewer their covariance is nearly singular.
    runs_per_dimension: f64,
    /// Effective runs for each gauge from which noise by gauge is estimated: from there on intervals of 95 % contain 94 % in simulation.
    runs_per_gauge: f64,
    /// Noise of a gauge over the stated noise beyond which it is a fault of the gauge.
    most_noise: f64,
    /// Standard deviation, beforehand, of the logarithm of a gauge's noise about the mean of all: gauges of one logger differ by less.
    ln_sd_between: f64,
    /// Gauges up to which noise by gauge is estimated: a second of work.
    most_gauges: usize,
    /// Chance of the score statistic above which no form is fitted: the fits would not contradict equal and independent noise either.
    worth_fitting: f64,
    /// Share of the squared drift of all residuals, from which it is the drift of one gauge: noise that wanders does so at all gauges.
    of_one_gauge: f64,
}

const RULES: Rules = Rules {
    too_narrow: 1.1,
    too_wide: 1.3,
    runs_per_dimension: 3.0,
    runs_per_gauge: 10.0,
    most_noise: 5.0,
    ln_sd_between: 1.0,
    most_gauges: 64,
    worth_fitting: 0.02,
    of_one_gauge: 0.8,
};

/// Noise that residuals show.
#[derive(Default)]
pub(super) struct ShownNoise {
    /// Noise of all gauges of S. `None` if it equals the stated noise.
    pub noise: Option<GaugeNoise>,
    /// Finding on the noise, or on noise that can't be determined.
    pub finding: Option<Finding>,
}

/// Returns the noise from samples without load, with a finding. Each row is a sample of strain by gauge of S. `None` if the noise agrees with the
/// stated noise.
///
/// With at least `Rules::runs_per_gauge` effective samples for each gauge, the noise may be the covariance of the samples. The mean over the gauges
/// is never below the stated noise, because readings under load can have more noise than at rest.
pub fn noise_without_load(
    s: &Sensitivity,
    rows: &[Vec<f64>],
    errors: ErrorModel,
) -> (Option<GaugeNoise>, Option<Finding>) {
    let residuals = Parts::without_load(s, rows, errors).and_then(Residuals::from_parts);
    let unloaded = residuals.map(|r| Residuals {
        is_unloaded: true,
        ..r
    });
    let shown = unloaded.and_then(|r| r.noise(s, errors));
    let shown = shown.unwrap_or_default();
    (shown.noise, shown.finding)
}

/// Returns the noise that the residuals of `readings` show.
///
/// It does not replace scatter that repeated calibration runs determine, or noise that is stated by gauge. The mean over the gauges is never below
/// the stated noise.
pub(super) fn shown_noise(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
) -> ShownNoise {
    let is_learnt = s.uncertainty.as_ref().is_some_and(|u| u.dof.is_finite());
    if is_learnt || s.noise.is_some() || errors.noise <= 0.0 {
        return ShownNoise::default();
    }
    let residuals = Parts::from_readings(s, readings, errors).and_then(Residuals::from_parts);
    let shown = residuals.and_then(|r| r.noise(s, errors));
    shown.unwrap_or_default()
}

/// Returns the share of independent samples in samples of a record, by the correlation in time of the noise in their residuals. A steady drift, for
/// example of the zero of one gauge, is a fault and not noise.
pub(super) fn share_of_samples(s: &Sensitivity, readings: &[Readings], errors: ErrorModel) -> f64 {
    let parts = Parts::from_readings(s, readings, errors);
    let noise = parts.and_then(|mut p| {
        let plain = p.of_noise()?;
        let (runs, columns) = p.with.shape();
        let middle = 0.5 * (runs as f64 - 1.0);
        let trend = Matrix::from_fn(runs, 1, |i, _| i as f64 - middle);
        let drift = plain.0.transpose() * &trend;
        let part = |g: usize| {
            let own = p.t.column(g);
            own.dot(&drift).powi(2) / (own.norm_squared() * drift.norm_squared())
        };
        let parts = (0..p.t.ncols()).map(part).filter(|v| v.is_finite());
        if parts.fold(0.0, f64::max) < RULES.of_one_gauge {
            return Some(plain);
        }
        p.with = p.with.resize_horizontally(columns + 1, 0.0);
        p.with.set_column(columns, &trend.column(0));
        p.of_noise()
    });
    noise.map_or(1.0, |(z, _)| independent_share(&z))
}

/// Residuals of runs in which the same gauges read, in units of the stated noise.
struct Residuals {
    /// Gauges of S that read.
    used: Vec<usize>,
    sample: Sample,
    /// Runs.
    runs: usize,
    /// Factor by which heavy tails make likelihood ratios larger.
    tails: f64,
    /// Whether no load acted: the covariance of all gauges is then known.
    is_unloaded: bool,
}

/// Likelihood ratio test between the fitted forms of the noise.
struct Fits {
    /// Log likelihood of the sample covariance itself.
    largest: f64,
    /// Factor on twice a difference of log likelihoods.
    factor: f64,
    /// Dimensions of the residuals.
    m: usize,
}

impl Fits {
    fn deviance(&self, fit: &Fit) -> f64 {
        (self.factor * (self.largest - fit.log_likelihood)).max(0.0)
    }

    /// Chance of residuals that contradict the fit as much; 0 where it has as many parameters as they have numbers.
    fn chance(&self, fit: &Fit) -> f64 {
        match (self.m * (self.m + 1) / 2).saturating_sub(fit.parameters) {
            0 => 0.0,
            free => chi_square_tail(self.deviance(fit), free as f64),
        }
    }

    /// Returns whether the residuals do not contradict the fit.
    fn explains(&self, fit: &Fit) -> bool {
        self.chance(fit) > SIGNIFICANT
    }

    /// Chance that the parameters which `more` has beyond `less` explain as much.
    fn chance_of_gain(&self, less: &Fit, more: &Fit) -> f64 {
        let gained = (self.deviance(less) - self.deviance(more)).max(0.0);
        chi_square_tail(gained, (more.parameters - less.parameters) as f64)
    }

    /// Returns whether the parameters that `more` has beyond `less` explain nothing.
    fn is_enough(&self, less: &Fit, more: &Fit) -> bool {
        self.chance_of_gain(less, more) > SIGNIFICANT
    }
}

/// Residuals before what has other causes than noise is taken out.
struct Parts {
    /// Gauges of S that read.
    used: Vec<usize>,
    /// `runs x m`.
    z: Matrix,
    /// `m x n`.
    t: Matrix,
    /// Columns over the runs along which residuals are no noise.
    with: Matrix,
}

impl Parts {
    /// Parts of runs in which the same gauges read; `None` where no reading is spare.
    fn from_readings(s: &Sensitivity, readings: &[Readings], errors: ErrorModel) -> Option<Self> {
        let mut sets: BTreeMap<Vec<usize>, Vec<&Readings>> = BTreeMap::new();
        for r in readings {
            let reads = |g: &usize| r.strain.get(*g).is_some_and(|v| v.is_finite());
            let used = (0..s.gauges.len()).filter(reads).collect();
            sets.entry(used).or_default().push(r);
        }
        let (used, rows) = sets.into_iter().max_by_key(|(_, rows)| rows.len())?;
        let (n, runs) = (used.len(), rows.len());
        let columns = dense::unit_columns(&s.values.select_rows(&used));
        let t = complement(&columns)?.transpose();
        let m = t.nrows();
        let unit = |r: &Readings| 1.0 / errors.noise_variance(r.noise_factor).sqrt();
        let y = Matrix::from_fn(runs, n, |i, g| rows[i].strain[used[g]] * unit(rows[i]));
        let z = &y * t.transpose();
        let made = dense::svd(&columns)?.u.columns(0, n - m).into_owned();
        let loads = &y * made;
        let with = Matrix::from_fn(runs, n - m + 1, |i, l| match l < n - m {
            true => loads[(i, l)],
            false => 1.0,
        });
        Some(Parts { used, z, t, with })
    }

    /// Parts of samples without load; `None` where there are none.
    fn without_load(s: &Sensitivity, rows: &[Vec<f64>], errors: ErrorModel) -> Option<Self> {
        let reads = |g: &usize| rows.iter().any(|r| r[*g].is_finite());
        let used: Vec<usize> = (0..s.gauges.len()).filter(reads).collect();
        let whole = |r: &&Vec<f64>| used.iter().all(|g| r[*g].is_finite());
        let rows: Vec<&Vec<f64>> = rows.iter().filter(whole).collect();
        let (n, runs) = (used.len(), rows.len());
        if runs == 0 || errors.noise <= 0.0 {
            return None;
        }
        let z = Matrix::from_fn(runs, n, |i, g| rows[i][used[g]] / errors.noise);
        // The mean of the samples is the zero. Neither the mean nor its drift is noise.
        let middle = 0.5 * (runs as f64 - 1.0);
        let with = Matrix::from_fn(runs, 2, |i, l| match l {
            0 => 1.0,
            _ => i as f64 - middle,
        });
        let t = Matrix::identity(n, n);
        Some(Self { used, z, t, with })
    }

    /// Returns the residuals minus their parts along the columns [`Self::with`], `runs x m`, and the number of these columns.
    fn of_noise(&self) -> Option<(Matrix, usize)> {
        let basis = dense::svd(&dense::unit_columns(&self.with))?;
        let kept = basis.s.iter().filter(|v| **v > dense::RANK_TOLERANCE);
        let kept = kept.count();
        let u = basis.u.columns(0, kept).into_owned();
        Some((&self.z - &u * (u.transpose() * &self.z), kept))
    }
}

impl Residuals {
    /// `None` where there are too few for a test.
    fn from_parts(parts: Parts) -> Option<Self> {
        let (m, n) = parts.t.shape();
        let runs = parts.z.nrows();
        let least = RULES.runs_per_dimension * m as f64;
        if m < 2 || (runs as f64) < least {
            return None;
        }
        let (z, kept) = parts.of_noise()?;
        let Parts { used, t, .. } = parts;
        let free = runs.saturating_sub(kept) as f64;
        let dof = free * effective_rows(&z) / runs as f64;
        if !(dof >= least) {
            return None;
        }
        let of_gauges = &z * &t;
        let excess = |e: &[f64]| {
            let squares: f64 = e.iter().map(|v| v * v).sum();
            let fourth: f64 = e.iter().map(|v| v.powi(4)).sum();
            let kurtosis = fourth * runs as f64 / (squares * squares);
            if kurtosis.is_finite() {
                kurtosis - 3.0
            } else {
                0.0
            }
        };
        let columns = of_gauges.column_iter();
        let excess: f64 = columns.map(|c| excess(c.as_slice())).sum::<f64>() / n as f64;
        Some(Self {
            used,
            sample: Sample {
                covariance: z.transpose() * &z / free,
                t,
                dof,
            },
            runs,
            tails: 1.0 + 0.5 * excess.max(0.0),
            is_unloaded: false,
        })
    }

    /// `None` where the residuals do not contradict the stated noise, or where intervals change little by it.
    fn noise(&self, s: &Sensitivity, errors: ErrorModel) -> Option<ShownNoise> {
        let sample = &self.sample;
        let (m, n) = sample.t.shape();
        let few = 1.0 - (2.0 * m as f64 + 5.0) / (6.0 * sample.dof);
        let fits = Fits {
            largest: sample.largest_log_likelihood()?,
            factor: 2.0 * few / self.tails,
            m,
        };
        let fit = |by_gauge: bool, correlated: bool| {
            let form = Form {
                by_gauge,
                correlated,
            };
            form.fit(sample, RULES.ln_sd_between)
        };
        let white = fit(false, false)?;
        let all = Form {
            by_gauge: true,
            correlated: true,
        };
        if fits.explains(&white)
            && n <= RULES.most_gauges
            && let Some(gain) = all.score_statistic(sample)
            && chi_square_tail(0.5 * fits.factor * gain, n as f64) > RULES.worth_fitting
        {
            return None;
        }
        let common = fit(false, true);
        let is_enough = |other: &Option<Fit>| match other {
            Some(other) => fits.is_enough(&white, other),
            None => true,
        };
        let [own, both] = match n <= RULES.most_gauges {
            true => [fit(true, false), fit(true, true)],
            false => [None, None],
        };
        let can_by_gauge = sample.dof >= RULES.runs_per_gauge * n as f64;
        if fits.explains(&white) && is_enough(&common) && is_enough(&own) {
            return None;
        }
        let itself = (self.is_unloaded && can_by_gauge).then(|| Fit {
            covariance: sample.covariance.clone(),
            parameters: m * (m + 1) / 2,
            log_likelihood: fits.largest,
        });
        let simple = [common.as_ref(), own.as_ref().filter(|_| can_by_gauge)];
        let is_simple = |f: &&Fit| both.as_ref().is_none_or(|b| fits.is_enough(f, b));
        let simple = simple.into_iter().flatten().filter(is_simple);
        let simple = simple.filter(|f| fits.explains(f));
        let full = both.as_ref().filter(|f| can_by_gauge && fits.explains(f));
        let Some(found) = simple.chain(full).chain(&itself).next() else {
            let others = [&common, &own].into_iter().flatten();
            let gains = others.map(|o| fits.chance_of_gain(&white, o));
            let chance = gains.fold(fits.chance(&white), f64::min);
            // If no form fits, samples without load give no finding, because the readings under load are tested as well.
            let is_wrong = !self.is_unloaded && chance < CERTAIN_CHANCE && self.can_be_too_narrow();
            return is_wrong.then(|| ShownNoise {
                noise: None,
                finding: Some(self.report_undetermined_noise(errors)),
            });
        };
        let variances = found.covariance.diagonal();
        let mean = variances.sum() / n as f64;
        let covariance = &found.covariance * (1.0 / mean).max(1.0);
        let is_noise = variances.iter().all(|v| v.sqrt() < RULES.most_noise);
        let noise = GaugeNoise::of_covariance(covariance);
        if !is_noise || !self.matters(s, &noise, errors)? {
            return None;
        }
        Some(ShownNoise {
            finding: Some(self.report_estimated_noise(&noise, errors)),
            noise: Some(self.of_all(s.gauges.len(), &noise)),
        })
    }

    /// Returns whether intervals of a wanted load by the stated noise are too narrow or too wide for noise of this covariance.
    fn matters(&self, s: &Sensitivity, noise: &GaugeNoise, errors: ErrorModel) -> Option<bool> {
        let own = s.of_gauges(&self.used);
        let with_noise = Sensitivity {
            noise: Some(noise.clone()),
            ..own.clone()
        };
        let errors = ErrorModel {
            model_rel: 0.0,
            ..errors
        };
        let all: Vec<usize> = (0..self.used.len()).collect();
        let none = vec![0.0; own.loads.len()];
        let stated = Gain::new(&own, &all, errors, 1.0, &none)?;
        let best = Gain::new(&with_noise, &all, errors, 1.0, &none)?;
        let wanted = (0..own.loads.len()).filter(|l| own.loads[*l].wanted && stated.is_seen(*l));
        let (by_stated, by_best) = (stated.own_sigma(), best.own_sigma());
        let mut off = wanted.map(|l| {
            let weights = stated.weights(l);
            let mut through = vec![0.0; weights.len()];
            spd::times(noise.covariance().as_slice(), &weights, &mut through);
            let actual = errors.noise * spd::dot(&weights, &through).sqrt();
            actual > RULES.too_narrow * by_stated[l] || by_stated[l] > RULES.too_wide * by_best[l]
        });
        Some(off.any(|is_off| is_off))
    }

    /// Returns whether the residuals in some direction exceed the stated noise by so much that intervals can be too narrow.
    fn can_be_too_narrow(&self) -> bool {
        let m = self.sample.t.nrows();
        let values = spd::eigenvalues(self.sample.covariance.as_slice(), m);
        // Largest eigenvalue of a sample covariance of independent noise (Marchenko and Pastur).
        let by_chance = (1.0 + (m as f64 / self.sample.dof).sqrt()).powi(2);
        let largest = values.last().copied().unwrap_or(0.0);
        largest > RULES.too_narrow.powi(2) * by_chance
    }

    /// Returns the noise of `n` gauges. Gauges without readings in most runs have the mean variance, independent of the other gauges.
    fn of_all(&self, n: usize, noise: &GaugeNoise) -> GaugeNoise {
        let covariance = noise.covariance();
        let mean = covariance.diagonal().sum() / self.used.len().max(1) as f64;
        let mut all = Matrix::from_diagonal_element(n, n, mean);
        for (i, g) in self.used.iter().enumerate() {
            for (j, h) in self.used.iter().enumerate() {
                all[(*g, *h)] = covariance[(i, j)];
            }
        }
        GaugeNoise::of_covariance(all)
    }

    fn report_estimated_noise(&self, noise: &GaugeNoise, errors: ErrorModel) -> Finding {
        let unit = errors.noise / MICROSTRAIN;
        let sd = noise.sd();
        let least = sd.iter().copied().fold(f64::INFINITY, f64::min);
        let most = sd.iter().copied().fold(0.0, f64::max);
        Finding::new(
            Severity::Info,
            NOISE_ASSUMED,
            "measured.noise_microstrain",
            format!(
                "the residuals of {} runs or samples contradict independent noise of {} microstrain at every gauge. Loads are weighted by \
                 the noise of the residuals: {} to {} microstrain by gauge, mean correlation {:.2}",
                self.runs,
                number(unit),
                number(least * unit),
                number(most * unit),
                noise.mean_correlation()
            ),
            "state this noise: noise_microstrain by gauge and noise_correlation",
        )
        .with_numbers(most, 1.0)
    }

    fn report_undetermined_noise(&self, errors: ErrorModel) -> Finding {
        Finding::new(
            Severity::Error,
            NOISE_ASSUMED,
            "measured.noise_microstrain",
            format!(
                "the residuals of {} runs or samples contradict independent noise of {} microstrain at every gauge. They do not determine \
                 the actual noise of the gauges, and intervals of some loads can be too narrow",
                self.runs,
                number(errors.noise / MICROSTRAIN)
            ),
            "name a record without load as `zero`, from which the noise is estimated; or state noise_microstrain by gauge and noise_correlation",
        )
        .with_numbers(self.sample.dof, RULES.runs_per_gauge * self.used.len() as f64)
    }
}

#[cfg(test)]
mod tests;
