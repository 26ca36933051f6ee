//! Nonlinear least squares by Levenberg-Marquardt (crate `levenberg-marquardt`, after MINPACK).

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::{DMatrix, DVector, Dyn, Owned};
use rayon::prelude::*;

/// Reason why an iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// Steps or gains fell below the tolerance.
    Converged,
    /// The number of evaluations ran out.
    Patience,
    /// The residuals could not be evaluated (not finite) or the problem is malformed.
    Failed,
}

/// A minimum, with the reason why the search ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    /// Parameters.
    pub x: Vec<f64>,
    /// Half the sum of squared residuals.
    pub objective: f64,
    /// Number of residual evaluations, without the evaluations for derivatives.
    pub evaluations: usize,
    /// Reason why the search ended.
    pub stop: Stop,
    /// `(J'J)^-1` at the end, by rows. Empty if `J'J` is singular.
    pub inverse: Vec<Vec<f64>>,
}

struct Problem<'a, F> {
    residuals: &'a F,
    scale: &'a [f64],
    u: DVector<f64>,
}

impl<F: Fn(&[f64]) -> Option<Vec<f64>> + Sync> Problem<'_, F> {
    fn residuals_at(&self, u: &DVector<f64>) -> Option<DVector<f64>> {
        let x: Vec<f64> = u.iter().zip(self.scale).map(|(u, s)| u * s).collect();
        let r = (self.residuals)(&x)?;
        r.iter()
            .all(|v| v.is_finite())
            .then(|| DVector::from_vec(r))
    }
}

impl<F: Fn(&[f64]) -> Option<Vec<f64>> + Sync> LeastSquaresProblem<f64, Dyn, Dyn>
    for Problem<'_, F>
{
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, x: &DVector<f64>) {
        self.u.copy_from(x);
    }

    fn params(&self) -> DVector<f64> {
        self.u.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.residuals_at(&self.u)
    }

    /// Central differences of 1e-5 of the scale: truncation and rounding both near 1e-10.
    fn jacobian(&self) -> Option<DMatrix<f64>> {
        const STEP: f64 = 1e-5;
        let columns: Option<Vec<DVector<f64>>> = (0..self.u.len())
            .into_par_iter()
            .map(|j| {
                let shifted = |h: f64| {
                    let mut u = self.u.clone();
                    u[j] += h;
                    self.residuals_at(&u)
                };
                Some((shifted(STEP)? - shifted(-STEP)?) / (2.0 * STEP))
            })
            .collect();
        Some(DMatrix::from_columns(&columns?))
    }
}

/// Returns parameters near `start` that minimise the sum of squared residuals. `None` of `residuals` ends the search.
///
/// `scale` is the size of each parameter. Steps and tolerances are relative to it, also if the start is zero.
///
/// # Example
/// Rosenbrock's valley has its minimum at (1, 1):
/// ```
/// use strainbridge::linalg::levenberg::{Stop, levenberg_marquardt};
///
/// let residuals = |x: &[f64]| Some(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
/// let found = levenberg_marquardt(residuals, &[-1.2, 1.0], &[1.0, 1.0]);
/// assert_eq!(found.stop, Stop::Converged);
/// assert!((found.x[0] - 1.0).abs() < 1e-6 && (found.x[1] - 1.0).abs() < 1e-6);
/// ```
pub fn levenberg_marquardt<F>(residuals: F, start: &[f64], scale: &[f64]) -> Minimum
where
    F: Fn(&[f64]) -> Option<Vec<f64>> + Sync,
{
    let scale: Vec<f64> = scale
        .iter()
        .map(|s| if *s == 0.0 { 1.0 } else { s.abs() })
        .collect();
    let u = DVector::from_iterator(start.len(), start.iter().zip(&scale).map(|(x, s)| x / s));
    let problem = Problem {
        residuals: &residuals,
        scale: &scale,
        u,
    };
    let (end, report) = LevenbergMarquardt::new()
        .with_ftol(1e-10)
        .with_xtol(1e-9)
        .with_gtol(1e-12)
        .with_patience(30)
        .minimize(problem);
    let stop = match report.termination {
        TerminationReason::LostPatience => Stop::Patience,
        t if t.was_successful() => Stop::Converged,
        // At rounding level no further improvement is possible, which counts as converged.
        TerminationReason::NoImprovementPossible(_) => Stop::Converged,
        _ => Stop::Failed,
    };
    let normal = end.jacobian().map(|j| j.transpose() * j);
    let inverse = normal.and_then(|n| n.try_inverse()).map_or(vec![], |m| {
        (0..m.nrows())
            .map(|i| {
                (0..m.ncols())
                    .map(|j| m[(i, j)] * scale[i] * scale[j])
                    .collect()
            })
            .collect()
    });
    Minimum {
        x: end.u.iter().zip(&scale).map(|(u, s)| u * s).collect(),
        objective: report.objective_function,
        evaluations: report.number_of_evaluations,
        stop,
        inverse,
    }
}
