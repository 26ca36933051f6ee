//! S for alternative installations of the gauges of a job: on the other surface, or with angles in radians.

use super::{Fields, has_covariance, lay_gauges};
use crate::fe::strain_tensor::Surface;
use crate::host::work::Work;
use crate::input_faults::{AlternativeRows, Channels, InputFault};
use crate::job::{Job, JobGauge};
use crate::linalg::Matrix;
use crate::sensitivity::from_cases;
use std::f64::consts::TAU;

/// Names of gauges, and their rows.
type NamedRows = (Vec<String>, Matrix);

/// Returns the alternatives for gauges with these names; empty if S is not from a model.
pub fn alternative_rows(
    work: &mut Work,
    job: &Job,
    fields: Option<&Fields>,
    gauges: &[String],
) -> Vec<AlternativeRows> {
    let Some(fields) = fields else {
        return Vec::new();
    };
    alternatives_of(work, job, gauges, &|work, job| {
        let laid = lay_gauges(work, job, fields).ok()?;
        let all = from_cases(&laid, &fields.load_cases(job)).ok()?;
        Some((all.gauges, all.values))
    })
}

/// Returns the alternatives for gauges with these names. `rows_of` computes the rows of a changed job. Empty if S is calibrated.
pub fn alternatives_of(
    work: &mut Work,
    job: &Job,
    gauges: &[String],
    rows_of: &dyn Fn(&mut Work, &Job) -> Option<NamedRows>,
) -> Vec<AlternativeRows> {
    if has_covariance(job) {
        return Vec::new();
    }
    let mut rows = |fault, change| change_gauges(work, job, (gauges, rows_of), (fault, change));
    let sides = rows(InputFault::OtherSide, other_surface);
    sides
        .into_iter()
        .chain(rows(InputFault::Radians, radians))
        .collect()
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

/// Returns S with every gauge changed to which `change` applies; `None` if it applies to no gauge.
fn change_gauges(
    work: &mut Work,
    job: &Job,
    (names, rows_of): (&[String], &dyn Fn(&mut Work, &Job) -> Option<NamedRows>),
    (fault, change): (fn(Channels) -> InputFault, fn(&mut JobGauge) -> bool),
) -> Option<AlternativeRows> {
    let mut job: Job = job.clone();
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
    // Findings on gauges that are changed only as a trial are dropped.
    let n = work.findings.len();
    let found = rows_of(work, &job);
    work.findings.truncate(n);
    let (all, values) = found?;
    let row = |name: &String| all.iter().position(|g| g == name);
    let rows: Option<Vec<usize>> = names.iter().map(row).collect();
    // The names of the legs of a rosette begin with the name of the rosette.
    let is_meant = |name: &String| {
        let of = |m: &String| name == m || name.starts_with(&format!("{m}."));
        meant.iter().any(of)
    };
    let rows = rows?;
    Some(AlternativeRows {
        fault,
        rows: Matrix::from_fn(rows.len(), values.ncols(), |g, l| values[(rows[g], l)]),
        applies: names.iter().map(is_meant).collect(),
    })
}
