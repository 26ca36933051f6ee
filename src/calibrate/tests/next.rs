//! Compares the next known load with plain formulas of dense matrices.

use super::installed_position::{NOISE, draw_normal, pushes, reading, row, sites};
use crate::calibrate::posterior::{Equation, solve};
use crate::calibrate::state::{State, sensitivity_of};
use crate::calibrate::*;
use crate::linalg::Matrix;
use crate::linalg::precision::Precision;
use crate::recovery::{ErrorModel, Readings, estimate};
use crate::sensitivity::{Load, Sensitivity};
use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Calibrates with four pushes of the clamped strip. The loads act in pairs.
fn calibrate_four_pushes() -> Calibration {
    let sites = sites();
    let runs = pushes().into_iter().take(4).enumerate();
    let runs = runs.map(|(i, mut f)| {
        f[(i + 1) % 4] = 1.0;
        KnownRun {
            run: format!("R{i}"),
            strain: sites
                .iter()
                .map(|s| reading(&row(*s, [0.0; 3]), &f))
                .collect(),
            noise_factor: 1.0,
            loads: KnownLoads::from_exact(f.to_vec()),
            group: i,
        }
    });
    let task = Task {
        gauges: (0..sites.len()).map(|g| format!("G{g}")).collect(),
        loads: (0..4).map(|l| Load::from_name(format!("L{l}"))).collect(),
        noise: NOISE,
        runs: runs.collect(),
        model: Some(ModelPrior {
            values: Matrix::from_fn(sites.len(), 4, |g, l| 1.02 * row(sites[g], [0.0; 3])[l]),
            moves: Vec::new(),
            off_drawing: None,
            uncertainty_rel: 0.1,
        }),
        sums: Vec::new(),
        common_zero: CommonZero::None,
        scale_sd: 0.0,
        gauge_noise: None,
    };
    calibrate(&task).unwrap()
}

/// Returns the sigma of load `l`, recovered from the readings of this load alone at its size.
fn sigma_of(s: &Sensitivity, sizes: &[f64], l: usize) -> f64 {
    let readings = Readings {
        run: String::new(),
        strain: s.values.column(l).iter().map(|v| v * sizes[l]).collect(),
        noise_factor: 1.0,
    };
    let errors = ErrorModel {
        noise: NOISE,
        model_rel: 0.0,
    };
    estimate(s, &readings, errors).estimate.sigma(l)
}

#[test]
fn the_next_load_buys_what_its_readings_would_take_from_the_covariance_of_s() {
    let found = calibrate_four_pushes();
    let sizes = [1.0, 0.5, 2.0, 1.5];
    let s = &found.sensitivity;
    let known = s.uncertainty.as_ref().unwrap();
    let (n, k) = s.values.shape();
    let v = DMatrix::from_row_slice(n * k, n * k, &known.covariance);
    let next = next_runs(&found, NOISE, &sizes).unwrap();
    assert_eq!(next.len(), k + 1);
    assert!(next.is_sorted_by(|a, b| a.information >= b.information));
    for run in next {
        let a = DMatrix::from_fn(
            n,
            n * k,
            |g, e| if e / k == g { run.loads[e % k] } else { 0.0 },
        );
        let r = DMatrix::identity(n, n) * (NOISE * NOISE);
        let total = &a * &v * a.transpose() + &r;
        let after = &v - &v * a.transpose() * total.clone().try_inverse().unwrap() * &a * &v;
        // In units of the noise, so that determinants do not underflow.
        let gained = 0.5 * (total / (NOISE * NOISE)).determinant().ln();
        assert!(
            (run.information / gained - 1.0).abs() < 1e-6,
            "{run:?} {gained}"
        );
        let sigma = |covariance: Vec<f64>, l: usize| {
            let mut s = s.clone();
            s.uncertainty.as_mut().unwrap().covariance = covariance;
            sigma_of(&s, &sizes, l)
        };
        let ratio = |l: usize| {
            let then: Vec<f64> = after.transpose().iter().copied().collect();
            (sigma(known.covariance.clone(), l), sigma(then, l))
        };
        let (before, then) = ratio(run.load);
        // The difference of two similar covariances has six correct digits.
        assert!(
            (run.sigma_before / before - 1.0).abs() < 1e-6,
            "{run:?} {before}"
        );
        assert!(
            (run.sigma_after / then - 1.0).abs() < 1e-6,
            "{run:?} {then}"
        );
        for l in 0..k {
            let (b, t) = ratio(l);
            assert!(b / t <= before / then * (1.0 + 1e-6), "{run:?}: {l}");
        }
    }
}

#[test]
fn a_wrong_number_of_sizes_is_a_fault() {
    let found = calibrate_four_pushes();
    for sizes in [&[1.0; 3][..], &[1.0; 5], &[1.0, 1.0, 1.0, f64::NAN]] {
        assert!(next_runs(&found, NOISE, sizes).is_err(), "{sizes:?}");
    }
}

/// Scatter between repeats of one loading, as a share of the strain: common to all gauges, and of each gauge separately.
const SCATTER: [f64; 2] = [0.03, 0.01];

/// Returns the six pushes three times each; repeats scatter.
fn task_with_repeats() -> Task {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let sites = sites();
    let mut runs = Vec::new();
    for (group, f) in pushes().into_iter().enumerate() {
        for _ in 0..3 {
            let alike = 1.0 + SCATTER[0] * draw_normal(&mut random);
            let strain = sites.iter().map(|s| {
                let own = alike + SCATTER[1] * draw_normal(&mut random);
                own * reading(&row(*s, [0.0; 3]), &f) + NOISE * draw_normal(&mut random)
            });
            runs.push(KnownRun {
                run: format!("R{}", runs.len()),
                strain: strain.collect(),
                noise_factor: 1.0,
                loads: KnownLoads::from_exact(f.to_vec()),
                group,
            });
        }
    }
    Task {
        gauges: (0..sites.len()).map(|g| format!("G{g}")).collect(),
        loads: (0..4).map(|l| Load::from_name(format!("L{l}"))).collect(),
        noise: NOISE,
        runs,
        model: Some(ModelPrior {
            values: Matrix::from_fn(sites.len(), 4, |g, l| 1.02 * row(sites[g], [0.0; 3])[l]),
            moves: Vec::new(),
            off_drawing: None,
            uncertainty_rel: 0.1,
        }),
        sums: Vec::new(),
        common_zero: CommonZero::None,
        scale_sd: 0.0,
        gauge_noise: None,
    }
}

#[test]
fn with_repeats_that_scatter_the_next_load_buys_what_a_refit_with_it_has() {
    let task = task_with_repeats();
    let all: Vec<usize> = (0..task.runs.len()).collect();
    let state = State::fit_runs(&task, &all, &[]).unwrap();
    let scatter = &state.scatter.covariance;
    assert!(scatter.iter().any(|c| *c > 0.0), "no scatter was learnt");
    let found = Calibration {
        sensitivity: state.sensitivity(&task, 1.0),
        ..calibrate(&task).unwrap()
    };
    let s = &found.sensitivity;
    let (n, k) = s.values.shape();
    let sizes = [1.0, 0.5, 2.0, 1.5];
    let next = next_runs(&found, NOISE, &sizes).unwrap();
    assert_eq!(next.len(), k + 1);
    let log_det = |covariance: &[f64]| {
        Precision::from_covariance(covariance, n * k)
            .unwrap()
            .log_det()
    };
    for run in next {
        // This run has an equation like the other runs. Its readings are the prediction of S, so that the refit changes only the covariance.
        let phi: Vec<f64> = run
            .loads
            .iter()
            .zip(&state.scales)
            .map(|(f, c)| f / c)
            .collect();
        let y = state.posterior.predict(&phi);
        let q2 = y.iter().map(|v| v * v).sum::<f64>() / n as f64;
        let mut covariance: Vec<f64> = scatter.iter().map(|c| q2 * c).collect();
        (0..n).for_each(|g| covariance[g * n + g] += NOISE * NOISE);
        let mut equations = state.equations.clone();
        equations.push(Equation {
            gauges: (0..n).collect(),
            y,
            phi,
            covariance,
        });
        let refit = solve(&state.prior, &equations).unwrap();
        let gained = 0.5 * (log_det(&state.posterior.covariance) - log_det(&refit.covariance));
        assert!(
            (run.information / gained - 1.0).abs() < 1e-6,
            "{run:?} {gained}"
        );
        let after = sensitivity_of(&task, (&state.scales[..], &refit, &state.scatter), 1.0, &[]);
        let sigma = |s: &Sensitivity| sigma_of(s, &sizes, run.load);
        assert!((run.sigma_before / sigma(s) - 1.0).abs() < 1e-6, "{run:?}");
        assert!(
            (run.sigma_after / sigma(&after) - 1.0).abs() < 1e-6,
            "{run:?}"
        );
    }
}
