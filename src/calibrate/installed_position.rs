//! Position, angle and gain of each gauge, as determined from the runs.
//!
//! With `r` a row of S and `u = (gain, along, across, angle)`, the prior of a row is `r = r0 + D' u + e`. `D` contains the row itself and its change
//! with each move. `e` is the error of the model in each entry, with covariance `E_e`. The posterior of `r` has mean `m` and covariance `V`, and `u`
//! has the prior covariance `C`. The posterior of `u` is `E = K (m - r0)`, `Cov = C - K D' C + K V K'` with `K = C D (D' C D + E_e)^-1`.

use super::state::State;
use super::types::{Glue, InstalledPositionEstimate, ModelError, ModelPrior, Task};
use crate::linalg::Matrix;
use crate::linalg::precision::Precision;
use crate::linalg::spd::dot;

/// Returns the posterior position, angle and gain of each gauge; empty without stated moves. `all`: error of the model from all gauges.
pub(super) fn estimate_installed_positions(
    task: &Task,
    state: &State,
    all: Option<ModelError>,
) -> Vec<InstalledPositionEstimate> {
    let (Some(model), Some(all)) = (&task.model, all) else {
        return Vec::new();
    };
    if model.moves.is_empty() {
        return Vec::new();
    }
    let gauges = state.row_errors.iter().enumerate();
    let glued = gauges.map(|(g, error)| {
        let mut glued = estimate_installed_position(model, state, g, error.common)?;
        // The gauge's own error was estimated from its readings, so that the stated value is the error of all gauges.
        glued.gain.stated = all.common;
        Some(glued)
    });
    glued.collect::<Option<Vec<_>>>().unwrap_or_default()
}

fn estimate_installed_position(
    model: &ModelPrior,
    state: &State,
    g: usize,
    common: f64,
) -> Option<InstalledPositionEstimate> {
    let k = state.scales.len();
    let prior = state.prior.get(g)?;
    let scaled = |m: &Matrix| -> Vec<f64> { (0..k).map(|l| m[(g, l)] * state.scales[l]).collect() };
    let rows: Vec<Vec<f64>> = std::iter::once(&model.values)
        .chain(model.moves.iter().map(|m| &m.change))
        .map(scaled)
        .collect();
    let sd: Vec<f64> = std::iter::once(common)
        .chain(model.moves.iter().map(|m| m.sd))
        .collect();
    let inverse = Precision::from_covariance(&prior.covariance, k)?;
    // Rows of K.
    let gains: Vec<Vec<f64>> = rows
        .iter()
        .zip(&sd)
        .map(|(d, s)| inverse.apply(d).iter().map(|v| s * s * v).collect())
        .collect();
    let order = state.posterior.n * k;
    let mean = state.posterior.mean.get(g * k..(g + 1) * k)?;
    let left: Vec<f64> = mean.iter().zip(&prior.mean).map(|(m, p)| m - p).collect();
    let covariance = |i: usize, j: usize| -> f64 {
        let own = if i == j { sd[i] * sd[i] } else { 0.0 };
        let mut learnt = 0.0;
        for l in 0..k {
            for m in 0..k {
                let v = state.posterior.covariance[(g * k + l) * order + g * k + m];
                learnt += gains[i][l] * v * gains[j][m];
            }
        }
        own - dot(&gains[i], &rows[j]) * sd[j] * sd[j] + learnt
    };
    let estimate = |i: usize, offset: f64| Glue {
        value: offset + dot(&gains[i], &left),
        sigma: covariance(i, i).max(0.0).sqrt(),
        stated: sd[i],
    };
    let moves = model.moves.iter().enumerate();
    Some(InstalledPositionEstimate {
        gain: estimate(0, 1.0),
        moves: moves.map(|(i, m)| (m.kind, estimate(i + 1, 0.0))).collect(),
    })
}
