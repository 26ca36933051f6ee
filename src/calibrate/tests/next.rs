//! The next known load against plain formulas of dense matrices.

use super::glued::{NOISE, pushes, reading, row, sites};
use crate::calibrate::*;
use crate::linalg::Matrix;
use crate::recovery::{ErrorModel, Readings, estimate};
use crate::sensitivity::Load;
use nalgebra::DMatrix;

/// Four pushes of the clamped strip, the loads two by two.
fn calibrated() -> Calibration {
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
            loads: KnownLoads::exact(f.to_vec()),
            group: i,
        }
    });
    let task = Task {
        gauges: (0..sites.len()).map(|g| format!("G{g}")).collect(),
        loads: (0..4).map(|l| Load::named(format!("L{l}"))).collect(),
        noise: NOISE,
        runs: runs.collect(),
        model: Some(ModelPrior {
            values: Matrix::from_fn(sites.len(), 4, |g, l| 1.02 * row(sites[g], [0.0; 3])[l]),
            moves: Vec::new(),
            off_drawing: None,
            uncertainty_rel: 0.1,
        }),
        sums: Vec::new(),
    };
    calibrate(&task).unwrap()
}

#[test]
fn the_next_load_buys_what_its_readings_would_take_from_the_covariance_of_s() {
    let found = calibrated();
    let sizes = [1.0, 0.5, 2.0, 1.5];
    let s = &found.sensitivity;
    let known = s.uncertainty.as_ref().unwrap();
    let (n, k) = s.values.shape();
    let v = DMatrix::from_row_slice(n * k, n * k, &known.covariance);
    let next = next_runs(&found, NOISE, &sizes);
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
        // In units of the noise, lest determinants underflow.
        let gained = 0.5 * (total / (NOISE * NOISE)).determinant().ln();
        assert!(
            (run.information / gained - 1.0).abs() < 1e-6,
            "{run:?} {gained}"
        );
        let sigma = |covariance: Vec<f64>, l: usize| {
            let mut s = s.clone();
            s.uncertainty.as_mut().unwrap().covariance = covariance;
            let readings = Readings {
                run: String::new(),
                strain: s.values.column(l).iter().map(|v| v * sizes[l]).collect(),
                noise_factor: 1.0,
            };
            let errors = ErrorModel {
                noise: NOISE,
                model_rel: 0.0,
            };
            estimate(&s, &readings, errors).estimate.sigma(l)
        };
        let ratio = |l: usize| {
            let then: Vec<f64> = after.transpose().iter().copied().collect();
            (sigma(known.covariance.clone(), l), sigma(then, l))
        };
        let (before, then) = ratio(run.load);
        // A difference of covariances near to each other: six figures are left.
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
