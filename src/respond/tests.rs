//! Stress of known strain states, superposition, and the interval of a nonlinear quantity by sampling.

use super::*;
use crate::fe::{CaseResult, ShellField};
use crate::model::{Model, ShellIx};
use crate::sensitivity::{Load, LoadCaseOf};
use nastran::bdf::{MemoryLoader, read_deck};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// Returns a model of one square shell with E = 200000 and nu = 0.3.
fn model() -> Model {
    let text = "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\nCQUAD4,7,1,1,2,3,4\n\
                PSHELL,1,1,0.1,1\nMAT1,1,200000.,,0.3\nENDDATA\n";
    let deck = read_deck(
        "one.bdf",
        text.as_bytes().to_vec(),
        &mut MemoryLoader::default(),
    );
    Model::from_deck(&deck).0
}

fn case(bottom: [f64; 3], top: [f64; 3]) -> CaseResult {
    CaseResult {
        shells: ShellField {
            elements: Arc::new(vec![ShellIx(0)]),
            centre: vec![[bottom, top]],
            ..ShellField::default()
        },
        ..CaseResult::default()
    }
}

fn load<'a>(name: &str, applied: f64, case: &'a CaseResult) -> LoadCaseOf<'a> {
    LoadCaseOf {
        load: Load::from_name(name),
        applied,
        case,
    }
}

fn state(label: &str, values: &[f64], sigma: &[f64]) -> LoadState {
    LoadState {
        label: label.into(),
        values: values.to_vec(),
        spread: Spread::Sigma(sigma.to_vec()),
    }
}

#[test]
fn uniaxial_and_shear_strain_give_the_von_mises_stress_of_the_textbook() {
    let m = model();
    // 100 MPa along x: exx = 5e-4, eyy = -nu exx. Shear: G = E / 2(1 + nu), svm = sqrt(3) G g.
    let c = case([5e-4, -1.5e-4, 0.0], [0.0, 0.0, 1e-3]);
    let (rows, findings) = response_rows(&m, &[load("F", 1.0, &c)], |_| true);
    assert!(findings.is_empty());
    let peaks = envelope(&rows, &[state("a", &[1.0], &[0.1])]);
    assert!((peaks[0].von_mises - 100.0).abs() < 1e-9, "{peaks:?}");
    let shear = 3.0_f64.sqrt() * 200_000.0 / 2.6 * 1e-3;
    assert!((peaks[1].von_mises - shear).abs() < 1e-9, "{peaks:?}");
    // One load: the stress is as uncertain as the load.
    assert!((peaks[0].sigma - 10.0).abs() < 1e-9);
    assert_eq!(rows[0].surface_word(), "bottom");
}

#[test]
fn states_superpose_and_the_envelope_names_the_worst() {
    let m = model();
    let (a, b) = (
        case([4e-4, 1e-4, 2e-4], [0.0; 3]),
        case([-2e-4, 5e-4, -1e-4], [0.0; 3]),
    );
    // Loads of size 2 and -4 in their subcases.
    let loads = [load("A", 2.0, &a), load("B", -4.0, &b)];
    let (rows, _) = response_rows(&m, &loads, |_| true);
    let sum = case([4e-4 + 2e-4, 1e-4 - 5e-4, 2e-4 + 1e-4], [0.0; 3]);
    let (direct, _) = response_rows(&m, &[load("both", 1.0, &sum)], |_| true);
    let states = [
        state("r1", &[0.5, 0.5], &[0.0; 2]),
        state("r2", &[2.0, 4.0], &[0.0; 2]),
    ];
    let peak = envelope(&rows, &states)[0];
    let expected = envelope(&direct, &[state("one", &[1.0], &[0.0])])[0];
    assert_eq!(peak.at, 1);
    assert!((peak.von_mises - expected.von_mises).abs() < 1e-9 * expected.von_mises);
    let history = von_mises_history(&rows[0], &states);
    assert!((history[1].1 - peak.von_mises).abs() < 1e-9);
    assert_eq!(hot_spots(&m, &rows, &envelope(&rows, &states)), vec![0]);
}

#[test]
fn the_interval_of_the_stress_is_what_sampling_the_loads_gives() {
    let m = model();
    let (a, b) = (
        case([4e-4, 1e-4, 2e-4], [0.0; 3]),
        case([-2e-4, 5e-4, -1e-4], [0.0; 3]),
    );
    let loads = [load("A", 1.0, &a), load("B", 1.0, &b)];
    let (rows, _) = response_rows(&m, &loads, |_| true);
    // Correlated: 0.04, 0.06 sd, correlation -0.8.
    let c = [0.0016, -0.8 * 0.04 * 0.06, -0.8 * 0.04 * 0.06, 0.0036];
    let s = LoadState {
        label: "r".into(),
        values: vec![1.0, 1.5],
        spread: Spread::Covariance(c.to_vec()),
    };
    let peak = envelope(&rows, &[s])[0];
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let mut normal = || {
        let (u, v): (f64, f64) = (
            random.random_range(1e-12..1.0),
            random.random_range(0.0..1.0),
        );
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    };
    let n = 20_000;
    let values: Vec<f64> = (0..n)
        .map(|_| {
            let (z1, z2) = (normal(), normal());
            let f = [1.0 + 0.04 * z1, 1.5 + 0.06 * (-0.8 * z1 + 0.6 * z2)];
            envelope(&rows, &[state("x", &f, &[0.0; 2])])[0].von_mises
        })
        .collect();
    let mean = values.iter().sum::<f64>() / f64::from(n);
    let sd = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(n)).sqrt();
    assert!(
        (sd / peak.sigma - 1.0).abs() < 0.03,
        "{sd} against {}",
        peak.sigma
    );
}
