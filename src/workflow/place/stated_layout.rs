//! Evaluation of a layout whose gauges the job states.

use super::chosen_layout::ChosenLayout;
use super::outcome::CertifiedLayout;
use super::spots::LaidSpot;
use super::task::{Task, know_the_loads};
use super::{LayoutOf, describe_layout, task_of};
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::job::{Job, JobGauge, Keep, NamedSpot, Optimality};
use crate::placement::quality::value;
use crate::placement::{PlaceError, Spec};
use crate::strain_chain::Fields;

/// Returns the job with these gauges as its only layout.
pub(super) fn job_with_layout(job: &Job, gauges: &[JobGauge]) -> Job {
    let mut out = job.clone();
    let spot = |g: &JobGauge| NamedSpot {
        gauge: g.clone(),
        cost: None,
    };
    out.candidates.spots = Some(gauges.iter().map(spot).collect());
    out.candidates.wanted_elements = None;
    let p = &mut out.placement;
    p.gauges = Some(gauges.len());
    p.keep = Keep::None;
    p.budget = None;
    p.curve = Vec::new();
    if p.criterion == Optimality::Condition {
        p.criterion = Optimality::D;
    }
    out
}

/// Describes the layout of a job of [`job_with_layout`] with the certificate of the best layout `best`.
///
/// # Errors
/// Gauges that can't be laid or have no strain, gauges that do not separate the loads.
pub(super) fn describe_stated(
    work: &mut Work,
    job: &Job,
    fields: &Fields,
    best: &CertifiedLayout,
) -> Result<LayoutOf, Faults> {
    let task = task_of(work, job, fields)?;
    let mut spec = task.spec(work);
    let mut log_det = log_det_of(&task, &spec);
    if log_det.is_none() {
        know_the_loads(
            work,
            &mut spec,
            job.placement.gauges.unwrap_or(0),
            task.cases.len(),
        );
        log_det = log_det_of(&task, &spec);
    }
    let Some(log_det) = log_det else {
        let singular = PlaceError::Singular {
            gauges: spec.gauges,
            loads: task.cases.len(),
        };
        return Err(task.refusal(&singular).into());
    };
    let loads = task.cases.len() as f64;
    let chosen = ChosenLayout {
        channels: spots_of(&task).flat_map(LaidSpot::channels).collect(),
        log_det,
        upper_bound: best.upper_bound,
        // A gauge at a place outside the candidates may be better than any candidate.
        efficiency_bound: ((log_det - best.upper_bound) / loads).exp().min(1.0),
        proved: false,
        nodes: 0,
        cost: None,
        least_condition: None,
    };
    let mut out = describe_layout(work, &task, &spec, &[], chosen)?;
    out.candidates = best.candidates;
    Ok(out)
}

fn spots_of<'a>(task: &'a Task) -> impl Iterator<Item = &'a LaidSpot> {
    task.spots.iter().flatten()
}

fn log_det_of(task: &Task, spec: &Spec) -> Option<f64> {
    let legs = spots_of(task).flat_map(|s| &s.legs);
    let rows: Vec<Vec<f64>> = legs.map(super::spots::Leg::row).collect();
    value(&rows, &spec.prior, task.cases.len(), &spec.criterion)
}
