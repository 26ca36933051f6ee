//! How far each gauge's row moved, and what that looks like.

use super::state::State;
use super::types::{GaugeShift, MoveKind, ShiftWord, Task};
use crate::finding::{Finding, Severity};
use crate::linalg::precision::Precision;
use crate::sensitivity::Sensitivity;

/// Distance from which a shift is worth a word.
const NOTABLE: f64 = 3.0;
/// Share of the shift that one cause must explain to be named.
const EXPLAINED: f64 = 0.8;
/// Scale under which a gauge is dead.
const DEAD: f64 = 0.1;
/// Noise sd that the largest reading of a live gauge exceeds.
const LIVE: f64 = 3.0;

/// Every gauge's shift. The distance is measured with the model's stated error.
pub(super) fn check(task: &Task, state: &State, calibrated: &Sensitivity) -> Vec<GaugeShift> {
    let k = task.loads.len();
    (0..task.gauges.len())
        .map(|g| {
            let name = task.gauges[g].clone();
            let largest = task
                .runs
                .iter()
                .filter_map(|r| r.strain.get(g))
                .fold(
                    0.0_f64,
                    |a, v| if v.is_finite() { a.max(v.abs()) } else { a },
                );
            let silent = largest < LIVE * task.noise;
            let prior = &state.prior[g];
            if task.model.is_none() {
                let word = if silent {
                    ShiftWord::Dead
                } else {
                    ShiftWord::None
                };
                return GaugeShift {
                    name,
                    shift: 0.0,
                    scale: 1.0,
                    word,
                };
            }
            let row: Vec<f64> = (0..k)
                .map(|l| calibrated.values[(g, l)] * state.scales[l])
                .collect();
            let moved: Vec<f64> = row.iter().zip(&prior.mean).map(|(a, b)| a - b).collect();
            let along = |t: &[f64]| {
                let tt: f64 = t.iter().map(|v| v * v).sum();
                if tt > 0.0 {
                    t.iter().zip(&moved).map(|(a, b)| a * b).sum::<f64>() / tt
                } else {
                    0.0
                }
            };
            let explained = |t: &[f64]| {
                let c = along(t);
                let all: f64 = moved.iter().map(|v| v * v).sum();
                let left: f64 = moved.iter().zip(t).map(|(m, t)| (m - c * t).powi(2)).sum();
                if all > 0.0 { 1.0 - left / all } else { 0.0 }
            };
            let shift = Precision::of(&prior.covariance, k).map_or(0.0, |p| {
                let q: f64 = p.apply(&moved).iter().zip(&moved).map(|(a, b)| a * b).sum();
                (q / k.max(1) as f64).sqrt()
            });
            let scale = 1.0 + along(&prior.mean);
            let moves = task.model.as_ref().map_or(&[][..], |m| &m.moves);
            let turned = moves.iter().find(|m| m.kind == MoveKind::Turned);
            let turned: Option<Vec<f64>> =
                turned.map(|t| (0..k).map(|l| t.change[(g, l)] * state.scales[l]).collect());
            let expected = prior.mean.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
            let word = if silent && expected > LIVE * LIVE * task.noise || scale.abs() < DEAD {
                ShiftWord::Dead
            } else if shift < NOTABLE {
                ShiftWord::None
            } else if scale < 0.0 {
                ShiftWord::Sign
            } else if explained(&prior.mean) > EXPLAINED {
                ShiftWord::Gain
            } else if turned.is_some_and(|t| explained(&t) > EXPLAINED) {
                ShiftWord::Angle
            } else {
                ShiftWord::Place
            };
            GaugeShift {
                name,
                shift,
                scale,
                word,
            }
        })
        .collect()
}

/// A finding a notable gauge.
pub(super) fn findings(task: &Task, shifts: &[GaugeShift]) -> Vec<Finding> {
    let stated = task
        .model
        .as_ref()
        .map_or(0.0, |m| 100.0 * m.uncertainty_rel);
    let notable = shifts.iter().filter(|s| s.word != ShiftWord::None);
    notable
        .map(|s| {
            let name = &s.name;
            let (code, severity, looks) = match s.word {
                ShiftWord::Dead => ("gauge-dead", Severity::Warning, "it reads nothing in any run: dead, or not connected".to_owned()),
                ShiftWord::Sign => ("gauge-wired-backwards", Severity::Warning, "its sign is turned: wired backwards".to_owned()),
                ShiftWord::Gain => ("gauge-shifted", Severity::Warning, format!("it looks like a gain of {:.3}", s.scale)),
                ShiftWord::Angle => ("gauge-shifted", Severity::Warning, "it looks like a turned gauge".to_owned()),
                ShiftWord::Place | ShiftWord::None => ("gauge-shifted", Severity::Warning, "it looks like another place than the model's".to_owned()),
            };
            let message = if task.model.is_some() {
                format!("gauge `{name}` lies {:.1} sigma from the model (stated: {stated:.0} %): {looks}", s.shift)
            } else {
                format!("gauge `{name}`: {looks}")
            };
            Finding::new(severity, code, name, message, "check its wiring, place and bridge factor; the calibrated S already contains what the runs show").with_numbers(s.shift, NOTABLE)
        })
        .collect()
}
