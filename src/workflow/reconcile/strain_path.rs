//! Strain: frame, verdict, extended model.

use super::answer::{
    AlternativeSummary, DetectableSize, EffectFound, GapFound, Reconciliation, ReducedChi2,
    SizeFound, StrainGap, StrainPart, first_finite,
};
use super::deck_frame::{self, DeckFrame};
use super::described_effects::effect_of;
use super::local_stiffness::gauges_that_disagree;
use super::model_changes::added_to_strain;
use super::readings::observations;
use super::run_frame::frame;
use super::stiffness::factor;
use super::strain_findings::{far_above_readings, findings};
use super::{causes, described_effects, extend, matrix_frame};
use crate::finding::Finding;
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::{EffectSource, Job};
use crate::reconcile::effect::{Correction, Extension};
use crate::reconcile::strain::{
    StiffnessOf, StrainFrame, examine, gauges_installed_otherwise, outcome_of_wrong_inputs, predict,
};
use crate::reconcile::{GapBasis, NamedEffect, Outcome, Verdict};

/// Compares the strain of the runs with the model, or with the causes, and returns the answer of `reconcile`.
///
/// # Errors
/// Faults of the job and of the files it names.
pub(super) fn answer(job: &Job, work: &mut Work) -> Result<Reconciliation, Faults> {
    let observations = observations(job, work)?;
    let channels = observations.channels.clone();
    if let (Some(r), None, None) = (&job.reconcile, &job.sensitivity, &job.model)
        && !r.causes.is_empty()
    {
        return causes::answer(job, r, work, &observations);
    }
    let (part, mut deck) = match (&job.sensitivity, &job.model) {
        (Some(given), _) => {
            let read = |w: &mut Work| matrix_frame::read(w, job, given, &channels);
            (work.stage("signatures", read)?, None)
        }
        (None, Some(_)) => {
            let (part, deck) = deck_frame::read(work, job, &channels)?;
            (part, Some(deck))
        }
        (None, None) => {
            return Err(Faults::from(Fault::new(
                &*job.file,
                "model",
                "the job has neither `[model]` nor `[sensitivity]`",
                "name the deck, or the CSV file with S",
            )));
        }
    };
    let mut frame = frame(job, work, observations, part)?;
    work.go_on()?;
    let only = job
        .reconcile
        .as_ref()
        .and_then(|r| r.effects.clone())
        .unwrap_or_default();
    let mut wrong = take_readings_of_noise(work);
    wrong.extend(match &mut deck {
        Some(deck) if wrong.is_empty() => {
            let mut alternatives = || std::mem::take(&mut deck.alternatives);
            gauges_installed_otherwise(&frame, &mut alternatives)
        }
        _ => Vec::new(),
    });
    if !wrong.is_empty() {
        deck = None;
    }
    let mut outcome = match wrong.is_empty() {
        true => search_effects(work, &frame, &only)?,
        false => work.stage("search", |_| outcome_of_wrong_inputs(&frame, wrong)),
    };
    if let Some(deck) = &mut deck {
        let off = gauges_that_disagree(&outcome);
        if !off.is_empty() {
            let found = work.stage("solve regions", |_| deck.regions_round(job, &frame, &off))?;
            work.go_on()?;
            if !found.is_empty() {
                frame.stiffness.extend(found);
                outcome = search_effects(work, &frame, &only)?;
            }
        }
    }
    if let Some(deck) = &deck {
        // The model is solved again at the size of stiffness that was found, until the size is constant.
        for _ in 0..RESOLVED {
            if !resolve_stiffness(job, work, deck, &mut frame, &outcome)? {
                break;
            }
            work.go_on()?;
            outcome = search_effects(work, &frame, &only)?;
        }
    }
    if let Some(far) = far_above_readings(&outcome) {
        outcome = outcome_of_wrong_inputs(&frame, vec![far]);
    }
    findings(work, &outcome);
    let extended_model = match outcome.verdict {
        Verdict::Named => extend::extend_model(job, work, &frame, &outcome, deck.as_ref())?,
        _ => None,
    };
    let added = added_to_strain(
        job,
        &frame,
        &outcome.effects,
        extended_model.as_ref(),
        deck.as_ref(),
    );
    let list = |effects: &[NamedEffect]| effects.iter().map(effect_found).collect();
    let [before, after, held_out] = outcome.reduced_chi2;
    let size = |d: &crate::reconcile::DetectionLimit| DetectableSize {
        id: d.id.clone(),
        size: d.size,
        unit: d.unit.to_owned(),
    };
    Ok(Reconciliation {
        verdict: outcome.verdict,
        named: outcome.effects.iter().map(|e| e.id.clone()).collect(),
        effects: list(&outcome.effects),
        best_attempt: Some(list(&outcome.best_attempt)),
        rivals: outcome
            .rivals
            .iter()
            .map(AlternativeSummary::from)
            .collect(),
        gap: gap_found(&outcome),
        evidence: Some(outcome.evidence),
        reduced_chi2: Some(ReducedChi2 {
            before,
            after,
            held_out: (outcome.gap.basis == GapBasis::HeldOut).then_some(held_out),
        }),
        remains: Some(outcome.remains.clone()),
        next_measurement: outcome.next_measurement.clone(),
        detectable: Some(outcome.detectable.iter().map(size).collect()),
        strain: Some(strain_part(job, frame, outcome, deck)),
        motion: None,
        causes: None,
        added,
        extended_model,
        job: job.clone(),
    })
}

/// Reads the data of the comparison as [`answer`] does, without solving a model.
///
/// # Errors
/// Faults of the job and of the files it names.
pub(super) fn check_inputs(job: &Job, work: &mut Work) -> Result<(), Faults> {
    let observations = observations(job, work)?;
    let channels = observations.channels.clone();
    match (&job.sensitivity, &job.model) {
        (Some(given), _) => {
            let part = matrix_frame::read(work, job, given, &channels)?;
            frame(job, work, observations, part).map(|_| ())
        }
        (None, Some(_)) => {
            let columns = deck_frame::per_job_unit(job);
            described_effects::check_inputs(&mut work.inputs, job, &channels, &columns)
        }
        (None, None) => Ok(()),
    }
}

/// Takes the error that all readings are below the noise out of the findings. No effect can be found in such readings.
fn take_readings_of_noise(work: &mut Work) -> Vec<Finding> {
    let (of_noise, others) = std::mem::take(&mut work.findings)
        .into_iter()
        .partition(|f| f.code == "readings-below-noise");
    work.findings = others;
    of_noise
}

/// Searches the effects and returns the verdict on the frame.
///
/// # Errors
/// One fault if the work is stopped before the search is complete.
fn search_effects(
    work: &mut Work,
    frame: &StrainFrame,
    only: &[String],
) -> Result<Outcome, Faults> {
    let outcome = work.stage("search", |_| examine(frame, only));
    work.go_on()?;
    Ok(outcome)
}

fn strain_part(
    job: &Job,
    frame: StrainFrame,
    outcome: Outcome,
    deck: Option<DeckFrame>,
) -> StrainPart {
    let marked = deck
        .as_ref()
        .map(|d| d.mark_stiffnesses(job, &outcome.best_attempt));
    let n = outcome.covariance.len().isqrt().max(1);
    StrainPart {
        wins_of_100: outcome.wins,
        noise_factor: outcome.noise_factor,
        smooth: outcome.smooth.clone(),
        covariance: outcome.covariance.chunks(n).map(<[f64]>::to_vec).collect(),
        sits: outcome.sits.clone(),
        gauges_off_before: outcome.gauges_off_before.clone(),
        gauges_off: outcome.gauges_off.clone(),
        runs_off: outcome.runs_off.clone(),
        predicted: predict(&frame, &[]),
        predicted_after: outcome.predicted.clone(),
        outcome,
        frame,
        fields: deck.map(|d| d.fields),
        marked: marked.unwrap_or_default(),
    }
}

fn gap_found(outcome: &Outcome) -> GapFound {
    let gap = &outcome.gap;
    GapFound {
        metric: "RMS(reading - model) / RMS(reading). Amplitudes that differ from run to run are estimated from one half of the gauges and tested \
         on the other half. Before, after and floor use the same other parameters"
            .to_owned(),
        before: gap.before,
        after: gap.after,
        floor: Some(gap.floor),
        explained_share: Some(gap.explained_share()),
        strain: Some(StrainGap {
            basis: gap.basis.words(),
            mesh: gap.mesh,
            loads_found: gap.loads_found,
        }),
        judged_by: None,
    }
}

fn effect_found(e: &NamedEffect) -> EffectFound {
    EffectFound {
        id: e.id.clone(),
        place: e.place.clone(),
        size: Some(SizeFound {
            size: first_finite(&e.size).or(channel_size(e)),
            sigma: first_finite(&e.sigma),
            unit: e.unit.to_owned(),
            sizes: e.size.clone(),
            sigmas: e.sigma.clone(),
        }),
        plausible: e.plausible,
        channels: None,
    }
}

/// Returns the size of an effect without a parameter: -1 for reversed polarity, 0 for a channel without signal, 1 for an exchange.
fn channel_size(e: &NamedEffect) -> Option<f64> {
    let Extension::Channels(list) = &e.extension else {
        return None;
    };
    match &list.first()?.1 {
        Correction::Sign => Some(-1.0),
        Correction::Ignore => Some(0.0),
        _ => Some(1.0),
    }
}

/// Returns whether the changed stiffness is a thickness.
fn is_thickness(job: &Job, of: StiffnessOf, place: &str) -> bool {
    match of {
        StiffnessOf::Zone => true,
        StiffnessOf::Joint | StiffnessOf::Local => false,
        StiffnessOf::Described => effect_of(job, place)
            .is_some_and(|e| matches!(e.source, EffectSource::Thickness { .. })),
    }
}

/// Solutions at a size that was found: the second is at the size to a few thousandths.
const RESOLVED: usize = 2;

/// Adds the solution at the found size to the signature of a named stiffness. Returns `false` if there is nothing new to solve.
fn resolve_stiffness(
    job: &Job,
    work: &mut Work,
    deck: &DeckFrame,
    frame: &mut StrainFrame,
    outcome: &Outcome,
) -> Result<bool, Faults> {
    /// Share of stiffness: nearer to a known size the interpolation is exact.
    const NEAR: f64 = 0.01;
    /// A thickness can't be taken away.
    const LEAST: f64 = 0.2;
    let mut added = false;
    for e in outcome.best_attempt.iter().chain(&outcome.replaced) {
        let (of, place, percent) = match &e.extension {
            Extension::ZoneStiffness { place, percent } => (StiffnessOf::Zone, place, percent),
            Extension::JointStiffness { place, percent } => (StiffnessOf::Joint, place, percent),
            Extension::LocalStiffness { place, percent } => (StiffnessOf::Local, place, percent),
            Extension::Described { id, size } => (StiffnessOf::Described, id, size),
            _ => continue,
        };
        let Some(now) = factor(job, of, place, *percent) else {
            continue;
        };
        let Some(signature) = frame
            .stiffness
            .iter_mut()
            .find(|s| s.of == of && s.place == *place)
        else {
            continue;
        };
        let mut known = signature.at_percent.iter().map(|p| p.0).chain([0.0]);
        let near = known.any(|size| {
            factor(job, of, place, size).is_some_and(|then| (now / then - 1.0).abs() < NEAR)
        });
        if near || now.is_nan() || now < LEAST && is_thickness(job, of, place) {
            continue;
        }
        let change = work.stage("solve zones", |_| {
            deck.stiffness_change(job, of, place, *percent)
        })?;
        signature.at_percent.push((*percent, change));
        signature.at_percent.sort_by(|a, b| a.0.total_cmp(&b.0));
        added = true;
    }
    Ok(added)
}
