//! Comparable part of a record with a dead channel: the equations that the channel does not enter.

use super::channel_check::BrokenChannel;
use super::detection_limits::smallest_sizes;
use super::effect::library;
use super::fit::{Effort, fit};
use super::frame::MotionFrame;
use super::gap::{Proof, proof, proof_gap};
use super::noise::Background;
use super::outcome::MotionOutcome;
use super::scorer::MotionScorer;
use super::verdict::{broken_effect, gap_of, shares_left};
use super::{design::design, gap::fitted_gap};
use crate::reconcile::outcome::Verdict;
use crate::series::channels::Channels;

/// Returns the outcome of a record with dead channels, which are named; `None` if no channel is dead.
///
/// A dead channel has no equation. Parameters fitted to it do not describe a vehicle, and a share of an unmeasured quantity is not a number. The gaps
/// before and after are equal, since both use the equations without the channel. They are NaN if there are no such equations.
pub(super) fn outcome_of_dead(
    frame: &MotionFrame,
    broken: &[BrokenChannel],
    only: &[String],
) -> Option<MotionOutcome> {
    let dead: Vec<&str> = (broken.iter())
        .filter(|b| b.id == "dead_channel")
        .map(|b| b.channel.as_str())
        .collect();
    if dead.is_empty() {
        return None;
    }
    let sound = sound_part(frame, &dead);
    let first = design(
        &sound,
        &sound.vehicle,
        &sound.data,
        &sound.corrections,
        vec![],
    );
    let candidates = first.map_or(vec![], |d| library(&sound, &d, only));
    let none = Background::default();
    let null = fit(
        &sound,
        &candidates,
        &sound.data,
        vec![],
        None,
        &none,
        Effort::Settled,
    );
    let is_fitted = null.is_some();
    let gap = null.as_ref().and_then(|f| proof_gap(&sound, f));
    let fitted = null.as_ref().and_then(|f| fitted_gap(&sound, f));
    let judged_by = null.as_ref().map_or(Proof::Fitted, |f| proof(&sound, f));
    let chi2 = null.as_ref().map_or(f64::NAN, |f| f.reduced_chi2());
    let smallest = null.map_or(vec![], |f| {
        let mut scorer = MotionScorer {
            frame: &sound,
            candidates: &candidates,
            background: none,
            forms: vec![],
        };
        smallest_sizes(&mut scorer, &f)
    });
    let names: Vec<String> = dead.iter().map(|name| format!("`{name}`")).collect();
    let names = names.join(", ");
    let compared: Vec<String> = (gap.iter().flat_map(|g| &g.equations))
        .map(|e| format!("`{}`", e.name))
        .collect();
    let remains = match compared.as_slice() {
        [] if is_fitted => {
            format!(
                "The hold-out record does not contain the equations without {names}: no gap can be stated."
            )
        }
        [] => format!("No equation can be compared without {names}: no gap can be stated."),
        list => format!(
            "Gaps are stated for the equations without {names}: {}.",
            list.join(", ")
        ),
    };
    let effects: Vec<_> = broken.iter().map(broken_effect).collect();
    Some(MotionOutcome {
        verdict: Verdict::Named,
        best_attempt: effects.clone(),
        effects,
        covariance: vec![],
        corrections: frame.corrections.clone(),
        rivals: vec![],
        evidence: 0.0,
        decisive: frame.rules.decisive,
        gap: gap_of(&gap, &gap, judged_by),
        judged_by,
        before: gap.clone(),
        after: gap,
        reduced_chi2: [chi2; 2],
        left: shares_left(&fitted, &fitted),
        smallest,
        remains,
        next_measurement: format!("Repair {names} and drive again."),
    })
}

/// Returns the frame without the equations that dead channels enter. A dead wheel force counts as not measured.
fn sound_part(frame: &MotionFrame, dead: &[&str]) -> MotionFrame {
    let v = &frame.vehicle;
    let still: Vec<usize> = (v.sensors.iter())
        .filter(|s| dead.contains(&s.channel.as_str()))
        .map(|s| s.at.body)
        .collect();
    let tied = |body: usize| {
        still.contains(&body)
            || v.links.iter().any(|l| {
                let on = |b: usize| l.ends.iter().any(|e| e.1.body == b);
                on(body) && still.iter().any(|&b| on(b))
            })
    };
    let is_force = |name: &str| v.wheels.iter().any(|w| w.channel == name);
    let without = |record: &Channels| {
        let mut out = record.clone();
        out.list
            .retain(|c| !(dead.contains(&c.name.as_str()) && is_force(&c.name)));
        out
    };
    MotionFrame {
        not_compared: (frame.bodies.iter())
            .copied()
            .filter(|&b| tied(b))
            .chain(frame.not_compared.iter().copied())
            .collect(),
        data: without(&frame.data),
        hold_out: frame.hold_out.as_ref().map(without),
        ..frame.clone()
    }
}
