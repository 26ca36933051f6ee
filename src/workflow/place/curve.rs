//! Number of gauges: the result with each number, and the benefit of the next gauge.

use super::choose::choose_once;
use super::chosen_layout::ChoiceRefusal;
use super::layout_findings::{chosen_as_recovered, in_job_order, sigma_of, terms_listed};
use super::outcome::{BoughtSigma, CurvePoint};
use super::pool::Kind;
use super::task::Task;
use crate::finding::{Finding, Severity};
use crate::host::outcome::finite_or_none;
use crate::linalg::{Matrix, dense};
use crate::placement::quality::evaluate_rows;
use crate::placement::{PlaceError, Spec};
use crate::workflow::recover::ListedLoads;

/// Returns the curve over the gauge counts of the job. Counts that can't separate the loads are left out.
pub(super) fn curve(
    task: &Task,
    kinds: &[Kind],
    spec: &Spec,
    listed: &ListedLoads,
) -> (Vec<CurvePoint>, Vec<usize>) {
    let mut counts = task.job.placement.curve.clone();
    counts.sort_unstable();
    counts.dedup();
    let k = task.cases.len();
    let (mut points, mut left_out): (Vec<CurvePoint>, Vec<usize>) = (Vec::new(), Vec::new());
    for gauges in counts {
        if spec.stop.is_asked() {
            break;
        }
        let mut spec = Spec {
            gauges,
            ..spec.clone()
        };
        spec.effort.perturbations = spec.effort.perturbations.min(4);
        spec.effort.starts = spec.effort.starts.min(4);
        spec.proof *= 0.05;
        let chosen = match choose_once(task, kinds, &spec) {
            Ok(c) => c,
            Err(ChoiceRefusal::By(PlaceError::Singular { .. } | PlaceError::TooTight { .. }))
            | Err(_) => {
                left_out.push(gauges);
                continue;
            }
        };
        let rows: Vec<Vec<f64>> = chosen.channels.iter().map(|c| c.row.clone()).collect();
        let Some(q) = evaluate_rows(&rows, &spec.prior, k) else {
            left_out.push(gauges);
            continue;
        };
        let q = in_job_order(q, &task.order);
        let recovered = chosen_as_recovered(task, &spec, &chosen.channels);
        let covariance = recovered.as_ref().unwrap_or(&q.covariance);
        let rows_of_loads = terms_listed(listed, k).into_iter().zip(&listed.units);
        let sigma: Vec<f64> = rows_of_loads
            .map(|(terms, u)| sigma_of(covariance, &task.scales, &terms) * u.factor)
            .collect();
        let all: Vec<&Vec<f64>> = rows.iter().chain(&task.kept_rows).collect();
        let sds = chosen.channels.iter().map(|c| c.sd);
        let sds: Vec<f64> = sds.chain(vec![1.0; task.kept_rows.len()]).collect();
        let s = Matrix::from_fn(all.len(), k, |r, c| all[r][c] * sds[r]);
        let load_sigma = (0..sigma.len())
            .map(|l| {
                let bought = points.last().map(|before| {
                    let steps = (gauges - before.gauges) as f64;
                    (before.load_sigma[l].sigma - sigma[l]) / steps
                });
                BoughtSigma {
                    name: listed.names[l].clone(),
                    sigma: sigma[l],
                    unit: listed.units[l].name.clone(),
                    less_by_a_gauge: bought,
                }
            })
            .collect();
        points.push(CurvePoint {
            gauges,
            efficiency_bound: chosen.efficiency_bound,
            condition_number_scaled: finite_or_none(dense::condition(&s)),
            worst_loss: q.worst_loss,
            load_sigma,
        });
    }
    (points, left_out)
}

/// Returns the finding on gauge counts that are not in the curve.
pub(super) fn incomplete_curve_finding(left_out: &[usize]) -> Option<Finding> {
    let counts: Vec<String> = left_out.iter().map(usize::to_string).collect();
    (!left_out.is_empty()).then(|| {
        Finding::new(
            Severity::Info,
            "curve-incomplete",
            "placement.curve",
            format!(
                "no layout of {} gauges separates the loads with the stated spacing",
                counts.join(", ")
            ),
            "",
        )
    })
}
