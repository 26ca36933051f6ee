//! Expected residual of a complete model from sensor noise and declared tolerances, and its limit in 99 jobs of 100.

use super::columns::{nuisance, parameter_column, slices};
use super::design::{Bins, Design, reference, size};
use super::frame::MotionFrame;
use super::noise::{Background, Whitener, covariance};
use super::part::Part;
use super::response::responses;
use crate::estimate::columns::{PriorColumn, solve_with_priors};
use crate::reconcile::rules::MotionRules;
use rustfft::num_complex::Complex64;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Squared expected residuals of one equation, over the squared size of the measured quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Floor {
    /// Contribution of sensor noise.
    pub noise: f64,
    /// Expected contribution of declared tolerances.
    pub tolerance: f64,
    /// Contribution of declared tolerances that one complete model in a hundred exceeds.
    pub tolerance_limit: f64,
}

impl Floor {
    /// Returns the expected residual, as a share of the measured quantity.
    pub fn expected_residual(&self) -> f64 {
        (self.noise + self.tolerance).sqrt()
    }

    /// Returns the largest residual of a complete model. It assumes noise wrong by the noise factor, tolerances as large as in one job of a hundred,
    /// and undeclared tolerances of the same size.
    pub fn limit(&self, rules: &MotionRules) -> f64 {
        let noise = self.noise * rules.noise_factor * rules.noise_factor;
        (noise + rules.undeclared * self.tolerance_limit).sqrt()
    }

    /// Returns the mean of squares.
    pub fn mean(list: &[Self]) -> Self {
        let n = list.len().max(1) as f64;
        let of = |f: &dyn Fn(&Self) -> f64| list.iter().map(f).sum::<f64>() / n;
        Self {
            noise: of(&|f| f.noise),
            tolerance: of(&|f| f.tolerance),
            tolerance_limit: of(&|f| f.tolerance_limit),
        }
    }
}

/// Fits the parameters by least squares without nuisance columns, with equal weights of all equations, over one or more designs of a vehicle.
pub fn fit_without_nuisance(designs: &[&Design], free: &[usize], target: &[Vec<Bins>]) -> Vec<f64> {
    let stacked = |of: &dyn Fn(&Design, usize) -> Vec<f64>| -> Vec<f64> {
        designs
            .iter()
            .enumerate()
            .flat_map(|(k, d)| of(d, k))
            .collect()
    };
    let columns: Vec<PriorColumn> = free
        .iter()
        .map(|&i| PriorColumn {
            rows: stacked(&|d, _| even(d).rows(&parameter_column(d, i))),
            prior: None,
        })
        .collect();
    let rows = stacked(&|d, k| even(d).rows(&slices(&target[k])));
    solve_with_priors(&columns, &rows).x
}

/// Returns equal weights of all equations and bins.
fn even(d: &Design) -> Whitener {
    let n = d.equations.len();
    let mut s = vec![Complex64::default(); n * n];
    for i in 0..n {
        s[i * n + i] = Complex64::new(1.0, 0.0);
    }
    Whitener::from_covariance(&vec![s; d.f_hz.len()], n)
}

/// Returns the expected residuals by equation of the design `tested`, for a model with the effects `parts`. Its parameters `values` are from
/// [`fit_without_nuisance`] on the designs `fitted`, with the parameters `free`.
///
/// A tolerance of one standard deviation leaves the residual column - A beta. beta are the parameters that fit the column of the tolerance on the
/// designs `fitted`. The part that the parameters explain is not a gap. The squared residual of several tolerances is a quadratic form of normal
/// deviates. Its quantile is taken from the chi-square distribution of equal mean and variance (Satterthwaite).
///
/// # Reference
/// F. E. Satterthwaite, An approximate distribution of estimates of variance components, Biometrics Bull. 2 (1946) 110.
pub fn floors(
    frame: &MotionFrame,
    parts: &[Part],
    fitted: &[&Design],
    tested: &Design,
    values: &[f64],
    free: &[usize],
) -> Vec<Floor> {
    let h = responses(tested, values);
    let s = covariance(frame, tested, &h, &Background::default());
    let n = tested.equations.len();
    let sizes: Vec<f64> = (0..n)
        .map(|i| reference(tested, i, values).max(f64::MIN_POSITIVE))
        .collect();
    let left = left_by_tolerances(frame, parts, fitted, tested, values, free, &h);
    (0..n)
        .map(|i| {
            let noise: f64 = s.iter().map(|s| s[i * n + i].re).sum();
            let whole = sizes[i] * sizes[i];
            let form = |a: &[Bins], b: &[Bins]| -> f64 {
                let dot: f64 = a[i].iter().zip(&b[i]).map(|(x, y)| (x * y.conj()).re).sum();
                dot / whole
            };
            let (mut mean, mut square) = (0.0, 0.0);
            for a in &left {
                mean += form(a, a);
                square += left.iter().map(|b| form(a, b).powi(2)).sum::<f64>();
            }
            Floor {
                noise: noise / whole,
                tolerance: mean,
                tolerance_limit: quantile(mean, square, 1.0 - frame.rules.false_rate),
            }
        })
        .collect()
}

/// Returns the quantile of a quadratic form of normal deviates, whose eigenvalues have this sum and sum of squares.
fn quantile(sum: f64, squares: f64, share: f64) -> f64 {
    if !(sum > 0.0 && squares > 0.0) {
        return 0.0;
    }
    let freedom = sum * sum / squares;
    ChiSquared::new(freedom).map_or(sum, |c| sum / freedom * c.inverse_cdf(share))
}

/// Returns the residual from one sd of each tolerance in every equation of `tested`, after a fit of the free parameters to `fitted`.
fn left_by_tolerances(
    frame: &MotionFrame,
    parts: &[Part],
    fitted: &[&Design],
    tested: &Design,
    values: &[f64],
    free: &[usize],
    h: &[Vec<Vec<Complex64>>],
) -> Vec<Vec<Bins>> {
    let here = nuisance(frame, tested, h, parts);
    if here.is_empty() {
        return vec![];
    }
    let there: Vec<Vec<Vec<Bins>>> = fitted
        .iter()
        .map(|d| {
            let own = nuisance(frame, d, &responses(d, values), parts);
            own.into_iter().map(|c| c.1).collect()
        })
        .collect();
    here.into_iter()
        .enumerate()
        .map(|(k, (_, mut column, sd))| {
            let target: Vec<Vec<Bins>> = there
                .iter()
                .map(|d| d.get(k).cloned().unwrap_or_default())
                .collect();
            let beta = fit_without_nuisance(fitted, free, &target);
            for (e, column) in tested.equations.iter().zip(&mut column) {
                for (i, own) in &e.columns {
                    let Some(b) = free.iter().position(|f| f == i).map(|at| beta[at]) else {
                        continue;
                    };
                    column.iter_mut().zip(own).for_each(|(l, c)| *l -= c * b);
                }
                column.iter_mut().for_each(|l| *l *= sd);
            }
            column
        })
        .collect()
}

/// Returns the root of the mean over equations of squared residual over squared measured quantity.
pub fn share(d: &Design, left: &[Bins], values: &[f64]) -> f64 {
    let sum: f64 = left
        .iter()
        .enumerate()
        .map(|(i, l)| (size(l) / reference(d, i, values).max(f64::MIN_POSITIVE)).powi(2))
        .sum();
    (sum / left.len().max(1) as f64).sqrt()
}
