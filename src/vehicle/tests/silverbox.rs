//! Silverbox: a measured circuit that behaves as mass, spring and damper (Wigren & Schoukens 2013).

use super::*;
use crate::series::channels::Channel;
use crate::series::detrend::rms;
use crate::vehicle::refine::{OPEN, comparison, refine};

const RATE_HZ: f64 = 610.35;
/// Number of samples used to identify. The remaining samples test the result.
const FITTED: usize = 20_000;

fn record() -> Option<(Channels, Channels)> {
    let bytes = crate::support::bytes("hidden_effects/real/silverbox_estimation.csv")?;
    let all = read_csv(&bytes, Some(RATE_HZ)).unwrap();
    let part = |from: usize, to: usize| {
        let channel = |name: &str, new: &str| Channel {
            name: new.into(),
            unit: "V".into(),
            samples: all.samples(name).unwrap()[from..to].to_vec(),
        };
        Channels::from_list(RATE_HZ, vec![channel("u_V", "u"), channel("y_V", "y")]).unwrap()
    };
    Some((part(0, FITTED), part(FITTED, all.n_samples())))
}

/// Returns the simulation error on the held-out samples in mV. The first 200 samples are left out, because the simulation starts at rest.
fn held_out_mv(terms: &[&str], fitted: &Channels, rest: &Channels) -> f64 {
    let q = task("oscillator", terms, (3.0, 200.0));
    let start = identify(&q, fitted, None).unwrap();
    let free: Vec<usize> = (0..start.values.len()).collect();
    let mut c = comparison(&q.vehicle, fitted, OPEN, &[]).unwrap();
    c.forget(200);
    let refined = refine(&q.vehicle, &start.values, &free, &c).unwrap();
    let mut judge = comparison(&q.vehicle, rest, OPEN, &[]).unwrap();
    judge.forget(200);
    let errors = judge
        .errors(&q.vehicle, &refined.values, &refined.constant)
        .unwrap();
    let e: Vec<f64> = errors[0]
        .1
        .iter()
        .copied()
        .filter(|v| v.is_finite())
        .collect();
    1000.0 * rms(&e)
}

/// Linear models of this circuit have an error of about 7 mV. A model with 37 parameters reaches 0.26 mV on its most difficult part.
#[test]
fn silverbox_is_explained_by_a_cubic_and_a_quadratic_spring() {
    let Some((fitted, rest)) = record() else {
        return;
    };
    let linear = held_out_mv(&["k", "c"], &fitted, &rest);
    assert!((5.0..9.0).contains(&linear), "{linear}");
    let nonlinear = held_out_mv(&["k", "c", "k2", "k3"], &fitted, &rest);
    assert!(nonlinear < 0.4, "{nonlinear}");
}
