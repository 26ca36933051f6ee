//! Known loads of a calibration, as the search for wrong inputs takes them. A prior that is off by a unit or a sign must not be learnt from: all
//! strain of the loads would count as scatter of the runs.

use super::start::is_known;
use super::types::{KnownRun, Task};
use crate::finding::Finding;
use crate::input_faults::{RecordedRuns, findings_of_recorded_loads};

/// Returns the findings on known loads of the other sign, in another unit, or exchanged; without a model there are none. Gauges that are
/// `wrongly_wired` do not count.
pub(super) fn wrong_loads(task: &Task, used: &[usize], wrongly_wired: Vec<usize>) -> Vec<Finding> {
    let Some(model) = &task.model else {
        return Vec::new();
    };
    let all: Vec<&KnownRun> = used.iter().filter_map(|r| task.runs.get(*r)).collect();
    let load = |run: usize, l: usize| all[run].loads.mean.get(l).copied().unwrap_or(0.0);
    let size = |l: usize| (0..all.len()).fold(0.0_f64, |a, r| a.max(load(r, l).abs()));
    let sizes: Vec<f64> = (0..task.loads.len()).map(size).collect();
    let runs = RecordedRuns {
        loads: task.loads.iter().map(|l| l.name.as_str()).collect(),
        readings: all.iter().map(|r| r.strain.clone()).collect(),
        strain_of: Box::new(|g, r, l, from| model.values[(g, l)] * load(r, from)),
        quantities: task.loads.iter().map(|l| l.quantity).collect(),
        known: all.iter().map(|r| is_known(r, &sizes)).collect(),
        excluded: wrongly_wired,
        noise: task.noise,
        model_rel: model.uncertainty_rel,
    };
    findings_of_recorded_loads(&runs, "the runs file")
}
