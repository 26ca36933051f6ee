//! Converts generated dynamic cases to frames for the search.

#![allow(dead_code)]

pub mod generator;
pub mod logger;

use generator::{Background, Case, Layout};
use std::collections::BTreeMap;
use strainbridge::reconcile::Verdict;
use strainbridge::reconcile::motion::{MotionFrame, MotionOutcome};
use strainbridge::series::channels::{Channel, Channels};
use strainbridge::series::spectrum::Band;
use strainbridge::units::UnitSystem;
use strainbridge::vehicle::preset::{PresetRequest, vehicle};
use strainbridge::vehicle::term::UnitNames;

/// Returns a record of channels with their samples.
pub fn record_of(rate_hz: f64, list: &[(String, Vec<f64>)]) -> Channels {
    let list = list
        .iter()
        .map(|(name, samples)| Channel {
            name: name.clone(),
            unit: String::new(),
            samples: samples.clone(),
        })
        .collect();
    Channels::from_list(rate_hz, list).unwrap()
}

/// Returns the frame that corresponds to a job of the case.
pub fn frame_of(case: &Case) -> MotionFrame {
    let model = match case.layout {
        Layout::Rear => "rear3",
        Layout::Pair => "front_pair",
        _ => "front2",
    };
    let request = PresetRequest {
        model: model.into(),
        terms: case.terms.clone(),
        ..PresetRequest::default()
    };
    let loose = case.background == Background::Messy;
    MotionFrame {
        vehicle: vehicle(&request).unwrap(),
        bodies: if model == "rear3" {
            vec![0, 1, 2]
        } else {
            vec![0, 1]
        },
        not_compared: vec![],
        known: BTreeMap::new(),
        data: record_of(case.rate_hz, &case.data),
        hold_out: Some(record_of(case.rate_hz, &case.hold_out)),
        band: Band {
            low_hz: 0.7,
            high_hz: 20.0,
        },
        gravity: generator::G,
        noise_acc: Some(case.noise[0]),
        noise_force: Some(case.noise[1]),
        gain_tolerance: if loose { 0.01 } else { 0.0 },
        sync_tolerance_s: if loose { 0.0004 } else { 0.0 },
        corrections: vec![],
        units: UnitNames::from_system(UnitSystem::MKgS),
        rules: Default::default(),
        stop: Default::default(),
    }
}

/// Comparison of an answer with the truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Score {
    Exact,
    /// The correct effect at another channel, which the answer reports as indistinguishable from the correct channel.
    Group,
    /// The correct effect at another channel only.
    Misplaced,
    Abstained,
    Missed,
    Partial,
    False,
}

/// Scores an answer by the rule of `score.py`: families and channels count, and `below-detectability` counts as none.
pub fn score(case: &Case, outcome: &MotionOutcome) -> Score {
    let mut named: Vec<String> = match outcome.verdict {
        Verdict::Named => outcome
            .effects
            .iter()
            .map(|e| e.id.split(':').next().unwrap_or("").to_owned())
            .collect(),
        Verdict::Unknown => vec!["unknown".into()],
        _ => vec!["none".into()],
    };
    named.dedup();
    if named == [case.truth.clone()] {
        at_place(case, outcome)
    } else if named == ["unknown"] {
        if case.truth == "none" {
            Score::False
        } else {
            Score::Abstained
        }
    } else if named == ["none"] {
        Score::Missed
    } else {
        Score::False
    }
}

/// Tests whether the channel is the correct one, or one of a group that is reported as a group.
fn at_place(case: &Case, outcome: &MotionOutcome) -> Score {
    let Some(channel) = &case.channel else {
        return Score::Exact;
    };
    let right = format!("{}:{channel}", case.truth);
    let in_group = |ids: &[String]| ids.contains(&right);
    if outcome.effects.iter().any(|e| e.id == right) {
        Score::Exact
    } else if outcome
        .rivals
        .iter()
        .any(|r| r.indistinguishable && in_group(&r.ids))
    {
        Score::Group
    } else {
        Score::Misplaced
    }
}
