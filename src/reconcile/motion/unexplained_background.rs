//! Residual that a joint fit of many effects does not explain. It is the background for every comparison.

use super::frame::MotionFrame;
use super::motion_fit::MotionFit;
use super::noise::{Background, background, covariance};
use super::response::responses;
use super::scorer::MotionScorer;
use crate::estimate::columns::{Basis, PriorColumn, solve_with_priors};
use rustfft::num_complex::Complex64;

/// Largest number of forms in a generous model, added one after the other.
const MOST: usize = 8;
/// Fall of the squared residual that a form must bring: a share of the present residual, and at least this much.
const LEAST: f64 = 30.0;
/// Least share; `LEAST` states the reason.
const SHARE: f64 = 0.01;

/// Returns the power of the residual after a joint fit of the forms that reduce it most, of any effect.
pub fn unexplained_background(scorer: &mut MotionScorer, null: &MotionFit) -> Background {
    let forms = scorer.form_columns(null);
    let mut columns: Vec<PriorColumn> = null.columns.to_vec();
    let n = null.n_rows;
    // The target of the fit is its residual plus the part that its columns explain. For further columns, the residual alone is sufficient as target.
    let target: Vec<f64> = null.residual[..n].to_vec();
    let mut left = null.residual.to_vec();
    let mut used = vec![false; forms.len()];
    for _ in 0..MOST {
        let basis = Basis::from_columns(&columns);
        let best = forms
            .iter()
            .enumerate()
            .filter(|(i, _)| !used[*i])
            .map(|(i, f)| (i, basis.gain(&left, &f.2).0))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let total: f64 = left.iter().map(|v| v * v).sum();
        let Some((i, _)) = best.filter(|b| b.1 > LEAST.max(SHARE * total)) else {
            break;
        };
        used[i] = true;
        columns.extend(forms[i].2.iter().map(|rows| PriorColumn {
            rows: rows.clone(),
            prior: None,
        }));
        left = solve_with_priors(&columns, &target).residual;
    }
    of_rows(scorer.frame, null, &left)
}

/// Returns the background in the residual of a fit above sensor noise.
pub fn of_fit(frame: &MotionFrame, fit: &MotionFit) -> Background {
    let h = responses(&fit.design, &fit.values);
    let sensor = covariance(frame, &fit.design, &h, &Background::default());
    background(frame, &fit.design, &fit.left, &sensor)
}

/// Returns the background of whitened rows, coloured with the whitening that made them.
fn of_rows(frame: &MotionFrame, null: &MotionFit, rows: &[f64]) -> Background {
    let colour = null.whitener.colour_rows(rows);
    let h = responses(&null.design, &null.values);
    let sensor: Vec<Vec<Complex64>> = covariance(frame, &null.design, &h, &Background::default());
    background(frame, &null.design, &colour, &sensor)
}

/// Returns the total power, to compare backgrounds.
pub fn power(b: &Background) -> f64 {
    b.power.iter().flatten().sum()
}
