//! Assumptions of the strain model: proportional to the loads, through zero, known loads with independent errors, runs that repeat.

use super::installed_position::draw_normal;
use super::repeats::{lanes, recover_with_intervals, task};
use super::severe;
use crate::calibrate::*;
use crate::finding::Severity;
use crate::linalg::Matrix;
use crate::recovery::{ErrorModel, Readings, recover};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const NOISE: f64 = 0.1e-6;

/// Returns runs of two loads from 20 to 100 kN. Strain is `S f (1 + bend (f_0 + f_1)) + zero` plus noise.
fn runs(
    s: &Matrix,
    count: usize,
    (zero, bend): (&[f64], f64),
    random: &mut ChaCha8Rng,
) -> Vec<KnownRun> {
    let one = |i: usize| {
        let f = [0; 2].map(|_| random.random_range(20.0..100.0));
        let factor = 1.0 + bend * (f[0] + f[1]);
        let strain = s.row_iter().zip(zero).map(|(row, z)| {
            factor * (row[0] * f[0] + row[1] * f[1]) + z + NOISE * draw_normal(random)
        });
        KnownRun {
            run: format!("R{i}"),
            strain: strain.collect(),
            noise_factor: 1.0,
            loads: KnownLoads::from_exact(f.to_vec()),
            group: i,
        }
    };
    (0..count).map(one).collect()
}

fn chances(found: &Calibration) -> Vec<(&'static str, f64)> {
    let tests = found.lack_of_fit.tests.iter();
    tests.map(|t| (t.term.name(), t.p)).collect()
}

/// The zero is 20 times the noise, so that a straight line through zero leaves it. The intercept is the planted zero to four standard errors. The
/// standard error is the error of a mean of several runs, in the middle of which the line is known.
#[test]
fn a_common_zero_is_found_and_an_intercept_is_what_it_was() {
    let mut random = ChaCha8Rng::seed_from_u64(43);
    let s = lanes(&mut random);
    let zero: Vec<f64> = s
        .row_iter()
        .map(|_| 20.0 * NOISE * draw_normal(&mut random))
        .collect();
    let mut all = runs(&s, 40, (&zero, 0.0), &mut random);
    let new = all.split_off(16);
    let linear = calibrate(&task(2, all.clone(), None)).unwrap();
    assert_eq!(severe(&linear, "common-zero").unwrap().0, Severity::Warning);
    assert!(linear.common_zero.is_empty());
    let h = linear.lack_of_fit.held_out.unwrap();
    assert!(h.intercept < 0.5 * h.linear, "{h:?}");
    assert_eq!(linear.lack_of_fit.recommends_intercept(), Some(true));
    let sought = Task {
        common_zero: CommonZero::Sought,
        ..task(2, all, None)
    };
    let found = calibrate(&sought).unwrap();
    assert!(
        found.findings.iter().all(|f| f.severity == Severity::Info),
        "{:?}",
        found.findings
    );
    for (a, b) in found.common_zero.iter().zip(&zero) {
        assert!((a - b).abs() < 8.0 * NOISE, "{a} {b}");
    }
    // Intervals of new runs contain the loads with either model, and are far narrower with the right one.
    let mut halves = [0.0; 2];
    let mut held = [0, 0];
    for run in &new {
        let net: Vec<f64> = run
            .strain
            .iter()
            .zip(&found.common_zero)
            .map(|(y, z)| y - z)
            .collect();
        for (i, (s, strain)) in [
            (&linear.sensitivity, run.strain.clone()),
            (&found.sensitivity, net),
        ]
        .into_iter()
        .enumerate()
        {
            for (found, known) in recover_with_intervals(s, strain, NOISE)
                .iter()
                .zip(&run.loads.mean)
            {
                halves[i] += found[2];
                held[i] += usize::from((found[0] - known).abs() <= found[2]);
            }
        }
    }
    // Of 48 intervals of 95 %, 41 or fewer contain the load once in a hundred times.
    assert!(held.iter().all(|h| *h > 41), "{held:?}");
    assert!(halves[1] < 0.5 * halves[0], "{halves:?}");
}

#[test]
fn strain_that_bends_is_reported_and_a_straight_line_is_not() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let s = lanes(&mut random);
    let none = vec![0.0; s.nrows()];
    let straight = calibrate(&task(2, runs(&s, 20, (&none, 0.0), &mut random), None)).unwrap();
    assert!(
        chances(&straight).iter().all(|c| c.1 > 1e-3),
        "{:?}",
        chances(&straight)
    );
    assert!(
        severe(&straight, "lack-of-fit").is_none() && severe(&straight, "common-zero").is_none()
    );
    // The curvature is 10 % at full load.
    let bent = calibrate(&task(
        2,
        runs(&s, 20, (&none, 0.1 / 200.0), &mut random),
        None,
    ))
    .unwrap();
    assert_eq!(severe(&bent, "lack-of-fit").unwrap().0, Severity::Warning);
}

/// With noise far below the error of the scale, the standard deviation of each recovered load is `scale_sd` of it, however many runs there are.
#[test]
fn an_error_that_known_loads_share_is_that_of_every_recovered_load() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let s = lanes(&mut random);
    let none = vec![0.0; s.nrows()];
    for count in [8, 40] {
        let exact = runs(&s, count, (&none, 0.0), &mut random);
        let shared = Task {
            scale_sd: 0.05,
            ..task(2, exact.clone(), None)
        };
        let found = calibrate(&shared).unwrap();
        for run in &exact {
            let of_run = recover_with_intervals(&found.sensitivity, run.strain.clone(), NOISE);
            let sum: f64 = run.loads.mean.iter().sum();
            for (w, known) in of_run.iter().zip(run.loads.mean.iter().chain([&sum])) {
                let share = w[1] / known;
                // The recovered load is the known load to 1 %. Noise and few runs add to its error.
                assert!(share > 0.049 && share < 0.066, "{count} runs: {share}");
            }
        }
    }
}

#[test]
fn one_run_for_each_load_is_an_error_and_names_no_gauge() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let s = lanes(&mut random);
    let mut read = |f: [f64; 2]| -> Vec<f64> {
        let rows = s.row_iter();
        rows.map(|row| (row[0] * f[0] + row[1] * f[1]) * (1.0 + 0.05 * draw_normal(&mut random)))
            .collect()
    };
    let known = |i: usize, f: [f64; 2], strain: Vec<f64>| KnownRun {
        run: format!("R{i}"),
        strain,
        noise_factor: 1.0,
        loads: KnownLoads::from_exact(f.to_vec()),
        group: i,
    };
    let taught = [[100.0, 0.0], [0.0, 100.0]];
    let taught: Vec<KnownRun> = (0..2)
        .map(|i| known(i, taught[i], read(taught[i])))
        .collect();
    let found = calibrate(&task(2, taught, None)).unwrap();
    assert_eq!(
        severe(&found, "coverage-not-tested").unwrap().0,
        Severity::Error
    );
    let readings: Vec<Readings> = (0..20)
        .map(|i| Readings {
            run: format!("N{i}"),
            strain: read([50.0, 80.0]),
            noise_factor: 1.0,
        })
        .collect();
    let errors = ErrorModel {
        noise: NOISE,
        model_rel: 0.0,
    };
    let recovered = recover(&found.sensitivity, &readings, errors);
    let codes: Vec<&str> = recovered.findings.iter().map(|f| f.code).collect();
    assert!(codes.contains(&"coverage-not-tested"), "{codes:?}");
    let gauges = &found.sensitivity.gauges;
    assert!(
        recovered
            .findings
            .iter()
            .all(|f| !gauges.contains(&f.subject)),
        "{codes:?}"
    );
}

#[test]
fn check_runs_are_recovered_as_new_runs_are() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let s = lanes(&mut random);
    let none = vec![0.0; s.nrows()];
    let mut all = runs(&s, 24, (&none, 0.0), &mut random);
    let checks = all.split_off(12);
    let found = calibrate(&task(2, all, None)).unwrap();
    for c in recover_checks(&found, NOISE, &checks) {
        for (v, w) in c.estimate.values.iter().zip(recover_with_intervals(
            &found.sensitivity,
            c.run.strain.clone(),
            NOISE,
        )) {
            assert!((v - w[0]).abs() < 1e-9 * v.abs());
        }
    }
    assert_eq!(found.range.loads.len(), 2);
    assert!(
        found
            .range
            .loads
            .iter()
            .all(|r| r[0] >= 20.0 && r[1] <= 100.0 && r[0] < r[1])
    );
}
