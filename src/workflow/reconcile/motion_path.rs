//! Motion: record and vehicle, verdict, extended job.

use super::added_motion::added_to_motion;
use super::answer::{
    AlternativeSummary, DetectableSize, EffectFound, GapFound, MotionPart, Reconciliation,
    ReducedChi2, Simulation, SizeFound, WheelMisfit, first_finite,
};
use super::extend::effect_not_in_model;
use super::extended_model::ExtendedModel;
use super::motion_findings::findings;
use super::motion_job;
use super::redirect::text_of;
use crate::finding::{Finding, Severity};
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::job::{Job, Vehicle as VehicleJob};
use crate::reconcile::Verdict;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::channel_check::broken_channels;
use crate::reconcile::motion::sits::gap_sits;
use crate::reconcile::motion::{MotionEffect, MotionFrame, MotionOutcome, examine, simulated_gap};
use crate::stop::Stop;
use crate::vehicle::identify::{Identification, IdentifyTask, identify};
use crate::vehicle::layout::Vehicle;
use crate::vehicle::motion::{Motion, Treatment, motion};
use crate::vehicle::preset::{NEXT, PresetRequest, add_next, vehicle};
use crate::vehicle::stretch::slow_stretches;
use crate::workflow::vehicle::{
    VehicleRecords, preset_request, read_vehicle, section_of, vehicle_fault,
};

/// Compares motion with the vehicle model and returns the answer of `reconcile`.
///
/// # Errors
/// Faults of the job and of its records.
pub(super) fn answer(job: &Job, work: &mut Work) -> Result<Reconciliation, Faults> {
    let section = section_of(job)?;
    let records = work.stage("read", |w| read_vehicle(w, job))?;
    let mut frame = frame(section, &records, work.cx.progress.stop());
    without_dead_hold_out(work, section, &mut frame);
    let frame = frame;
    let only = job
        .reconcile
        .as_ref()
        .and_then(|r| r.effects.clone())
        .unwrap_or_default();
    let outcome = work.stage("search", |_| examine(&frame, &only));
    work.go_on()?;
    let mut outcome =
        outcome.map_err(|e| Faults::from(vehicle_fault(job, &section.data.given, &e)))?;
    let found = work.stage("identify", |_| identify_vehicle(&records, &outcome));
    if let Some(wrong) = found.as_ref().and_then(Identification::wrong_input) {
        let is_error = wrong.severity == Severity::Error;
        if is_error && !is_identified(&wrong, &outcome) {
            outcome.refuse(&wrong);
        }
        if !is_error || outcome.verdict != Verdict::Named {
            work.findings.push(wrong);
        }
    }
    let outcome = outcome;
    let wheel_force = work.stage("wheel forces", |_| {
        wheel_forces(&records, &frame, &outcome, found.as_ref())
    });
    let identified = found.and_then(|f| compute_motion(&records, f));
    let named = outcome.verdict == Verdict::Named && is_repairable(&outcome);
    work.go_on()?;
    let simulation = named.then(|| work.stage("simulate", |_| simulated_gap(&frame, &outcome)));
    let simulation = simulation.map(|s| match s {
        Ok(found) => Simulation::Done(found.into()),
        Err(not_simulated) => Simulation::NotDone { not_simulated },
    });
    findings(work, &outcome);
    let can_state = motion_job::can_state(&outcome);
    let lost = outcome.effects.iter().filter(|e| is_lost(e));
    let why = "the true signal of the channel is unknown, and no correction restores it: repair it and drive again";
    let lost = lost.map(|e| effect_not_in_model(&e.id, why));
    work.findings.extend(lost);
    if named && !can_state {
        let ids: Vec<&str> = outcome.effects.iter().map(|e| e.id.as_str()).collect();
        let why = "a channel has several slips, low-pass filters or interference lines, and [vehicle] corrections contains one of each kind";
        work.findings
            .push(effect_not_in_model(&ids.join(" + "), why));
    }
    let extended_model = match named && can_state {
        true => Some(ExtendedModel::from_job_text(
            motion_job::JOB,
            text_of(work, job)?,
        )),
        false => None,
    };
    let added = added_to_motion(&frame, &outcome, extended_model.as_ref());
    let list = |effects: &[MotionEffect]| effects.iter().map(effect_found).collect();
    let [before, after] = outcome.reduced_chi2;
    let size = |s: &crate::reconcile::motion::outcome::MotionDetectionLimit| DetectableSize {
        id: s.id.clone(),
        size: s.size,
        unit: s.unit.clone(),
    };
    let sits = outcome.before.as_ref().map_or_else(Vec::new, gap_sits);
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
            held_out: None,
        }),
        remains: Some(outcome.remains.clone()),
        next_measurement: outcome.next_measurement.clone(),
        detectable: Some(outcome.smallest.iter().map(size).collect()),
        strain: None,
        motion: Some(MotionPart {
            sits: sits.first().map_or_else(
                || "no equation can be compared".to_owned(),
                |s| format!("the gap is largest in {}", s.words()),
            ),
            sits_at: sits,
            sits_after: outcome.after.as_ref().map_or_else(Vec::new, gap_sits),
            covariance: outcome.covariance.clone(),
            wheel_force,
            simulation,
            outcome,
            frame,
            identified,
        }),
        causes: None,
        added,
        extended_model,
        job: job.clone(),
    })
}

fn gap_found(outcome: &MotionOutcome) -> GapFound {
    let gap = &outcome.gap;
    GapFound {
        metric: format!(
            "RMS of the equations' residual / RMS of the measured quantity (wheel force, mass times acceleration), in band, \
             on {}, root mean square over equations",
            outcome.judged_by.words()
        ),
        before: gap.before,
        after: gap.after,
        floor: Some(gap.floor),
        explained_share: (!gap.before.is_nan()).then(|| gap.explained_share()),
        strain: None,
        judged_by: Some(outcome.judged_by),
    }
}

fn effect_found(e: &MotionEffect) -> EffectFound {
    EffectFound {
        id: e.id.clone(),
        place: e.place.clone(),
        size: Some(SizeFound {
            size: first_finite(&e.size),
            sigma: first_finite(&e.sigma),
            unit: e.unit.clone(),
            sizes: e.size.clone(),
            sigmas: e.sigma.clone(),
        }),
        plausible: e.plausible,
        channels: None,
    }
}

/// Leaves out a held-out record with a dead channel. The test of any model would depend on that channel alone.
fn without_dead_hold_out(work: &mut Work, section: &VehicleJob, frame: &mut MotionFrame) {
    let Some(record) = &frame.hold_out else {
        return;
    };
    let dead: Vec<String> = broken_channels(frame, record)
        .into_iter()
        .filter(|b| b.id == "dead_channel")
        .map(|b| format!("`{}`", b.channel))
        .collect();
    if dead.is_empty() {
        return;
    }
    frame.hold_out = None;
    let file = section.hold_out.as_ref().map_or("", |h| &h.given);
    work.findings.push(Finding::new(
        Severity::Warning,
        "no-hold-out",
        "vehicle.hold_out",
        format!(
            "`{file}` cannot serve as hold-out: {} has no signal there",
            dead.join(", ")
        ),
        "name a record in which every channel has a signal as `hold_out` in [vehicle]",
    ));
}

/// Returns whether the outcome identifies the wrong input as an effect of a channel, or has channels without a signal.
fn is_identified(wrong: &Finding, outcome: &MotionOutcome) -> bool {
    let of_channel = |e: &MotionEffect| match &e.change {
        Change::Flip { channel } => {
            wrong.code == "input-sign-reversed" && wrong.subject == *channel
        }
        Change::Swap { a, b } => {
            let pairs = [[a, b], [b, a]].map(|[x, y]| format!("{x}, {y}"));
            wrong.code == "inputs-exchanged" && pairs.contains(&wrong.subject)
        }
        _ => is_lost(e),
    };
    outcome.effects.iter().any(of_channel)
}

/// Returns whether a model can correct the effects. It can't correct a dead or saturated channel.
fn is_repairable(outcome: &MotionOutcome) -> bool {
    !outcome.effects.iter().any(is_lost)
}

/// Returns whether an effect is a channel without readings, or with readings that end at a stop.
fn is_lost(effect: &MotionEffect) -> bool {
    is_dead(effect) || effect.id.starts_with("saturated_channel")
}

fn is_dead(effect: &MotionEffect) -> bool {
    effect.id.starts_with("dead_channel")
}

/// Returns the frame of a job. One side of an axle is compared. The other side is a witness if it was measured.
fn frame(section: &VehicleJob, records: &VehicleRecords, stop: Stop) -> MotionFrame {
    let q = &records.task;
    let mut model = q.vehicle.clone();
    let recorded = |name: &str| {
        records.data.has(name) && records.hold_out.as_ref().is_none_or(|h| h.has(name))
    };
    let witnessed = ["a_body_other", "a_wheel_other"]
        .iter()
        .all(|c| recorded(section.columns.get(*c).map_or(*c, String::as_str)));
    if section.model == "front2" && witnessed {
        let request = PresetRequest {
            model: "front_pair".into(),
            ..preset_request(section)
        };
        if let Ok(pair) = vehicle(&request) {
            model = Vehicle {
                steps: model.steps.clone(),
                ..pair
            };
        }
    }
    let bodies = if model.name == "front_pair" {
        vec![0, 1]
    } else {
        (0..model.bodies.len())
            .filter(|&b| !model.is_witness(b))
            .collect()
    };
    let next = section.columns.get(NEXT).map_or(NEXT, String::as_str);
    if recorded(next) {
        add_next(&mut model, next);
    }
    MotionFrame {
        bodies,
        vehicle: model,
        not_compared: vec![],
        known: q.known.clone(),
        data: records.data.clone(),
        hold_out: records.hold_out.clone(),
        band: q.band,
        gravity: q.gravity,
        noise_acc: section.noise_acc,
        noise_force: section.noise_force,
        gain_tolerance: q.gain_tolerance,
        sync_tolerance_s: q.sync_tolerance_s,
        corrections: q.corrections.clone(),
        units: q.units.clone(),
        rules: Default::default(),
        stop,
    }
}

/// The analyst's vehicle as identified, with its motion over the fitted record.
fn compute_motion(
    records: &VehicleRecords,
    found: Identification,
) -> Option<(Identification, Motion)> {
    let q = &records.task;
    let slow = slow_stretches(&found.vehicle, &found.values, &records.data, &q.corrections);
    let treatment = Treatment {
        adjust: q.corrections.clone(),
        slow,
        ..Treatment::from_band(q.band)
    };
    let moved = motion(&found.vehicle, &records.data, &treatment).ok()?;
    Some((found, moved))
}

/// Identifies the analyst's vehicle. Returns `None` if a channel has no signal, because the vehicle would be fitted to it.
fn identify_vehicle(records: &VehicleRecords, outcome: &MotionOutcome) -> Option<Identification> {
    let is_dead = outcome.effects.iter().any(is_dead);
    let found = || identify(&records.task, &records.data, records.hold_out.as_ref()).ok();
    (!is_dead).then(found).flatten()
}

/// Returns the misfit of each measured wheel force on held-out data after `identify`, without and with the effects.
fn wheel_forces(
    records: &VehicleRecords,
    frame: &MotionFrame,
    outcome: &MotionOutcome,
    found: Option<&Identification>,
) -> Vec<WheelMisfit> {
    let identified = |q: &IdentifyTask| identify(q, &records.data, records.hold_out.as_ref()).ok();
    let misfits = |id: &Identification| -> Vec<(String, f64)> {
        id.fit
            .iter()
            .filter(|f| id.vehicle.wheels.iter().any(|w| w.channel == f.channel))
            .map(|f| (f.channel.clone(), f.relative_rms))
            .collect()
    };
    let before = found.map(misfits).unwrap_or_default();
    let after = (outcome.verdict == Verdict::Named && is_repairable(outcome)).then(|| {
        let q = IdentifyTask {
            vehicle: outcome
                .after
                .as_ref()
                .map_or_else(|| frame.vehicle.clone(), |g| g.vehicle.clone()),
            corrections: outcome.corrections.clone(),
            ..records.task.clone()
        };
        identified(&q).as_ref().map(misfits).unwrap_or_default()
    });
    let list = before.into_iter().map(|(channel, before)| WheelMisfit {
        after: after
            .as_ref()
            .and_then(|a| a.iter().find(|x| x.0 == channel).map(|x| x.1)),
        before,
        channel,
    });
    list.collect()
}
