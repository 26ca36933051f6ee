//! Whether loads come out larger with a column of the runs, such as speed.

use super::types::{LeftOut, Task};
use crate::linalg::tail::student_tail;

/// Change of the scale with a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dependence {
    /// Relative change of the loads' sum per unit of the column.
    pub slope_rel: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// Chance of such a slope where there is none.
    pub chance: f64,
}

/// Straight line through recovered over known sum of the left-out runs against the column (a value a run of the task; NaN: blank).
/// `None` with fewer than three of them, or where the column does not change.
pub fn depends_on(task: &Task, left_out: &[LeftOut], column: &[f64]) -> Option<Dependence> {
    let point = |l: &LeftOut| -> Option<(f64, f64)> {
        let x = column.get(l.number).copied().filter(|x| x.is_finite())?;
        let wanted = |f: &[f64]| {
            f.iter()
                .zip(&task.loads)
                .filter(|(_, l)| l.wanted)
                .map(|(f, _)| f)
                .sum::<f64>()
        };
        let known = wanted(&l.known);
        (known != 0.0).then(|| (x, wanted(&l.estimate.values) / known))
    };
    let points: Vec<(f64, f64)> = left_out.iter().filter_map(point).collect();
    let n = points.len() as f64;
    if points.len() < 3 {
        return None;
    }
    let (mx, my) = (
        points.iter().map(|p| p.0).sum::<f64>() / n,
        points.iter().map(|p| p.1).sum::<f64>() / n,
    );
    let sxx: f64 = points.iter().map(|p| (p.0 - mx).powi(2)).sum();
    if !(sxx > 0.0) {
        return None;
    }
    let slope_rel = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>() / sxx;
    let left: f64 = points
        .iter()
        .map(|p| (p.1 - my - slope_rel * (p.0 - mx)).powi(2))
        .sum();
    let sigma = (left / (n - 2.0) / sxx).sqrt();
    let chance = (2.0 * student_tail((slope_rel / sigma).abs(), n - 2.0)).min(1.0);
    Some(Dependence {
        slope_rel,
        sigma,
        chance,
    })
}
