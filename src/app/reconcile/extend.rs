//! What the named effects of strain change: readings, S, what acts in the runs, the deck.

use super::deck_frame::DeckFrame;
use super::extended::{ExtendedModel, ExtendedS};
use super::extended_deck::NamedStiffness;
use super::extended_loads::side_loads;
use super::redirect::text_of;
use crate::app::fault::Faults;
use crate::app::job::Job;
use crate::app::work::Work;
use crate::finding::{Finding, Severity};
use crate::reconcile::effect::{Correction, Extension, Nuisance};
use crate::reconcile::strain::{
    StiffnessOf, StrainFrame, StrainState, corrected_readings, extended_state,
};
use crate::reconcile::{NamedEffect, Outcome};
use crate::units::KILO;

/// File name of the job.
const JOB: &str = "job_extended.toml";

/// Why an effect can't be put into the model of this job; `None` where it can.
fn out_of_reach(job: &Job, e: &NamedEffect, deck: Option<&DeckFrame>) -> Option<&'static str> {
    let turned = |c: &Correction| matches!(c, Correction::AngleDeg(_) | Correction::PositionMm(_));
    match (&e.extension, deck) {
        (Extension::Channels(list), Some(_)) if list.iter().any(|(_, c)| turned(c)) => {
            Some("another angle or place of the gauge: change it in the list of gauges")
        }
        (Extension::Scale(_), Some(_)) => {
            Some("one factor on all strain: change the modulus in the deck, or the gains")
        }
        (Extension::LocalStiffness { .. } | Extension::Described { .. }, Some(_)) => {
            Some("a change of a region of the deck that no property bounds")
        }
        (
            Extension::NuisanceLoads {
                source: Nuisance::UniformTemperature,
                ..
            },
            Some(_),
        ) => Some(
            "the apparent strain of an even temperature, which no load of the deck makes: log the temperature in every run",
        ),
        (
            Extension::NuisanceLoads {
                source: Nuisance::TemperatureGradient,
                ..
            },
            Some(_),
        ) if job
            .reconcile
            .as_ref()
            .is_none_or(|r| r.temperature_set.is_none()) =>
        {
            Some(
                "a temperature that differs from place to place, and the job names no temperature set",
            )
        }
        (
            Extension::NuisanceLoads {
                source: Nuisance::Ground,
                ..
            },
            _,
        ) => Some("wheel forces of ground that is not flat: weigh every wheel where it stands"),
        (Extension::Nothing, _) => Some("no effect of the library"),
        _ => None,
    }
}

/// The extended model; `None`, with a finding for each effect that can't be put into it, where there is one.
///
/// # Errors
/// A job that can't be read again.
pub(super) fn extended(
    job: &Job,
    work: &mut Work,
    frame: &StrainFrame,
    outcome: &Outcome,
    deck: Option<&DeckFrame>,
) -> Result<Option<ExtendedModel>, Faults> {
    let effects = &outcome.effects;
    let not_in = |e| out_of_reach(job, e, deck).map(|why| effect_not_in_model(&e.id, why));
    let not_in: Vec<Finding> = effects.iter().filter_map(not_in).collect();
    if !not_in.is_empty() {
        work.findings.extend(not_in);
        return Ok(None);
    }
    let deck_bytes = match deck.map_or(Edited::Unchanged, |d| deck_with(job, d, outcome)) {
        Edited::Unchanged => None,
        Edited::Deck(bytes) => Some(bytes),
        Edited::Refused => {
            let ids: Vec<&str> = effects.iter().map(|e| e.id.as_str()).collect();
            let why = "the cards of the deck could not be edited (a property that is no PSHELL or PBUSH, files that do not join)";
            work.findings
                .push(effect_not_in_model(&ids.join(" + "), why));
            return Ok(None);
        }
    };
    let state = extended_state(frame, effects);
    let sensitivity = match deck {
        None => sensitivity_with(frame, outcome, &state),
        Some(_) => None,
    };
    let noted = effects.iter().any(|e| changes_notes(&e.extension));
    Ok(Some(ExtendedModel {
        deck: deck_bytes,
        readings: corrected_readings(frame, effects),
        sensitivity,
        runs: noted.then_some(state.columns),
        ..ExtendedModel::of(JOB, text_of(work, job)?)
    }))
}

fn effect_not_in_model(id: &str, why: &str) -> Finding {
    Finding::new(
        Severity::Warning,
        "effect-not-in-model",
        id,
        format!("no extended model is written, since this effect can't be put into it: {why}"),
        "put it into the model by hand, then run `reconcile` again",
    )
}

/// What becomes of the deck.
enum Edited {
    /// It stays as it is.
    Unchanged,
    /// It holds the effects.
    Deck(Vec<u8>),
    /// Its cards can't be edited.
    Refused,
}

/// The deck with the effects that it can hold.
fn deck_with(job: &Job, deck: &DeckFrame, outcome: &Outcome) -> Edited {
    let mut stiffness: Vec<NamedStiffness> = Vec::new();
    let mut masses: Vec<(String, f64)> = Vec::new();
    for e in &outcome.effects {
        match &e.extension {
            Extension::ZoneStiffness { place, percent } => {
                stiffness.push((StiffnessOf::Zone, place.clone(), *percent))
            }
            Extension::JointStiffness { place, percent } => {
                stiffness.push((StiffnessOf::Joint, place.clone(), *percent))
            }
            Extension::Mass { place, kilogram } => masses.push((place.clone(), *kilogram)),
            _ => {}
        }
    }
    let side = side_loads(job, &outcome.effects);
    if stiffness.is_empty() && masses.is_empty() && side.is_empty() {
        return Edited::Unchanged;
    }
    deck.extended(job, &stiffness, &masses, &side)
        .map_or(Edited::Refused, Edited::Deck)
}

/// Does an effect change what was noted of runs?
fn changes_notes(e: &Extension) -> bool {
    use Extension::{LoadScale, PayloadOffset, RunExchange, RunRecord};
    matches!(
        e,
        PayloadOffset { .. } | LoadScale { .. } | RunExchange { .. } | RunRecord { .. }
    )
}

/// S with effects in it and with the loads that were left out; `None` where it stays as it is.
fn sensitivity_with(
    frame: &StrainFrame,
    outcome: &Outcome,
    state: &StrainState,
) -> Option<ExtendedS> {
    let left_out = nuisance(frame, &outcome.effects);
    let changed = state.influence != frame.influence;
    if !changed && left_out.is_empty() {
        return None;
    }
    let known = frame.nuisance.iter();
    Some(ExtendedS {
        influence: state.influence.clone(),
        changed,
        known: known
            .map(|n| (n.name.clone(), n.per_unit.clone()))
            .collect(),
        left_out,
    })
}

/// Columns of loads that were left out, with their usual size in the units of the job (forces count in kN in the column: so do degrees).
fn nuisance(frame: &StrainFrame, effects: &[NamedEffect]) -> Vec<(String, Vec<f64>, f64)> {
    let mut out = Vec::new();
    for e in effects {
        let Extension::NuisanceLoads { source, loads, .. } = &e.extension else {
            continue;
        };
        let pattern = |name: &String| match source {
            Nuisance::SideLoads => frame
                .other_loads
                .iter()
                .find(|o| o.0 == *name)
                .map(|o| o.1.clone()),
            Nuisance::UniformTemperature => frame.thermal_uniform.clone(),
            Nuisance::TemperatureGradient => frame.thermal_gradient.clone(),
            Nuisance::Ground => None,
        };
        let found = |k: usize| e.size.get(k).copied();
        let largest = e.size.iter().copied().fold(0.0, f64::max);
        for (k, (name, usual)) in loads.iter().enumerate() {
            // What was found, where there is one size a load; else what is usual, scaled up to what was found at most.
            let size = if loads.len() == 1 {
                found(k).unwrap_or(*usual)
            } else {
                usual.max(largest)
            };
            out.extend(pattern(name).map(|p| (name.clone(), p, size * KILO)));
        }
    }
    out
}
