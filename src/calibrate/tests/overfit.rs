//! Scatter of few runs over many gauges, which is too small without the correction.

use super::installed_position::draw_normal;
use super::repeats::{lanes, recover_with_intervals, task};
use crate::calibrate::{KnownLoads, KnownRun, Task, calibrate, overfit};
use crate::linalg::{Matrix, spd};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Without shrinkage the filter is a regression on all `n - k` patterns that no loads make. The variance of its errors in other runs is
/// `1 / (1 - (n - k) / dof)^2` times the variance of its residuals in the calibration runs.
#[test]
fn an_unshrunk_scatter_is_widened_by_the_patterns_that_it_estimated() {
    const N: usize = 6;
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let dof = 40.0;
    let runs: Vec<Vec<f64>> = (0..40)
        .map(|_| {
            let common = draw_normal(&mut random);
            (0..N)
                .map(|_| 3.0 * common + draw_normal(&mut random))
                .collect()
        })
        .collect();
    let mut sample = vec![0.0; N * N];
    for r in &runs {
        spd::add_outer(&mut sample, r, 1.0 / dof);
    }
    for k in [1, 2, 3] {
        let columns = Matrix::from_fn(N, k, |_, _| 1.0 + draw_normal(&mut random));
        let loads = |c: &[f64]| -> Matrix {
            let c = Matrix::from_row_slice(N, N, c).try_inverse().unwrap();
            (columns.transpose() * c * &columns).try_inverse().unwrap()
        };
        let added = overfit::overfit_scatter(&sample, (&sample, 0.0), &columns, dof).unwrap();
        let all: Vec<f64> = sample.iter().zip(&added).map(|(a, b)| a + b).collect();
        let times = 1.0 / (1.0 - (N - k) as f64 / dof).powi(2);
        let apart = loads(&all) - loads(&sample) * times;
        assert!(apart.norm() < 1e-9 * loads(&all).norm(), "{k}: {apart}");
    }
}

/// Returns whether the intervals of one more run contain each load and the sum. Eight gauges have a scatter of 3 % with a correlation of 0.9. Each
/// run has two loads drawn at random.
fn check_common_scatter(runs: usize, seed: u64) -> Vec<bool> {
    const NOISE: f64 = 1e-8;
    const N: usize = 8;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let s = lanes(&mut random);
    let mut drawn = || -> (Vec<f64>, Vec<f64>) {
        let f: Vec<f64> = (0..2).map(|_| random.random_range(60.0..330.0)).collect();
        let clean: Vec<f64> = (0..N)
            .map(|g| s[(g, 0)] * f[0] + s[(g, 1)] * f[1])
            .collect();
        let size = 0.03 * (clean.iter().map(|e| e * e).sum::<f64>() / N as f64).sqrt();
        let common = 0.9_f64.sqrt() * draw_normal(&mut random);
        let read = clean.iter().map(|e| {
            let own = 0.1_f64.sqrt() * draw_normal(&mut random);
            e + size * (common + own) + NOISE * draw_normal(&mut random)
        });
        (read.collect(), f)
    };
    let known = (0..runs).map(|i| {
        let (strain, f) = drawn();
        KnownRun {
            run: format!("R{i}"),
            strain,
            noise_factor: 1.0,
            loads: KnownLoads::from_exact(f),
            group: i,
        }
    });
    let task = Task {
        noise: NOISE,
        ..task(2, known.collect(), None)
    };
    let (strain, f) = drawn();
    let found = recover_with_intervals(&calibrate(&task).unwrap().sensitivity, strain, NOISE);
    let truth = [f[0], f[1], f[0] + f[1]];
    let each = found.iter().zip(truth);
    each.map(|([value, _, half], f)| (value - f).abs() <= *half)
        .collect()
}

#[test]
fn intervals_hold_where_gauges_scatter_together_and_are_many_against_the_runs() {
    for runs in [24, 36] {
        let trials: Vec<Vec<bool>> = (0..1200)
            .into_par_iter()
            .map(|seed| check_common_scatter(runs, seed))
            .collect();
        let held = trials.iter().flatten().filter(|h| **h).count() as f64 / 3600.0;
        eprintln!("{runs} runs: {:.1} % held", 100.0 * held);
        // The loads of a trial are correlated. The limit is three standard deviations of a binomial of 1,200, 1.9 %.
        assert!((held - 0.95).abs() < 0.019, "{runs}: {held}");
    }
}
