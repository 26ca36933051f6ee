//! The gauges that the job already has, by the same measures.

use super::job_gauge_rows::gluing_variance;
use super::layout_findings::{as_recovered, in_job_order, sigma_rows};
use super::outcome::{InstalledLayout, InstalledQuality, WorstLoss};
use super::task::Task;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::Faults;
use crate::host::outcome::finite_or_none;
use crate::host::work::Work;
use crate::placement::candidates::Candidates;
use crate::placement::quality::evaluate_rows;
use crate::placement::{self, Spec, place};
use crate::strain_chain::lay_gauges;
use crate::workflow::recover::list_load_columns;

/// Evaluates the installed layout with the same measures as the new layout. The determinant includes only noise. `None` if the job has no gauges.
pub(super) fn evaluate_installed(
    work: &mut Work,
    task: &Task,
    c: &Candidates,
    spec: &Spec,
) -> Result<Option<InstalledLayout>, Faults> {
    let (job, fields, scales) = (task.job, task.fields, &task.scales);
    if job.gauges.is_empty() {
        return Ok(None);
    }
    let gauges = lay_gauges(work, job, fields)?;
    let s = match task.s_of(&gauges) {
        Ok(s) => s,
        Err(missing) => {
            work.findings.push(Finding::new(
                Severity::Warning,
                "installed-gauges-without-strain",
                list_few(&missing.iter().map(|m| m.gauge.as_str()).collect::<Vec<_>>()),
                "a subcase has no strain at the installed gauges: the installed layout is not evaluated",
                "ask for STRAIN of their elements in every subcase",
            ));
            return Ok(None);
        }
    };
    let k = task.cases.len();
    // The prior leaves out the gauges that stay, because they are among the installed gauges.
    let spec = Spec {
        prior: task.without_kept(spec),
        ..spec.clone()
    };
    let noise = job.placement.noise_microstrain;
    let order = &task.order;
    let read = task.rows_of(&gauges, &s, job.placement.model_uncertainty_rel, &[]);
    let over_noise = |row: &Vec<f64>| row.iter().map(|v| v / noise).collect();
    let rows: Vec<Vec<f64>> = read.strain.iter().map(over_noise).collect();
    let Some(q) = evaluate_rows(&rows, &spec.prior, k).map(|q| in_job_order(q, order)) else {
        return Ok(Some(InstalledLayout {
            gauges: gauges.len(),
            rank: Some(s.rank()),
            quality: None,
        }));
    };
    let bound = if gauges.len() == spec.gauges && !c.has_slopes() {
        None
    } else {
        let plain = Candidates::clone(c).with_noise_only();
        let other = Spec {
            gauges: gauges.len(),
            effort: crate::placement::exchange::Effort {
                starts: 2,
                perturbations: 0,
                seed: 1,
            },
            proof: 0.0,
            loss: placement::Loss::Judged,
            ..spec.clone()
        };
        place(&plain, &other).ok().map(|l| l.upper_bound)
    };
    let log_det = crate::placement::quality::value(&rows, &spec.prior, k, &spec.criterion);
    let u = match task.all_calibrated(&gauges) {
        true => 0.0,
        false => job.placement.model_uncertainty_rel,
    };
    let recovered = as_recovered(task, &spec.prior, &read.over_sd, u);
    let more = gluing_variance(task, &gauges);
    let glued = task.rows_of(&gauges, &s, job.placement.model_uncertainty_rel, &more);
    let as_glued = as_recovered(task, &spec.prior, &glued.over_sd, u);
    let load_sigma = match (&recovered, &as_glued) {
        (Some(r), Some(g)) => sigma_rows(job, &list_load_columns(job, &s)?, Some(r), g, scales),
        _ => Vec::new(),
    };
    let quality = InstalledQuality {
        log_det,
        upper_bound: bound,
        condition_number: finite_or_none(s.condition_number()),
        condition_number_scaled: finite_or_none(s.condition_number_scaled()),
        load_sigma,
        worst_loss: WorstLoss {
            gauge: s.gauges[q.worst].clone(),
            leverage: q.leverage[q.worst],
            efficiency_left: q.worst_loss,
        },
    };
    Ok(Some(InstalledLayout {
        gauges: gauges.len(),
        rank: None,
        quality: Some(quality),
    }))
}
