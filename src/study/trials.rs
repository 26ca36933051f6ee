//! Recovery repeated.

use super::error::{ErrorKind, StudyError};
use crate::estimate::{LinearEstimate, LinearGaussian, ReadingErrors, student_95};
use crate::linalg::spd::dot;
use crate::linalg::{Matrix, dense};
use crate::units::MICROSTRAIN;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A gauge of the pool: its row of S, and the changes of this row with angle and place.
#[derive(Clone, Debug, PartialEq)]
pub struct PoolGauge {
    /// Row of S: strain per job unit of each load.
    pub row: Vec<f64>,
    /// Row of the gauge if it is turned by 45 and by 90 degrees; `None` if it cannot be turned (on a bar).
    pub turned: Option<[Vec<f64>; 2]>,
    /// Change of the row per length along two directions of the surface; `None` if unknown.
    pub slope: Option<[Vec<f64>; 2]>,
}

/// True size of a load in the trials, job units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrueLoad {
    /// One size in all trials.
    Known(f64),
    /// Random in every trial: normal, mean 0, this standard deviation.
    Drawn(f64),
}

impl TrueLoad {
    /// Returns the size to which errors are compared: the absolute value, or the standard deviation.
    pub fn size(self) -> f64 {
        match self {
            Self::Known(f) => f.abs(),
            Self::Drawn(sd) => sd,
        }
    }
}

/// Settings that apply to all layouts.
#[derive(Clone, Debug, PartialEq)]
pub struct StudySpec {
    /// True loads.
    pub truth: Vec<TrueLoad>,
    /// Prior standard deviation of nuisance loads, `None` for wanted ones.
    pub prior: Vec<Option<f64>>,
    /// Sizes that scale the columns of S for its condition number; `None` scales them to unit norm.
    pub sizes: Option<Vec<f64>>,
    /// Noise that the recovery assumes, strain. It weights readings relative to priors.
    pub noise: f64,
    /// Number of trials for each layout and error.
    pub trials: usize,
    /// Seed, equal for all layouts, so that all layouts have the same random errors.
    pub seed: u64,
}

/// Errors of the recovered loads.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyRow {
    /// Condition number of S with scaled columns; the median over the layouts.
    pub condition_number: f64,
    /// Mean error by load.
    pub bias: Vec<f64>,
    /// Standard deviation of the error by load.
    pub sigma: Vec<f64>,
    /// Share of 95 % intervals (noise from the residual, Student) that contain the load; NaN without spare gauges.
    pub coverage: Vec<f64>,
    /// Number of layouts that do not separate the loads.
    pub singular: usize,
}

/// Returns S with its columns times `sizes`; without sizes, with columns of unit norm.
fn scale_columns(mut s: Matrix, sizes: Option<&[f64]>) -> Matrix {
    for (c, mut column) in s.column_iter_mut().enumerate() {
        let norm = column.norm();
        let unit = if norm > 0.0 { 1.0 / norm } else { 1.0 };
        column *= sizes.and_then(|z| z.get(c).copied()).unwrap_or(unit);
    }
    s
}

/// Recovers the loads in `spec.trials` trials, which are distributed over `layouts` (lists of pool gauges) in turn. Trials run in parallel. Every
/// trial has its own stream of random numbers, so the result does not depend on the number of threads.
pub fn study_layout(
    pool: &[PoolGauge],
    layouts: &[Vec<usize>],
    error: StudyError,
    spec: &StudySpec,
) -> StudyRow {
    let k = spec.truth.len();
    let solved: Vec<Option<(Matrix, LinearEstimate)>> =
        layouts.par_iter().map(|l| solver(pool, l, spec)).collect();
    let mut conditions: Vec<f64> = layouts
        .iter()
        .map(|l| {
            let s = Matrix::from_fn(l.len(), k, |g, c| pool[l[g]].row[c]);
            dense::condition(&scale_columns(s, spec.sizes.as_deref()))
        })
        .collect();
    conditions.sort_by(f64::total_cmp);
    let usable: Vec<usize> = (0..layouts.len())
        .filter(|i| solved[*i].is_some())
        .collect();
    let mut row = StudyRow {
        condition_number: conditions
            .get(conditions.len() / 2)
            .copied()
            .unwrap_or(f64::INFINITY),
        bias: vec![f64::NAN; k],
        sigma: vec![f64::NAN; k],
        coverage: vec![f64::NAN; k],
        singular: layouts.len() - usable.len(),
    };
    if usable.is_empty() || spec.trials == 0 {
        return row;
    }
    let trials: Vec<(Vec<f64>, Vec<bool>)> = (0..spec.trials)
        .into_par_iter()
        .filter_map(|t| {
            let i = usable[t % usable.len()];
            let (s, fit) = solved[i].as_ref()?;
            Some(trial(pool, &layouts[i], s, fit, error, spec, t as u64))
        })
        .collect();
    let n = trials.len() as f64;
    for l in 0..k {
        let mean = trials.iter().map(|t| t.0[l]).sum::<f64>() / n;
        row.bias[l] = mean;
        let square = trials.iter().map(|t| (t.0[l] - mean).powi(2)).sum::<f64>();
        row.sigma[l] = (square / (n - 1.0).max(1.0)).sqrt();
        if trials.iter().all(|t| t.1.len() == k) {
            row.coverage[l] = trials.iter().filter(|t| t.1[l]).count() as f64 / n;
        }
    }
    row
}

/// Entries of a column of S up to this share apart count as equally large.
const EQUALLY_LARGE: f64 = 1e-6;

/// Returns the sign of the largest entry in column `l` of S, the first of equally large ones. A load with the opposite positive direction has the
/// opposite sign. Multiplied by this sign, the same draw is therefore the same state of the structure.
fn sense(pool: &[PoolGauge], l: usize) -> f64 {
    let column = || pool.iter().map(|g| g.row[l]);
    let largest = column().map(f64::abs).fold(0.0, f64::max);
    let first = column().find(|v| v.abs() >= (1.0 - EQUALLY_LARGE) * largest);
    first.unwrap_or(1.0).signum()
}

/// Returns S of a layout and its least-squares solution for readings of equal noise.
fn solver(
    pool: &[PoolGauge],
    layout: &[usize],
    spec: &StudySpec,
) -> Option<(Matrix, LinearEstimate)> {
    let k = spec.truth.len();
    let s = Matrix::from_fn(layout.len(), k, |g, c| pool[layout[g]].row[c]);
    let scales: Vec<f64> = s
        .column_iter()
        .map(|c| if c.norm() > 0.0 { 1.0 / c.norm() } else { 1.0 })
        .collect();
    let zeros = vec![0.0; layout.len()];
    let variances = vec![spec.noise * spec.noise; layout.len()];
    let model = LinearGaussian {
        rows: &s,
        errors: ReadingErrors::Variances(&variances),
        prior_sd: &spec.prior,
        scales: &scales,
    };
    let fit = model.estimate(&zeros)?;
    (fit.rank == k).then_some((s, fit))
}

/// Errors of the loads in one trial, and whether each interval holds its load.
fn trial(
    pool: &[PoolGauge],
    layout: &[usize],
    s: &Matrix,
    fit: &LinearEstimate,
    error: StudyError,
    spec: &StudySpec,
    number: u64,
) -> (Vec<f64>, Vec<bool>) {
    let mut random = ChaCha8Rng::seed_from_u64(spec.seed);
    random.set_stream(number);
    let normal = |random: &mut ChaCha8Rng| {
        let (u, v): (f64, f64) = (
            random.random_range(1e-300..1.0),
            random.random_range(0.0..1.0),
        );
        (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
    };
    let truth: Vec<f64> = spec
        .truth
        .iter()
        .enumerate()
        .map(|(l, load)| match *load {
            TrueLoad::Known(f) => f,
            TrueLoad::Drawn(sd) => sense(pool, l) * sd * normal(&mut random),
        })
        .collect();
    let read = |row: &[f64]| dot(row, &truth);
    let y: Vec<f64> = layout
        .iter()
        .map(|g| {
            let gauge = &pool[*g];
            let own = read(&gauge.row);
            match error.kind {
                ErrorKind::RelativeUniform => {
                    own * (1.0 + error.size * random.random_range(-1.0..=1.0))
                }
                ErrorKind::RelativeNormal | ErrorKind::Factor => {
                    own * (1.0 + error.size * normal(&mut random))
                }
                ErrorKind::AbsoluteUniform => {
                    own + MICROSTRAIN * error.size * random.random_range(-1.0..=1.0)
                }
                ErrorKind::AbsoluteNormal => own + MICROSTRAIN * error.size * normal(&mut random),
                ErrorKind::Angle => {
                    let turn = (error.size * normal(&mut random)).to_radians();
                    match &gauge.turned {
                        None => own,
                        Some([half, full]) => rotate_reading(own, read(half), read(full), turn),
                    }
                }
                ErrorKind::Position => {
                    let shift = [normal(&mut random), normal(&mut random)];
                    let slope = |d: usize| gauge.slope.as_ref().map_or(0.0, |s| read(&s[d]));
                    own + error.size * (shift[0] * slope(0) + shift[1] * slope(1))
                }
            }
        })
        .collect();
    let k = truth.len();
    let found: Vec<f64> = (0..k)
        .map(|l| {
            y.iter()
                .enumerate()
                .map(|(g, y)| fit.gain[(l, g)] * y)
                .sum()
        })
        .collect();
    let wanted = spec.prior.iter().filter(|p| p.is_none()).count();
    let spare = layout.len().saturating_sub(wanted);
    let held = if spare == 0 {
        Vec::new()
    } else {
        let mut chi2: f64 = (0..layout.len())
            .map(|g| {
                let p: f64 = (0..k).map(|l| s[(g, l)] * found[l]).sum();
                ((y[g] - p) / spec.noise).powi(2)
            })
            .sum();
        for (f, p) in found.iter().zip(&spec.prior) {
            if let Some(sd) = p {
                chi2 += (f / sd).powi(2);
            }
        }
        let factor = student_95(spare as f64) * (chi2 / spare as f64).sqrt();
        (0..k)
            .map(|l| (found[l] - truth[l]).abs() <= factor * fit.covariance[(l, l)].sqrt())
            .collect()
    };
    let errors = found.iter().zip(&truth).map(|(f, t)| f - t).collect();
    (errors, held)
}

/// Returns the reading of a gauge turned by `angle`, from its readings at 0, 45 and 90 degrees. The strain at an angle a is
/// `(e0 + e90)/2 + (e0 - e90)/2 cos 2a + (e45 - (e0 + e90)/2) sin 2a`.
fn rotate_reading(e0: f64, e45: f64, e90: f64, angle: f64) -> f64 {
    let (mean, half) = ((e0 + e90) / 2.0, (e0 - e90) / 2.0);
    mean + half * (2.0 * angle).cos() + (e45 - mean) * (2.0 * angle).sin()
}
