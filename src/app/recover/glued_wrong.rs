//! Gauges whose table states the other surface, or angles in radians: each is tried on all runs.

use super::task::Task;
use crate::app::job::{Job, JobGauge};
use crate::app::strain::{Fields, has_covariance, lay_gauges};
use crate::app::work::Work;
use crate::fe::strain_tensor::Surface;
use crate::finding::{Finding, Severity};
use crate::recovery::{EXPLAINED, ErrorModel, REPAIR, Readings, sum_of_squares};
use crate::sensitivity::{Sensitivity, from_cases};
use std::f64::consts::TAU;

/// Runs that every gauge is tried on at most.
const TRIED: usize = 50;

/// A change of a gauge's row in its table.
type Change = fn(&mut JobGauge) -> bool;

/// Returns the findings on gauges that fit the readings on the other surface, or with their angle in radians: all of them at once, or a
/// single one. None where the readings are explained, or S does not come from a model.
pub(super) fn findings(
    work: &mut Work,
    task: &Task,
    s: &Sensitivity,
    readings: &[Readings],
) -> Vec<Finding> {
    let Some(fields) = task.prepared.fields.as_ref() else {
        return Vec::new();
    };
    let step = readings.len().div_ceil(TRIED).max(1);
    let readings: Vec<Readings> = readings.iter().step_by(step).cloned().collect();
    let base = reduced(s, &readings, task.errors);
    if base < EXPLAINED || base.is_nan() || has_covariance(task.job) {
        return Vec::new();
    }
    let changes: [(Change, &str, &str, &str); 2] = [
        (
            other_surface,
            "gauge-other-side",
            "on the other surface",
            "correct `surface` in the table of gauges (top is Z2, bottom Z1 of the element)",
        ),
        (
            radians,
            "gauge-angle-in-radians",
            "with the angle in radians",
            "state angles in degrees",
        ),
    ];
    let mut out = Vec::new();
    for (change, code, words, remedy) in changes {
        let Some((changed, of_gauge)) = changed(work, task, fields, s, change) else {
            continue;
        };
        let found = best(s, &changed, &of_gauge, &readings, task.errors)
            .filter(|(_, chi2)| *chi2 < REPAIR * base);
        out.extend(found.map(|(gauge, chi2)| {
            let (subject, whose) = match gauge {
                None => ("all".to_owned(), "all gauges".to_owned()),
                Some(g) => (s.gauges[g].clone(), format!("gauge `{}`", s.gauges[g])),
            };
            Finding::new(
                Severity::Error,
                code,
                subject,
                format!(
                    "{whose} {words} would explain the readings: the residual sum of squares falls to {:.2} % of its value",
                    100.0 * chi2 / base
                ),
                remedy,
            )
            .with_numbers(chi2 / base, REPAIR)
        }));
    }
    out
}

fn other_surface(g: &mut JobGauge) -> bool {
    g.surface = match g.surface {
        Surface::Top => Surface::Bottom,
        Surface::Bottom => Surface::Top,
    };
    g.surface_stated
}

/// Reads the number of an angle as radians; a turn at most.
fn radians(g: &mut JobGauge) -> bool {
    let may_be = g.angle_deg != 0.0 && g.angle_deg.abs() <= TAU;
    g.angle_deg = g.angle_deg.to_degrees();
    may_be
}

/// Returns S with every gauge changed, rows as in `s`, and whether the change makes sense for each; `None` where it does for none.
fn changed(
    work: &mut Work,
    task: &Task,
    fields: &Fields,
    s: &Sensitivity,
    change: Change,
) -> Option<(Sensitivity, Vec<bool>)> {
    let mut job: Job = task.job.clone();
    let mut meant = Vec::new();
    for g in &mut job.gauges {
        let before = g.clone();
        if change(g) {
            meant.push(g.name.clone());
        } else {
            *g = before;
        }
    }
    if meant.is_empty() {
        return None;
    }
    // Findings on gauges that are only tried are no findings.
    let n = work.findings.len();
    let gauges = lay_gauges(work, &job, fields);
    work.findings.truncate(n);
    let all = from_cases(&gauges.ok()?, &fields.load_cases(&job)).ok()?;
    let rows: Option<Vec<usize>> = s
        .gauges
        .iter()
        .map(|name| all.gauges.iter().position(|g| g == name))
        .collect();
    let changed = Sensitivity {
        uncertainty: s.uncertainty.clone(),
        ..all.of_gauges(&rows?)
    };
    // A rosette has its name before those of its legs.
    let is_meant = |name: &String| {
        meant
            .iter()
            .any(|m| name == m || name.starts_with(&format!("{m}.")))
    };
    let of_gauge = s.gauges.iter().map(is_meant).collect();
    Some((changed, of_gauge))
}

/// Returns the change that fits best: of all gauges (`None`) or of one, with its reduced chi-square.
fn best(
    s: &Sensitivity,
    changed: &Sensitivity,
    of_gauge: &[bool],
    readings: &[Readings],
    errors: ErrorModel,
) -> Option<(Option<usize>, f64)> {
    let chi2 = |s: &Sensitivity| reduced(s, readings, errors);
    let all = of_gauge.iter().all(|m| *m).then(|| (None, chi2(changed)));
    let single = (0..s.gauges.len()).filter(|g| of_gauge[*g]).map(|g| {
        let mut one = s.clone();
        for l in 0..one.loads.len() {
            one.values[(g, l)] = changed.values[(g, l)];
        }
        (Some(g), chi2(&one))
    });
    let tried = all.into_iter().chain(single).filter(|t| t.1.is_finite());
    tried.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Returns the residual sum of squares over its degrees of freedom.
fn reduced(s: &Sensitivity, readings: &[Readings], errors: ErrorModel) -> f64 {
    let (chi2, dof) = sum_of_squares(s, readings, errors);
    chi2 / dof as f64
}
