//! Combinations of loads that no run has shown: known from the model only, or not at all.

use super::start::SPANNED;
use super::state::State;
use super::types::{Task, Undetermined};
use crate::finding::{Finding, Severity};
use crate::linalg::{Matrix, dense, spd};

/// Share of a load in a combination from which it is named.
const NAMED: f64 = 0.1;

/// Directions of the loads, in their sizes, along which the runs vary by nothing.
pub(super) fn check(task: &Task, state: &State) -> Vec<Undetermined> {
    let k = task.loads.len();
    let mut gram = vec![0.0; k * k];
    for e in &state.equations {
        spd::add_outer(&mut gram, &e.phi, 1.0);
    }
    let Some(d) = dense::svd(&Matrix::from_row_slice(k, k, &gram)) else {
        return Vec::new();
    };
    let limit = SPANNED * d.s.first().copied().unwrap_or(0.0);
    let null = (0..k).filter(|&i| d.s[i] <= limit);
    null.map(|i| {
        let terms: Vec<f64> = (0..k).map(|l| d.v[(l, i)] * state.scales[l]).collect();
        let top = terms
            .iter()
            .copied()
            .fold(0.0_f64, |a, v| if v.abs() > a.abs() { v } else { a });
        Undetermined {
            terms: terms.iter().map(|v| v / top).collect(),
        }
    })
    .collect()
}

/// `LF.FZ - 0.5 RF.FZ`; all loads where the shares are no numbers.
pub(super) fn formula(task: &Task, u: &Undetermined) -> String {
    let mut out = String::new();
    for (load, t) in task
        .loads
        .iter()
        .zip(&u.terms)
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
    let Some(first) = all.first() else {
        return Vec::new();
    };
    let list: Vec<String> = all.iter().map(|u| formula(task, u)).collect();
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
        let _ = first;
        Finding::new(
            Severity::Error,
            "calibration-not-determined",
            list.join("; "),
            format!(
                "the runs do not determine S: no run tells {} from nothing, and there is no model",
                list.join("; ")
            ),
            "add runs in which these loads act by themselves, give a [model], or drop loads",
        )
    };
    vec![finding.with_numbers(all.len() as f64, 0.0)]
}
