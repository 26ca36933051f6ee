//! How many gauges: what each number of them gives, and what the next one buys.

use super::answer::finite;
use super::choose::{Refused, choose_once};
use super::pool::Kind;
use super::task::Task;
use crate::app::strain::LoadUnits;
use crate::linalg::{Matrix, dense};
use crate::placement::quality::judge_rows;
use crate::placement::{PlaceError, Spec};
use crate::report::figure::CountPoint;
use crate::report::strain::HowMany;
use serde_json::{Value, json};

/// A number of gauges.
pub(super) struct Point {
    pub gauges: usize,
    pub efficiency_bound: f64,
    pub condition_number_scaled: f64,
    /// Efficiency left after the worst loss.
    pub worst_loss: f64,
    /// By load, report units, job order.
    pub sigma: Vec<f64>,
    /// By load, report units: how much less than with the number before, a gauge.
    pub bought: Vec<Option<f64>>,
}

/// The curve over the job's numbers; numbers that can't separate the loads are left out.
pub(super) fn curve(
    task: &Task,
    kinds: &[Kind],
    spec: &Spec,
    units: &[LoadUnits],
) -> (Vec<Point>, Vec<usize>) {
    let mut counts = task.job.placement.curve.clone();
    counts.sort_unstable();
    counts.dedup();
    let k = task.cases.len();
    let (mut points, mut left_out): (Vec<Point>, Vec<usize>) = (Vec::new(), Vec::new());
    for gauges in counts {
        let mut spec = Spec {
            gauges,
            ..spec.clone()
        };
        spec.effort.kicks = spec.effort.kicks.min(4);
        spec.effort.starts = spec.effort.starts.min(4);
        spec.proof *= 0.05;
        let chosen = match choose_once(task, kinds, &spec) {
            Ok(c) => c,
            Err(Refused::By(PlaceError::Singular { .. } | PlaceError::TooTight { .. }))
            | Err(_) => {
                left_out.push(gauges);
                continue;
            }
        };
        let rows: Vec<Vec<f64>> = chosen.channels.iter().map(|c| c.row.clone()).collect();
        let Some(q) = judge_rows(&rows, &spec.prior, k) else {
            left_out.push(gauges);
            continue;
        };
        let mut sigma = vec![0.0; k];
        for (c, &l) in task.order.iter().enumerate() {
            sigma[l] = q.sigma[c] * task.scales[l] * units[l].factor;
        }
        let all: Vec<&Vec<f64>> = rows.iter().chain(&task.kept_rows).collect();
        let sds = chosen.channels.iter().map(|c| c.sd);
        let sds: Vec<f64> = sds.chain(vec![1.0; task.kept_rows.len()]).collect();
        let s = Matrix::from_fn(all.len(), k, |r, c| all[r][c] * sds[r]);
        let bought = (0..k)
            .map(|l| {
                let before = points.last()?;
                Some((before.sigma[l] - sigma[l]) / (gauges - before.gauges) as f64)
            })
            .collect();
        points.push(Point {
            gauges,
            efficiency_bound: chosen.efficiency_bound,
            condition_number_scaled: dense::condition(&s),
            worst_loss: q.worst_loss,
            sigma,
            bought,
        });
    }
    (points, left_out)
}

/// The curve for `result.json`.
pub(super) fn curve_json(points: &[Point], names: &[String], units: &[LoadUnits]) -> Vec<Value> {
    points
        .iter()
        .map(|p| {
            let loads: Vec<Value> = (0..names.len())
                .map(|l| {
                    json!({ "name": names[l], "sigma": p.sigma[l], "unit": units[l].name, "less_by_a_gauge": p.bought[l] })
                })
                .collect();
            json!({
                "gauges": p.gauges,
                "efficiency_bound": p.efficiency_bound,
                "condition_number_scaled": finite(p.condition_number_scaled),
                "worst_loss": p.worst_loss,
                "load_sigma": loads,
            })
        })
        .collect()
}

/// The curve for the page.
pub(super) fn drawn(points: &[Point], names: &[String], units: &[LoadUnits]) -> HowMany {
    let point = |p: &Point| CountPoint {
        gauges: p.gauges,
        efficiency: p.efficiency_bound,
        after_loss: p.worst_loss,
        sigma: p.sigma.clone(),
    };
    let loads = names.iter().zip(units);
    HowMany {
        points: points.iter().map(point).collect(),
        loads: loads.map(|(n, u)| (n.clone(), u.name.clone())).collect(),
    }
}
