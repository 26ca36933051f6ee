//! Known loads of a calibration as input of the search for wrong inputs. A model with a wrong unit or sign must not be the prior. Otherwise the whole
//! strain of the loads would count as scatter of the runs.

use super::start::is_known;
use super::types::{GaugeShift, KnownRun, ShiftWord, Task};
use crate::finding::{Finding, Severity};
use crate::input_faults::{
    FaultTreatment, InputFault, Inputs, KnownLoads, RecordedRuns, Rules,
    findings_of_recorded_loads, search_faults,
};

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

/// Returns the findings on gauges for which known loads show an offset, another unit, or the same reading in all runs. Without a model there are
/// none. `shifts` contains the faults that the rows of S show. S includes the effect of these faults, so no finding is an error.
pub(super) fn wrong_gauges(task: &Task, used: &[usize], shifts: &[GaugeShift]) -> Vec<Finding> {
    let Some(model) = &task.model else {
        return Vec::new();
    };
    let k = task.loads.len();
    let all: Vec<&KnownRun> = used.iter().filter_map(|r| task.runs.get(*r)).collect();
    let size = |l: usize| {
        all.iter()
            .fold(0.0_f64, |a, r| a.max(r.loads.mean[l].abs()))
    };
    let sizes: Vec<f64> = (0..k).map(size).collect();
    let runs: Vec<&KnownRun> = all.into_iter().filter(|r| is_known(r, &sizes)).collect();
    let sd = |l: usize| {
        let of_runs = runs
            .iter()
            .map(|r| r.loads.covariance[l * k + l].max(0.0).sqrt());
        of_runs.fold(0.0, f64::max)
    };
    let misfit = KnownLoads {
        inputs: Inputs {
            strain: runs.iter().map(|r| r.strain.clone()).collect(),
            rows: model.values.clone(),
        },
        loads: runs.iter().map(|r| r.loads.mean.clone()).collect(),
        noise: task.noise,
        load_noise: (0..k).map(sd).collect(),
        model_rel: model.uncertainty_rel,
    };
    let found = search_faults(&misfit, &mut Vec::new, &Rules::STATED);
    let is_new = |f: &InputFault| {
        let kind = matches!(
            f,
            InputFault::Offset(..) | InputFault::Unit(..) | InputFault::Stuck(_)
        );
        let of = f.gauges();
        kind && of
            .iter()
            .all(|g| shifts.get(*g).is_none_or(|s| s.word == ShiftWord::None))
    };
    let new = found.iter().filter(|f| is_new(&f.fault));
    new.map(|f| Finding {
        severity: Severity::Warning,
        ..f.finding(&task.gauges, FaultTreatment::AsMeasured)
    })
    .collect()
}
