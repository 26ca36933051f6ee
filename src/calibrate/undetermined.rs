//! Combinations of loads that no run has shown: known from the model only, or not at all.

use super::state::State;
use super::types::{KnownRun, Task, Undetermined};
use super::unknown::Unknown;
use crate::finding::{Finding, Severity};
use crate::linalg::spd;

/// Share of a load in a combination from which it is named.
const NAMED: f64 = 0.1;

/// Directions of the loads, in their sizes, along which what is known of the runs' loads is nothing.
pub(super) fn check(task: &Task, state: &State) -> Vec<Undetermined> {
    let runs: Vec<&KnownRun> = (state.used.iter())
        .filter_map(|r| task.runs.get(*r))
        .collect();
    let directions = Unknown::of(&runs, &state.scales).untold;
    let one = |z: &Vec<f64>| {
        let terms: Vec<f64> = z.iter().zip(&state.scales).map(|(v, c)| v * c).collect();
        let top = terms
            .iter()
            .copied()
            .fold(0.0_f64, |a, v| if v.abs() > a.abs() { v } else { a });
        Undetermined {
            terms: terms.iter().map(|v| v / top).collect(),
        }
    };
    directions.iter().map(one).collect()
}

/// The task's sums of loads that no undetermined combination changes, in words.
fn known_sums(task: &Task, all: &[Undetermined]) -> String {
    let is_known = |terms: &&Vec<f64>| {
        let size = |a: &[f64]| spd::dot(a, a).sqrt();
        let alone = |u: &Undetermined| {
            let along = spd::dot(terms, &u.terms).abs();
            along < UNCHANGED * size(terms) * size(&u.terms)
        };
        size(terms) > 0.0 && all.iter().all(alone)
    };
    let known = task.sums.iter().filter(is_known);
    let words: Vec<String> = known.map(|terms| combination(task, terms)).collect();
    match words.is_empty() {
        true => String::new(),
        false => format!(". Known all the same: {}", words.join("; ")),
    }
}

/// Cosine under which a combination does not change a sum.
const UNCHANGED: f64 = 1e-6;

/// `LF.FZ - 0.5 RF.FZ`; all loads where the shares are no numbers.
fn combination(task: &Task, terms: &[f64]) -> String {
    let mut out = String::new();
    for (load, t) in task
        .loads
        .iter()
        .zip(terms)
        .filter(|(_, t)| t.abs() >= NAMED)
    {
        let sign = match (out.is_empty(), *t < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let size = if (t.abs() - 1.0).abs() < 5e-3 {
            String::new()
        } else {
            format!("{:.2} ", t.abs())
        };
        out.push_str(&format!("{sign}{size}{}", load.name));
    }
    if out.is_empty() {
        let names: Vec<&str> = task.loads.iter().map(|l| l.name.as_str()).collect();
        out = names.join(", ");
    }
    out
}

/// An error without a model, a remark with one.
pub(super) fn findings(task: &Task, all: &[Undetermined]) -> Vec<Finding> {
    if all.is_empty() {
        return Vec::new();
    }
    let list: Vec<String> = all.iter().map(|u| combination(task, &u.terms)).collect();
    let finding = if task.model.is_some() {
        Finding::new(
            Severity::Info,
            "known-from-model-only",
            list.join("; "),
            format!(
                "no run tells these combinations of loads: {}. They are known from the model only",
                list.join("; ")
            ),
            "apply one of these loads by itself, if it matters",
        )
    } else {
        Finding::new(
            Severity::Error,
            "calibration-not-determined",
            list.join("; "),
            format!(
                "the runs do not determine S: no run tells {} from nothing, and there is no model{}",
                list.join("; "),
                known_sums(task, all)
            ),
            "add runs in which these loads act by themselves, give a [model], or drop loads",
        )
    };
    vec![finding.with_numbers(all.len() as f64, 0.0)]
}
