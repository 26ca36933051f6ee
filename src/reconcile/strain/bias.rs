//! Does the gap follow the loads at every gauge? Then it is the model that is off, not the readings.

use super::frame::StrainFrame;
use super::prediction::predict;
use crate::linalg::{Matrix, dense};

/// Share of the squared gap that loads must explain.
const SHARE: f64 = 0.95;
/// Smallest number of gauges over which the gap must be spread (participation number). With fewer gauges, the cause is faults of these gauges.
const GAUGES: f64 = 3.0;
/// Runs beyond the number of loads.
const SPARE_RUNS: usize = 3;

/// Returns a message on a gap of the analyst's own model that is linear in the loads at several gauges, run by run.
///
/// The residuals `R` (`runs x gauges`) are regressed on the loads `F` (`runs x loads`). The share of the gap that the loads explain is
/// `1 - (|R - F B|^2 / (n - k)) / (|R|^2 / n)`. The participation number is `(sum e_g)^2 / sum e_g^2`, with `e_g` the squared gap of gauge g.
pub fn model_bias(frame: &StrainFrame) -> Option<String> {
    let (n_r, n_g, n_l) = (frame.n_runs(), frame.n_gauges(), frame.n_loads());
    let carried = frame.payload.iter().any(|p| p[0] != 0.0);
    let k = n_l + usize::from(carried);
    if n_r < k + SPARE_RUNS {
        return None;
    }
    let predicted = predict(frame, &[]);
    let loads = Matrix::from_fn(n_r, k, |r, l| {
        if l < n_l {
            frame.loads[r * n_l + l]
        } else {
            frame.payload[r][0]
        }
    });
    let loads = dense::unit_columns(&loads);
    let basis = dense::svd(&loads)?;
    let kept: Vec<usize> = (0..basis.s.len())
        .filter(|i| basis.s[*i] > 1e-9 * basis.s[0])
        .collect();
    let (mut left, mut whole, mut squares) = (0.0, 0.0, 0.0);
    for g in 0..n_g {
        let r: Vec<f64> = (0..n_r)
            .map(|run| frame.observations.value(run, g) - predicted[run * n_g + g])
            .collect();
        if !r.iter().all(|v| v.is_finite()) {
            continue;
        }
        let size: f64 = r.iter().map(|v| v * v).sum();
        let along: f64 = kept
            .iter()
            .map(|&i| (0..n_r).map(|run| basis.u[(run, i)] * r[run]).sum::<f64>())
            .map(|a| a * a)
            .sum();
        left += size - along;
        whole += size;
        squares += size * size;
    }
    let spare = (n_r - kept.len()) as f64;
    let share = 1.0 - (left / spare) / (whole / n_r as f64);
    let spread = whole * whole / squares;
    (share > SHARE && spread > GAUGES).then(|| {
        format!(
            "the gap follows the loads at many gauges ({:.0} % of the squared gap, spread over {spread:.0} gauges): this is a model error \
             (stiffness, joints, mesh, sections), not noise",
            100.0 * share
        )
    })
}
