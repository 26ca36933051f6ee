//! Known loads of a calibration as input of the search for wrong inputs. A model with a wrong unit or sign must not be the prior. Otherwise the whole
//! strain of the loads would count as scatter of the runs.

use super::start::is_known;
use super::types::{GaugeShift, KnownRun, ShiftWord, Task};
use crate::finding::{Finding, Severity};
use crate::input_faults::{
    Channels, DetectedFault, FaultTreatment, InputFault, Inputs, KnownLoads, RecordedRuns, Rules,
    findings_of_recorded_loads, search_faults,
};
use crate::linalg::Matrix;

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

/// Returns the faults of gauges that the known loads show with the model as it is, the clearest first. Without a model there are none.
fn faults_of_gauges(task: &Task, used: &[usize]) -> Vec<DetectedFault> {
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
    search_faults(&misfit, &mut Vec::new, &Rules::STATED)
}

/// Returns the dead, reversed and exchanged gauges that known loads show and the calibration did not find. The calibration may instead have reported
/// faults of other gauges or of runs. `is_any_run_refused`: whether runs contradict the others. The list is empty if the known loads are wrong.
pub(super) fn hidden_gauge_faults(
    task: &Task,
    shifts: &[GaugeShift],
    is_any_run_refused: bool,
) -> Vec<InputFault> {
    let all: Vec<usize> = (0..task.runs.len()).collect();
    if task.model.is_none() || !wrong_loads(task, &all, Vec::new()).is_empty() {
        return Vec::new();
    }
    let found = faults_of_gauges(task, &all).into_iter().map(|f| f.fault);
    let notable = |g: &usize| shifts[*g].word != ShiftWord::None;
    let is_hidden = |f: &InputFault| {
        let (of, Some(_)) = (f.gauges(), word_of(f)) else {
            return false;
        };
        let mut others = (0..shifts.len()).filter(|g| !of.contains(g) && notable(g));
        is_any_run_refused || others.next().is_some() || !of.iter().all(notable)
    };
    found.filter(is_hidden).collect()
}

/// Returns the words of the shifts of the gauges of a fault; `None` for a fault whose effect on a row of S is not known.
fn word_of(fault: &InputFault) -> Option<Vec<(usize, ShiftWord)>> {
    match *fault {
        InputFault::Sign(Channels::One(g)) => Some(vec![(g, ShiftWord::Sign)]),
        InputFault::Dead(g) => Some(vec![(g, ShiftWord::Dead)]),
        InputFault::Exchanged(a, b) => {
            let with = |with| ShiftWord::Exchanged { with };
            Some(vec![(a, with(b)), (b, with(a))])
        }
        _ => None,
    }
}

/// Returns the task with the rows of the model that the faulty gauges have; `None` without faults or model.
pub(super) fn with_prior_of_faults(task: &Task, faults: &[InputFault]) -> Option<Task> {
    let model = task.model.as_ref().filter(|_| !faults.is_empty())?;
    let change = |rows: &mut Matrix| {
        // Readings are corrected in the order of the faults, and rows change in the opposite order.
        for fault in faults.iter().rev() {
            let scale = match fault {
                InputFault::Sign(_) => -1.0,
                InputFault::Dead(_) => 0.0,
                _ => 1.0,
            };
            match fault.gauges()[..] {
                [g] => (0..rows.ncols()).for_each(|l| rows[(g, l)] *= scale),
                [a, b] => (0..rows.ncols()).for_each(|l| {
                    (rows[(a, l)], rows[(b, l)]) = (rows[(b, l)], rows[(a, l)]);
                }),
                _ => {}
            }
        }
    };
    let mut model = model.clone();
    change(&mut model.values);
    model.moves.iter_mut().for_each(|m| change(&mut m.change));
    if let Some(of) = &mut model.off_drawing {
        let all = [
            &mut of.turned,
            &mut of.crossed,
            &mut of.along,
            &mut of.across,
        ];
        all.into_iter().for_each(change);
    }
    Some(Task {
        model: Some(model),
        ..task.clone()
    })
}

/// Changes shifts from the rows of [`with_prior_of_faults`] to shifts from the rows of the model of `stated`. The distance of the rows is in sigmas
/// of the stated error, with loads of the size that strains some gauge most.
pub(super) fn add_faults(shifts: &mut [GaugeShift], stated: &Task, faults: &[InputFault]) {
    let Some(model) = &stated.model else { return };
    let largest = |l: usize| {
        model
            .values
            .column(l)
            .iter()
            .fold(0.0_f64, |m, v| m.max(v.abs()))
    };
    let scales: Vec<f64> = (0..model.values.ncols()).map(largest).collect();
    let norm = |value: &dyn Fn(usize) -> f64| {
        let of_load = |(l, c): (usize, &f64)| if *c > 0.0 { value(l) / c } else { 0.0 };
        let each = scales.iter().enumerate().map(of_load);
        each.map(|v| v * v).sum::<f64>().sqrt()
    };
    for (g, word) in faults.iter().filter_map(word_of).flatten() {
        let row = |l: usize| model.values[(g, l)];
        let found = |l: usize| match word {
            ShiftWord::Sign => -row(l),
            ShiftWord::Exchanged { with } => model.values[(with, l)],
            _ => 0.0,
        };
        let (moved, size) = (norm(&|l| found(l) - row(l)), norm(&row));
        let own: f64 = (0..scales.len()).map(|l| found(l) * row(l)).sum();
        let all: f64 = (0..scales.len()).map(|l| row(l) * row(l)).sum();
        let shift = &mut shifts[g];
        shift.word = word;
        // A row of zeros, or a model that is stated as exact, has no such measure.
        let (scale, sigmas) = (own / all, moved / (model.uncertainty_rel * size));
        if scale.is_finite() && sigmas.is_finite() {
            shift.scale *= scale;
            shift.shift = sigmas;
        }
    }
}

/// Returns the findings on gauges for which known loads show an offset, another unit, or the same reading in all runs. `shifts` contains the faults
/// that the rows of S show. S includes the effect of these faults, so that no finding is an error.
pub(super) fn wrong_gauges(task: &Task, used: &[usize], shifts: &[GaugeShift]) -> Vec<Finding> {
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
    let found = faults_of_gauges(task, used).into_iter();
    let new = found.filter(|f| is_new(&f.fault));
    new.map(|f| Finding {
        severity: Severity::Warning,
        ..f.finding(&task.gauges, FaultTreatment::AsMeasured)
    })
    .collect()
}
