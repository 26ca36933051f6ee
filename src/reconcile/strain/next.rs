//! The measurement that would separate two explanations.

use super::covariance::{Selection, covariance};
use super::explanation::Explanation;
use super::frame::StrainFrame;
use super::prediction::predict;
use crate::linalg::precision::Precision;

/// Possible additional run, as a description and as numbers.
struct Design {
    words: String,
    loads: Vec<f64>,
    payload: [f64; 3],
}

fn designs(frame: &StrainFrame) -> Vec<Design> {
    let n_l = frame.n_loads();
    let mut out = Vec::new();
    let heaviest = (0..frame.n_runs()).max_by(|&a, &b| {
        let mass = |r: usize| frame.payload.get(r).map_or(0.0, |p| p[0]);
        mass(a).total_cmp(&mass(b))
    });
    let Some(heaviest) = heaviest else { return out };
    let loads = frame.loads[heaviest * n_l..(heaviest + 1) * n_l].to_vec();
    let payload = frame.payload.get(heaviest).copied().unwrap_or([0.0; 3]);
    out.push(Design {
        words: "measure the empty truck again".into(),
        loads: vec![0.0; n_l],
        payload: [0.0, payload[1], payload[2]],
    });
    out.push(Design {
        words: format!(
            "measure twice the payload of the heaviest run ({:.0} kg) at the same place",
            2.0 * payload[0]
        ),
        loads: loads.iter().map(|f| 2.0 * f).collect(),
        payload: [2.0 * payload[0], payload[1], payload[2]],
    });
    /// A jack under a wheel changes its force by about this much, kN.
    const JACK_KN: f64 = 10.0;
    let forces = (0..n_l).filter(|l| !frame.is_moment(*l));
    for (l, name) in forces.filter_map(|l| Some((l, frame.load_names.get(l)?))) {
        let mut jacked = vec![0.0; n_l];
        jacked[l] = JACK_KN;
        out.push(Design {
            words: format!(
                "measure the empty truck with {name} raised by {JACK_KN:.0} kN on a jack"
            ),
            loads: jacked,
            payload: [0.0, payload[1], payload[2]],
        });
    }
    out
}

/// Returns the instruction. It is quantified if a run with other loads separates the effects, and otherwise the test of the first effect.
pub fn next_measurement(
    frame: &StrainFrame,
    first: &Explanation<'_>,
    second: &Explanation<'_>,
) -> String {
    /// Expected difference of log evidence from one run that is worth a run.
    const WORTH: f64 = 5.0;
    let own = || {
        let say = |e: &Explanation<'_>| e.members.first().map(|m| m.effect.separate_by(frame));
        say(first)
            .or_else(|| say(second))
            .unwrap_or_else(|| "none needed".into())
    };
    let mut best: Option<(f64, String)> = None;
    for design in designs(frame) {
        let mut trial = frame.clone();
        trial.observations.runs = vec!["next".into()];
        trial.observations.held_out = vec![false];
        trial.observations.values = vec![0.0; frame.n_gauges()];
        trial.loads = design.loads;
        trial.payload = vec![design.payload];
        let selection = Selection::of_runs(&trial, &[0]);
        let a = predict(&trial, &first.members);
        let b = predict(&trial, &second.members);
        let difference: Vec<f64> = a.iter().zip(&b).map(|(x, y)| x - y).collect();
        let power = |e: &Explanation<'_>| {
            let p = Precision::from_covariance(
                &covariance(&trial, &e.members, &selection, &e.unknown),
                selection.len(),
            )?;
            Some(
                0.5 * p
                    .apply(&difference)
                    .iter()
                    .zip(&difference)
                    .map(|(x, y)| x * y)
                    .sum::<f64>(),
            )
        };
        let worth = power(first)
            .unwrap_or(0.0)
            .min(power(second).unwrap_or(0.0));
        if worth > WORTH && best.as_ref().is_none_or(|b| worth > b.0) {
            best = Some((worth, design.words));
        }
    }
    match best {
        Some((worth, words)) => format!(
            "{words} (expected difference of log evidence: {worth:.0}); or {}",
            own()
        ),
        None => own(),
    }
}
