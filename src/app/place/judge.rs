//! What is to be said of a layout.

use super::choose::Chosen;
use super::outcome::PlacedGauge;
use crate::app::job::Job;
use crate::app::strain::{LoadSigma, load_units};
use crate::app::work::Work;
use crate::finding::{Finding, Severity};
use crate::placement::quality::Quality;
use crate::placement::{Loss, Spec};
use crate::sensitivity::Sensitivity;

/// The standard deviations in job order.
pub(super) fn in_job_order(mut q: Quality, order: &[usize]) -> Quality {
    let led = q.sigma.clone();
    for (i, &l) in order.iter().enumerate() {
        q.sigma[l] = led[i];
    }
    q
}

/// Standard deviations of the loads in report units.
pub(super) fn sigma_rows(
    job: &Job,
    s: &Sensitivity,
    q: &Quality,
    scales: &[f64],
) -> Vec<LoadSigma> {
    let names: Vec<String> = s.loads.iter().map(|l| l.name.clone()).collect();
    load_units(job, &names)
        .into_iter()
        .zip(names)
        .enumerate()
        .map(|(l, (u, name))| LoadSigma {
            name,
            sigma: q.sigma[l] * scales[l] * u.factor,
            unit: u.name,
        })
        .collect()
}

/// Findings on the layout.
pub(super) fn judge_layout(
    work: &mut Work,
    layout: &Chosen,
    q: &Quality,
    spec: &Spec,
    placed: &[PlacedGauge],
    k: usize,
) {
    if q.worst_loss == 0.0 {
        work.findings.push(Finding::new(
            Severity::Warning,
            "no-gauge-may-fail",
            "placement.gauges",
            format!("{} gauges for {k} loads, and nothing may fail: the loss of one leaves loads that can't be separated, and no residual shows a fault", placed.len()),
            "place a few gauges more than loads",
        ));
    } else if q.worst_loss < 0.5 {
        work.findings.push(
            Finding::new(
                Severity::Info,
                "worst-loss",
                &placed[q.worst].gauge.name,
                format!(
                    "losing gauge `{}` leaves {:.0} % of the efficiency",
                    placed[q.worst].gauge.name,
                    100.0 * q.worst_loss
                ),
                "protect it, or place more gauges",
            )
            .with_numbers(q.worst_loss, 0.5),
        );
    }
    if spec.spacing <= 0.0 {
        work.findings.push(Finding::new(
            Severity::Info,
            "no-spacing",
            "placement.spacing",
            "no spacing is stated: gauges may be asked for side by side, or at several angles on one element",
            "state [placement] spacing, as much as a technician needs",
        ));
    }
    if layout.efficiency_bound < 0.9
        && spec.loss == Loss::Judged
        && layout.least_condition.is_none()
    {
        work.findings.push(
            Finding::new(
                Severity::Info,
                "certificate-loose",
                "efficiency_bound",
                "the bound leaves room between this layout and the best possible: it is loose where gauges are few or kept apart",
                "",
            )
            .with_numbers(layout.efficiency_bound, 0.9),
        );
    }
}
