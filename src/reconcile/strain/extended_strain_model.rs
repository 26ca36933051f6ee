//! Influence, loads and corrected readings of the model extended by identified effects.

use super::frame::StrainFrame;
use super::state::StrainState;
use crate::reconcile::effect::{Candidate, Correction, Extension, Member, full_id, library};
use crate::reconcile::outcome::NamedEffect;

/// Returns the model with the effects of structure and loads included: influence, and the loads of every run.
pub fn extended_state(frame: &StrainFrame, effects: &[NamedEffect]) -> StrainState {
    let candidates = candidates(frame, effects);
    StrainState::from_members(frame, &members(frame, effects, &candidates))
}

fn candidates(frame: &StrainFrame, effects: &[NamedEffect]) -> Vec<Candidate> {
    if effects.is_empty() {
        return Vec::new();
    }
    let ids: Vec<String> = effects.iter().map(|e| e.id.clone()).collect();
    library(frame, &ids)
}

/// Returns the effects as members. Of several forms of an effect, selects the form with as many parameters and the same extension.
fn members<'a>(
    frame: &StrainFrame,
    effects: &'a [NamedEffect],
    candidates: &'a [Candidate],
) -> Vec<Member<'a>> {
    let member = |e: &'a NamedEffect| {
        let of = |c: &&Candidate| {
            let parameters = e.size.get(..c.effect.parameters().len());
            full_id(c.effect.as_ref()) == e.id
                && parameters.is_some_and(|p| c.effect.extension(frame, p) == e.extension)
        };
        let c = candidates.iter().find(of)?;
        Some(Member {
            effect: c.effect.as_ref(),
            parameters: e.size.get(..c.effect.parameters().len())?,
        })
    };
    effects.iter().filter_map(member).collect()
}

/// Returns the readings with channel faults corrected, `n_runs x n_gauges`, and without the strain of masses that were added after the zero. `None`
/// if no effect requires a correction. Faults are corrected in the reverse of the order in which they act.
pub fn corrected_readings(frame: &StrainFrame, effects: &[NamedEffect]) -> Option<Vec<f64>> {
    let at = |name: &str| frame.gauges.iter().position(|g| g.name == name);
    let n_g = frame.n_gauges();
    let mut out = frame.observations.values.clone();
    let mut changed = false;
    for e in effects.iter().rev() {
        match &e.extension {
            Extension::Channels(corrections) => {
                for (name, correction) in corrections {
                    let Some(g) = at(name) else { continue };
                    for row in out.chunks_exact_mut(n_g.max(1)) {
                        changed |= undo(row, g, correction, &at);
                    }
                }
            }
            Extension::Mass { place, kilogram } => {
                let Some(mass) = frame.masses.iter().find(|m| m.place == *place) else {
                    continue;
                };
                changed = true;
                for row in out.chunks_exact_mut(n_g.max(1)) {
                    row.iter_mut()
                        .zip(&mass.per_kg)
                        .for_each(|(cell, per_kg)| *cell -= kilogram * per_kg);
                }
            }
            _ => {}
        }
    }
    changed.then_some(out)
}

/// Corrects a fault in one row of readings; returns false for a fault of the gauge and not of its reading.
fn undo(
    row: &mut [f64],
    gauge: usize,
    correction: &Correction,
    at: &dyn Fn(&str) -> Option<usize>,
) -> bool {
    let other = match correction {
        Correction::ExchangedWith(name) => at(name),
        _ => None,
    };
    if let Some(other) = other.filter(|o| gauge < row.len() && *o < row.len()) {
        row.swap(gauge, other);
        return true;
    }
    let Some(cell) = row.get_mut(gauge) else {
        return false;
    };
    match correction {
        Correction::Sign => *cell = -*cell,
        Correction::Gain(gain) if *gain != 0.0 => *cell /= gain,
        Correction::Offset(offset) => *cell -= offset,
        Correction::Ignore => *cell = f64::NAN,
        Correction::Gain(_)
        | Correction::ExchangedWith(_)
        | Correction::AngleDeg(_)
        | Correction::PositionMm(_) => return false,
    }
    true
}
