//! Elements that the job wants a gauge on.

use super::pool::Kind;
use super::task::Task;
use crate::app::fault::Fault;
use crate::placement::candidates::{Angles, Choice};
use crate::placement::{Layout, Spec, quality};

/// Angles tried on a wanted element where the angle is continuous.
const STEPS: usize = 36;

/// Exchanges gauges of the layout until every wanted element has one, each time at the least loss of information. The certificate then says
/// how much of the best layout without that wish is left.
///
/// # Errors
/// Elements that are no candidates, more of them than gauges, no place at that spacing.
pub(super) fn on_wanted(
    task: &Task,
    kind: &Kind,
    spec: &Spec,
    layout: &mut Layout,
) -> Result<(), Fault> {
    let Some(wanted) = &task.job.candidates.wanted_elements else {
        return Ok(());
    };
    let refuse = |wrong: String, remedy: &str| {
        let (file, line) = (&*task.job.file, task.job.candidates.line);
        Fault::at(file, line, "candidates.wanted_elements", wrong, remedy)
    };
    let element = |place: usize| -> Option<u32> {
        let (shell, _) = task.sites.get(place)?;
        Some(task.fields.model().shells.get(shell.us())?.id)
    };
    let mut ids: Vec<u32> = (0..task.sites.len()).filter_map(element).collect();
    ids.sort_unstable();
    ids.dedup();
    for [a, b] in &wanted.0 {
        if a == b && ids.binary_search(a).is_err() {
            let wrong = format!("element {a} is no candidate");
            return Err(refuse(
                wrong,
                "name shells that the other keys of [candidates] allow",
            ));
        }
    }
    ids.retain(|id| wanted.contains(*id));
    if ids.len() > layout.gauges.len() {
        let wrong = format!("{} elements for {} gauges", ids.len(), layout.gauges.len());
        return Err(refuse(wrong, "want fewer elements, or place more gauges"));
    }
    let of = |c: &Choice| element(c.place as usize);
    for id in &ids {
        if layout.gauges.iter().any(|c| of(c) == Some(*id)) {
            continue;
        }
        // Gauges that hold another wanted element stay.
        let free: Vec<usize> = (0..layout.gauges.len())
            .filter(|i| of(&layout.gauges[*i]).is_none_or(|e| ids.binary_search(&e).is_err()))
            .collect();
        let places = (0..task.sites.len()).filter(|p| element(*p) == Some(*id));
        let mut best: Option<(f64, usize, Choice)> = None;
        for choice in places.flat_map(|p| choices(kind, p)) {
            for &i in &free {
                let mut gauges = layout.gauges.clone();
                gauges[i] = choice;
                if !fits(kind, spec, &gauges, i) {
                    continue;
                }
                let value = value(kind, spec, &gauges);
                if let Some(v) = value.filter(|v| best.is_none_or(|b| *v > b.0)) {
                    best = Some((v, i, choice));
                }
            }
        }
        let Some((_, i, choice)) = best else {
            let wrong = format!(
                "no gauge on element {id} keeps the spacing from the others and tells the loads apart"
            );
            return Err(refuse(
                wrong,
                "reduce [placement] spacing, or want elements further apart",
            ));
        };
        layout.gauges[i] = choice;
    }
    if let Some(v) = value(kind, spec, &layout.gauges) {
        layout.proved &= v >= layout.log_det;
        layout.log_det = v;
        layout.efficiency_bound = ((v - layout.upper_bound) / task.cases.len() as f64).exp();
    }
    Ok(())
}

fn choices(kind: &Kind, place: usize) -> Vec<Choice> {
    let at = |(step, angle): (usize, f64)| Choice {
        place: place as u32,
        step: step as u16,
        angle,
    };
    match kind.candidates.angles() {
        Angles::Fixed => vec![at((0, 0.0))],
        Angles::Grid(angles) => angles.iter().copied().enumerate().map(at).collect(),
        Angles::Continuous => {
            let turn = std::f64::consts::PI / STEPS as f64;
            (0..STEPS).map(|s| at((0, turn * s as f64))).collect()
        }
    }
}

/// Whether gauge `i` keeps its distance from the others.
fn fits(kind: &Kind, spec: &Spec, gauges: &[Choice], i: usize) -> bool {
    let at = |c: &Choice| kind.candidates.positions().get(c.place as usize).copied();
    gauges.iter().enumerate().all(|(j, other)| {
        if i == j {
            return true;
        }
        let apart = match (at(&gauges[i]), at(other)) {
            (Some(a), Some(b)) => {
                let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
                d.iter().map(|v| v * v).sum::<f64>().sqrt() >= spec.spacing
            }
            _ => true,
        };
        apart && gauges[i].place != other.place
    })
}

fn value(kind: &Kind, spec: &Spec, gauges: &[Choice]) -> Option<f64> {
    let rows: Vec<Vec<f64>> = gauges.iter().map(|&g| kind.candidates.row(g)).collect();
    let k = kind.candidates.n_loads();
    quality::value(&rows, &spec.prior, k, &spec.criterion)
}
