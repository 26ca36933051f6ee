//! One planted fault: a sign or a unit of known loads, a gauge with reversed polarity, two exchanged gauges.

use super::severe;
use crate::calibrate::*;
use crate::finding::Severity;
use crate::linalg::Matrix;
use crate::sensitivity::Load;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const NOISE: f64 = 1e-6;

/// Microstrain per unit of vertical and axial force and of torque: pairs above and below a plate, four of them at 45 degrees.
const PLATE: [[f64; 3]; 8] = [
    [-2.5, 0.0048, 0.0],
    [2.5, 0.0048, 0.0],
    [-1.36, 0.0048, 0.0],
    [1.36, 0.0048, 0.0],
    [-0.6, 0.0017, -0.00186],
    [0.65, 0.0017, 0.00186],
    [-0.4, 0.0017, 0.00186],
    [0.35, 0.0017, -0.00186],
];

const LOADS: [[f64; 3]; 8] = [
    [100.0, 0.0, 0.0],
    [0.0, 10_000.0, 0.0],
    [0.0, 0.0, 20_000.0],
    [100.0, 10_000.0, 0.0],
    [50.0, -5_000.0, 10_000.0],
    [-80.0, 3_000.0, -15_000.0],
    [60.0, 8_000.0, 12_000.0],
    [120.0, -2_000.0, 5_000.0],
];

/// Returns every loading `times` times on the plate. Its rows have an error of 2 % that is common to a gauge.
fn task(times: usize, seed: u64) -> Task {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || {
        let u: f64 = random.random_range(1e-12..1.0);
        let v: f64 = random.random_range(0.0..1.0);
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    };
    let gains: Vec<f64> = PLATE.iter().map(|_| 1.0 + 0.02 * normal()).collect();
    let runs = (0..LOADS.len() * times).map(|i| {
        let f = LOADS[i / times];
        let strain = PLATE.iter().zip(&gains).map(|(row, gain)| {
            let clean: f64 = row.iter().zip(f).map(|(s, f)| s * f).sum();
            1e-6 * gain * clean + NOISE * normal()
        });
        KnownRun {
            run: format!("R{}", i + 1),
            strain: strain.collect(),
            noise_factor: 1.0,
            loads: KnownLoads::from_exact(f.to_vec()),
            group: i / times,
        }
    });
    Task {
        gauges: (0..PLATE.len()).map(|g| format!("G{g}")).collect(),
        loads: ["FZ", "FX", "MX"].map(Load::from_name).to_vec(),
        noise: NOISE,
        model: Some(ModelPrior {
            values: Matrix::from_fn(PLATE.len(), 3, |g, l| 1e-6 * PLATE[g][l]),
            moves: Vec::new(),
            off_drawing: None,
            uncertainty_rel: 0.1,
        }),
        runs: runs.collect(),
        sums: vec![vec![1.0; 3]],
        common_zero: CommonZero::None,
        scale_sd: 0.0,
        gauge_noise: None,
    }
}

#[test]
fn a_clean_calibration_reports_no_fault_of_runs_and_gauges() {
    for seed in 0..20 {
        for times in [1, 3] {
            let c = calibrate(&task(times, seed)).unwrap();
            let loud = c.findings.iter().filter(|f| f.severity != Severity::Info);
            assert_eq!(loud.count(), 0, "seed {seed}: {:?}", c.findings);
            assert!(c.shifts.iter().all(|s| s.word == ShiftWord::None));
        }
    }
}

#[test]
fn a_run_whose_load_has_the_wrong_sign_is_named_and_not_used() {
    for times in [1, 3] {
        for wrong in [0, 5 * times] {
            let mut task = task(times, 3);
            for f in &mut task.runs[wrong].loads.mean {
                *f = -*f;
            }
            let c = calibrate(&task).unwrap();
            assert_eq!(c.refused, [wrong], "{:?}", c.findings);
            let named = severe(&c, "run-contradicts").map(|f| f.1);
            assert_eq!(named, Some(task.runs[wrong].run.clone()));
            // Without this run, noise explains the residuals.
            assert_eq!(c.repeat_scatter_rel, None);
        }
    }
}

#[test]
fn known_loads_in_another_unit_are_an_error_that_asks_for_the_unit() {
    for times in [1, 3] {
        for factors in [
            [1e-3, 1e-3, 1e-6],
            [1e3, 1e3, 1e6],
            [1.0, 1.0, 1e-3],
            [4.448, 4.448, 4.448],
            [101.97, 101.97, 101.97],
            [1.0 / 9.81, 1.0, 1.0],
        ] {
            let mut task = task(times, 4);
            for run in &mut task.runs {
                for (f, c) in run.loads.mean.iter_mut().zip(factors) {
                    *f *= c;
                }
            }
            let c = calibrate(&task).unwrap();
            let (severity, subject) = severe(&c, "input-unit").expect("a finding");
            assert_eq!(severity, Severity::Error);
            for (load, factor) in task.loads.iter().zip(factors) {
                let named = subject == "all" || subject.split(", ").any(|n| n == load.name);
                assert_eq!(named, factor != 1.0, "{factors:?}: {subject}");
            }
            assert_eq!(severe(&c, "input-sign-reversed"), None);
        }
    }
}

#[test]
fn a_load_whose_sign_is_turned_in_all_runs_is_an_error_that_asks_for_the_sign() {
    let mut task = task(3, 5);
    for run in &mut task.runs {
        run.loads.mean[0] *= -1.0;
    }
    let c = calibrate(&task).unwrap();
    let wanted = Some((Severity::Error, "FZ".to_owned()));
    assert_eq!(
        severe(&c, "input-sign-reversed"),
        wanted,
        "{:?}",
        c.findings
    );
    assert_eq!(severe(&c, "input-unit"), None);
}

#[test]
fn strain_that_known_loads_do_not_explain_at_all_is_an_error() {
    // The strain of the runs is random and does not depend on the loads.
    let mut wrong = task(3, 6);
    wrong.model = None;
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for run in &mut wrong.runs {
        run.strain.fill_with(|| random.random_range(-3e-4..3e-4));
    }
    let c = calibrate(&wrong).unwrap();
    let severity = severe(&c, "repeat-scatter").map(|f| f.0);
    assert_eq!(severity, Some(Severity::Error), "{:?}", c.findings);
}

#[test]
fn gauges_with_reversed_sign_are_named_and_no_others() {
    for wrong in [vec![2], vec![0], vec![7], vec![0, 3], vec![2, 5, 6]] {
        let mut task = task(1, 7);
        for run in &mut task.runs {
            wrong.iter().for_each(|g| run.strain[*g] *= -1.0);
        }
        let c = calibrate(&task).unwrap();
        for (g, s) in c.shifts.iter().enumerate() {
            let wanted = match wrong.contains(&g) {
                true => ShiftWord::Sign,
                false => ShiftWord::None,
            };
            assert_eq!(s.word, wanted, "{wrong:?}: {s:?}");
        }
        let found = c
            .findings
            .iter()
            .filter(|f| f.code == "input-sign-reversed");
        let named: Vec<_> = found.map(|f| (f.severity, f.subject.clone())).collect();
        let gauges = wrong.iter().map(|g| (Severity::Warning, format!("G{g}")));
        assert_eq!(named, gauges.collect::<Vec<_>>());
    }
}

#[test]
fn two_exchanged_gauges_are_named_and_no_others() {
    for (a, b) in [(0, 1), (4, 6), (1, 5), (2, 7)] {
        let mut task = task(1, 8);
        for run in &mut task.runs {
            run.strain.swap(a, b);
        }
        let c = calibrate(&task).unwrap();
        for (g, s) in c.shifts.iter().enumerate() {
            let wanted = match g {
                _ if g == a => ShiftWord::Exchanged { with: b },
                _ if g == b => ShiftWord::Exchanged { with: a },
                _ => ShiftWord::None,
            };
            assert_eq!(s.word, wanted, "{a} {b}: {s:?}");
        }
        let subject = severe(&c, "inputs-exchanged");
        assert_eq!(subject, Some((Severity::Warning, format!("G{a}, G{b}"))));
    }
}

#[test]
fn a_gauge_whose_gain_is_off_is_tested_by_the_error_of_the_others() {
    let mut task = task(1, 9);
    for run in &mut task.runs {
        run.strain[2] *= 1.8;
    }
    let c = calibrate(&task).unwrap();
    for (g, s) in c.shifts.iter().enumerate() {
        let wanted = match g {
            2 => ShiftWord::Gain,
            _ => ShiftWord::None,
        };
        assert_eq!(s.word, wanted, "{s:?}");
    }
}

#[test]
fn a_model_of_a_third_of_the_strain_is_put_right_by_the_runs_and_not_refused() {
    let mut task = task(3, 10);
    if let Some(model) = &mut task.model {
        model.values /= 3.0;
    }
    let c = calibrate(&task).unwrap();
    assert_eq!(severe(&c, "input-unit"), None, "{:?}", c.findings);
}

#[test]
fn a_gauge_with_reversed_sign_does_not_change_the_error_of_the_other_rows() {
    // The torque acts in no run, so that only the prior determines its column.
    let mut wired = task(1, 11);
    wired.runs.truncate(2);
    let wrong = 1;
    wired
        .runs
        .iter_mut()
        .for_each(|r| r.strain[wrong] = -r.strain[wrong]);
    let mut without = wired.clone();
    without.gauges.remove(wrong);
    without.runs.iter_mut().for_each(|r| {
        r.strain.remove(wrong);
    });
    if let Some(model) = &mut without.model {
        model.values = model.values.clone().remove_row(wrong);
    }
    let (all, rest) = (calibrate(&wired).unwrap(), calibrate(&without).unwrap());
    assert_eq!(all.shifts[wrong].word, ShiftWord::Sign);
    let torque = |c: &Calibration, g: usize| {
        let order = c.sensitivity.gauges.len() * 3;
        let at = g * 3 + 2;
        let known = c.sensitivity.uncertainty.as_ref().unwrap();
        known.covariance[at * order + at].sqrt()
    };
    for (g, of_all) in [(4, 5), (5, 6), (6, 7)].map(|(r, a)| (r, torque(&all, a))) {
        let ratio = of_all / torque(&rest, g);
        // The tried errors differ by a factor of the square root of two.
        assert!((0.85..1.18).contains(&ratio), "{g}: {ratio}");
    }
}
