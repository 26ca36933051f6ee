//! Changes by the named effects of strain: readings, S, loads of the runs, the deck.

use super::channel_corrections::{Weight, angle_corrections, corrections};
use super::deck_frame::DeckFrame;
use super::described_effects::effect_of;
use super::extended_deck::NamedStiffness;
use super::extended_loads::side_loads;
use super::extended_model::{ExtendedModel, ExtendedRuns, ExtendedS};
use super::redirect::text_of;
use crate::finding::{Finding, Severity};
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::job::{EffectSource, Job};
use crate::reconcile::effect::{Correction, Extension, Nuisance, RecordedQuantity};
use crate::reconcile::strain::{
    N_PAYLOAD_COLUMNS, PayloadWeight, StiffnessOf, StrainFrame, StrainState, corrected_readings,
    extended_state,
};
use crate::reconcile::{NamedEffect, Outcome};

/// File name of the job.
const JOB: &str = "job_extended.toml";

/// Returns why an effect can't be added to the model of this job; `None` if it can be added.
fn out_of_reach(job: &Job, e: &NamedEffect, deck: Option<&DeckFrame>) -> Option<&'static str> {
    let moved = |c: &Correction| matches!(c, Correction::PositionMm(_));
    match (&e.extension, deck) {
        (Extension::Channels(list), Some(_)) if list.iter().any(|(_, c)| moved(c)) => {
            Some("it moves the gauge: change the position in the list of gauges")
        }
        (Extension::LocalStiffness { .. }, Some(_)) => {
            Some("it changes the stiffness of a region of the deck that is not a property")
        }
        (Extension::Described { id, .. }, Some(_)) if !is_edit(job, id) => Some(
            "it is a table of strain, which no card of the deck describes: describe it as an `edit`",
        ),
        (
            Extension::NuisanceLoads {
                source: Nuisance::UniformTemperature,
                ..
            },
            Some(_),
        ) => Some(
            "it is the apparent strain of a uniform temperature, which no load of the deck describes: record the temperature in every run",
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
                "it is a temperature that varies with position, and the job names no temperature set",
            )
        }
        (Extension::Nothing, _) => Some("it is not an effect of the library"),
        _ => None,
    }
}

/// Returns whether the hypothesis is an edit of the deck.
fn is_edit(job: &Job, id: &str) -> bool {
    effect_of(job, id).is_some_and(|e| !matches!(e.source, EffectSource::Signature(_)))
}

/// Returns the extended model. If an effect can't be added, it returns `None`, with a finding for each such effect.
///
/// # Errors
/// A job that can't be read again.
pub(super) fn extend_model(
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
    let deck_bytes = match deck.map_or(DeckEditOutcome::Unchanged, |d| deck_with(job, d, outcome)) {
        DeckEditOutcome::Unchanged => None,
        DeckEditOutcome::Deck(bytes) => Some(bytes),
        DeckEditOutcome::Refused => {
            let ids: Vec<&str> = effects.iter().map(|e| e.id.as_str()).collect();
            let why = "the cards of the deck could not be edited (a property other than PSHELL or PBUSH, or files that do not match)";
            work.findings
                .push(effect_not_in_model(&ids.join(" + "), why));
            return Ok(None);
        }
    };
    let weights = match (deck, &deck_bytes) {
        (Some(d), Some(bytes)) => Some(weights_in(job, d, bytes, effects)?),
        (Some(_), None) => Some(Vec::new()),
        (None, _) => None,
    };
    let corrections = corrections(job, frame, effects, weights.as_deref());
    let scaled = |e: &&NamedEffect| matches!(e.extension, Extension::Scale(_));
    if let (None, Some(e), true) = (&corrections, effects.iter().find(scaled), deck.is_some()) {
        let why = "it is one factor on all strain: change the modulus in the deck, or the gains";
        work.findings.push(effect_not_in_model(&e.id, why));
        return Ok(None);
    }
    // The place of the payload is corrected in the model for all later runs, as far as the model can express it.
    let moved = payload_moved(frame, effects, deck.is_some());
    let is_moved = |e: &&NamedEffect| {
        matches!(e.extension, Extension::PayloadOffset { .. })
            && moved != PositionCorrection::InNotes
    };
    let others: Vec<NamedEffect> = effects.iter().filter(|e| !is_moved(e)).cloned().collect();
    let state = extended_state(frame, &others);
    let sensitivity = match deck {
        None => sensitivity_with(frame, outcome, &state, moved),
        Some(_) => None,
    };
    if sensitivity.is_some() && frame.learnt.is_some() {
        let ids: Vec<&str> = effects.iter().map(|e| e.id.as_str()).collect();
        let why = "S was calibrated without it, and the covariance of S does not include the change: calibrate again with the effect in the job";
        work.findings
            .push(effect_not_in_model(&ids.join(" + "), why));
        return Ok(None);
    }
    let noted = others.iter().any(|e| changes_notes(&e.extension));
    let (readings, corrections) = match corrections {
        Some(entries) => (None, entries),
        None => (
            corrected_readings(frame, effects)
                .map(|values| less_gains(values, frame, effects, weights.as_deref())),
            angle_corrections(effects, deck.is_some()),
        ),
    };
    Ok(Some(ExtendedModel {
        deck: deck_bytes,
        readings,
        corrections,
        sensitivity,
        runs: noted.then(|| runs_with(frame, &others, &state)),
        nominal_x_m: match moved {
            PositionCorrection::Origin { x_m } => Some(x_m),
            PositionCorrection::Not
            | PositionCorrection::Signature { .. }
            | PositionCorrection::InNotes => None,
        },
        ..ExtendedModel::from_job_text(JOB, text_of(work, job)?)
    }))
}

/// Returns the change of the weight strain of each named mass by the written deck.
fn weights_in(
    job: &Job,
    deck: &DeckFrame,
    written: &[u8],
    effects: &[NamedEffect],
) -> Result<Vec<Weight>, Faults> {
    let mut out = Vec::new();
    for e in effects {
        let Extension::Mass { place, .. } = &e.extension else {
            continue;
        };
        let id = job.reconcile.as_ref().and_then(|r| r.places.get(place));
        if let Some(id) = id
            && let Some(gains) = deck.weight_gains(job, written, *id)?
        {
            out.push((place.clone(), gains));
        }
    }
    Ok(out)
}

/// Returns the readings minus the change of the strain of the named masses' weights by the written deck.
fn less_gains(
    mut values: Vec<f64>,
    frame: &StrainFrame,
    effects: &[NamedEffect],
    weights: Option<&[Weight]>,
) -> Vec<f64> {
    for e in effects {
        let Extension::Mass { place, kilogram } = &e.extension else {
            continue;
        };
        let own = weights.iter().flat_map(|w| w.iter());
        for (_, gains) in own.filter(|w| w.0 == *place) {
            for row in values.chunks_exact_mut(frame.n_gauges().max(1)) {
                let cells = row.iter_mut().zip(gains);
                cells.for_each(|(cell, per_kg)| *cell -= kilogram * per_kg);
            }
        }
    }
    values
}

/// Place in the extended model in which the recorded position of the payload is corrected.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PositionCorrection {
    /// Nowhere.
    Not,
    /// In its signature, m: S is given.
    Signature { dx: f64, dy: f64 },
    /// By another nominal x, m, from which every run's x counts.
    Origin { x_m: f64 },
    /// In the recorded position of every run.
    InNotes,
}

fn payload_moved(
    frame: &StrainFrame,
    effects: &[NamedEffect],
    has_deck: bool,
) -> PositionCorrection {
    let offset = effects.iter().find_map(|e| match e.extension {
        Extension::PayloadOffset { dx, dy } => Some((dx, dy)),
        _ => None,
    });
    let noted = frame.payload.iter().any(|p| p[1] != 0.0);
    match offset {
        None => PositionCorrection::Not,
        Some((dx, dy)) if !has_deck => PositionCorrection::Signature { dx, dy },
        Some((dx, dy)) if dy == 0.0 && noted => PositionCorrection::Origin {
            x_m: frame.payload_origin[0] - dx,
        },
        Some(_) => PositionCorrection::InNotes,
    }
}

pub(super) fn effect_not_in_model(id: &str, why: &str) -> Finding {
    Finding::new(
        Severity::Warning,
        "effect-not-in-model",
        id,
        format!("no extended model is written, because this effect cannot be added to it: {why}"),
        "add it to the model by hand, then run `reconcile` again",
    )
}

/// Result of editing the deck.
enum DeckEditOutcome {
    /// The deck needs no change.
    Unchanged,
    /// Deck with the effects.
    Deck(Vec<u8>),
    /// The cards of the deck can't be edited.
    Refused,
}

/// Edits the deck to contain the effects that a deck can contain.
fn deck_with(job: &Job, deck: &DeckFrame, outcome: &Outcome) -> DeckEditOutcome {
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
            Extension::Described { id, size } => {
                stiffness.push((StiffnessOf::Described, id.clone(), *size))
            }
            Extension::Mass { place, kilogram } => masses.push((place.clone(), *kilogram)),
            _ => {}
        }
    }
    let side = side_loads(job, &outcome.effects);
    if stiffness.is_empty() && masses.is_empty() && side.is_empty() {
        return DeckEditOutcome::Unchanged;
    }
    deck.extend_deck(job, &stiffness, &masses, &side)
        .map_or(DeckEditOutcome::Refused, DeckEditOutcome::Deck)
}

/// Returns whether an effect changes the recorded data of runs.
fn changes_notes(e: &Extension) -> bool {
    use Extension::{LoadScale, PayloadOffset, RunExchange, RunRecord};
    matches!(
        e,
        PayloadOffset { .. } | LoadScale { .. } | RunExchange { .. } | RunRecord { .. }
    )
}

/// Returns the recorded loads and payload of the runs with `effects` in them; `state` contains the acting loads.
fn runs_with(frame: &StrainFrame, effects: &[NamedEffect], state: &StrainState) -> ExtendedRuns {
    let (n_l, n_c) = (frame.n_loads(), frame.n_columns().max(1));
    let rows = || state.columns.chunks_exact(n_c);
    // The payload columns are its mass times 1, x and y.
    let acting = |row: &[f64]| match row.get(n_l..n_l + 3) {
        Some([m, mx, my]) if *m > 0.0 => [*m, mx / m, my / m],
        _ => [0.0; 3],
    };
    let weighs = |e: &NamedEffect| matches!(e.extension, Extension::PayloadWeight);
    let acts = frame.payload_weight == PayloadWeight::InModel || effects.iter().any(weighs);
    ExtendedRuns {
        loads: rows()
            .flat_map(|row| row.iter().take(n_l))
            .copied()
            .collect(),
        payload: match acts {
            true => rows().map(acting).collect(),
            false => correct_recorded_payload(frame, effects),
        },
    }
}

/// Returns the payload of every run with identified errors of the records corrected. The condition is that the payload weight acts in no run and no
/// column contains it.
fn correct_recorded_payload(frame: &StrainFrame, effects: &[NamedEffect]) -> Vec<[f64; 3]> {
    let at = |run: &String| frame.observations.runs.iter().position(|r| r == run);
    let mut out = frame.payload.clone();
    for e in effects {
        match &e.extension {
            Extension::RunExchange { runs: [a, b] } => {
                if let (Some(a), Some(b)) = (at(a), at(b))
                    && a.max(b) < out.len()
                {
                    out.swap(a, b);
                }
            }
            Extension::RunRecord {
                run,
                noted: RecordedQuantity::Mass,
                size,
            } => {
                if let Some([mass, ..]) = at(run).and_then(|r| out.get_mut(r)) {
                    *mass += size;
                }
            }
            _ => {}
        }
    }
    out
}

/// Returns S with the effects and with the loads that were left out; `None` if S does not change.
fn sensitivity_with(
    frame: &StrainFrame,
    outcome: &Outcome,
    state: &StrainState,
    moved: PositionCorrection,
) -> Option<ExtendedS> {
    let left_out = nuisance(frame, &outcome.effects);
    let mut influence = state.influence.clone();
    if let PositionCorrection::Signature { dx, dy } = moved {
        let (n_c, n_l) = (frame.n_columns(), frame.n_loads());
        for row in influence.chunks_exact_mut(n_c.max(1)) {
            // strain per kg = b0 + x b_x + y b_y + x y b_xy at (x + dx, y + dy)
            if let Some([b0, b_x, b_y, b_xy]) = row.get_mut(n_l..n_l + N_PAYLOAD_COLUMNS) {
                *b0 += dx * *b_x + dy * *b_y + dx * dy * *b_xy;
                *b_x += dy * *b_xy;
                *b_y += dx * *b_xy;
            }
        }
    }
    let changed = influence != frame.influence;
    if !changed && left_out.is_empty() {
        return None;
    }
    let known = frame.nuisance.iter();
    Some(ExtendedS {
        influence,
        changed,
        known: known
            .map(|n| (n.name.clone(), n.per_unit.clone()))
            .collect(),
        left_out,
    })
}

/// Columns of loads that were left out, with their usual size in kN and kN m; degrees count as kN do.
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
            // A single load has the size that was found. Each of several loads has its usual size, or the largest size found if that is larger.
            let size = if loads.len() == 1 {
                found(k).unwrap_or(*usual)
            } else {
                usual.max(largest)
            };
            out.extend(pattern(name).map(|p| (name.clone(), p, size)));
        }
    }
    out
}
