//! Calibrates S of 41 gauges and 9 loads from 40 calibration runs, and finds the best load for the next run.
//!
//! Run: `cargo bench --bench calibrate`. Target: less than a second, with noise only and with scatter between repeats.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainbridge::calibrate::{
    CommonZero, KnownLoads, KnownRun, ModelPrior, Task, calibrate, next_runs,
};
use strainbridge::linalg::Matrix;
use strainbridge::sensitivity::Load;

fn main() {
    divan::main();
}

const GAUGES: usize = 41;
const LOADS: usize = 9;
const RUNS: usize = 40;
const NOISE: f64 = 1e-6;
const SIZE: f64 = 1e4;

fn draw_normal(random: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (
        random.random_range(1e-300..1.0),
        random.random_range(0.0..1.0),
    );
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// Returns a calibration task. Each gauge deviates from the model by a common 5 %, and each coefficient by 2 % more. Every loading occurs twice, with
/// deviations of `scatter`.
fn task(scatter: f64) -> Task {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let model = Matrix::from_fn(GAUGES, LOADS, |_, _| 1e-8 * draw_normal(&mut random));
    let gains: Vec<f64> = (0..GAUGES)
        .map(|_| 1.0 + 0.05 * draw_normal(&mut random))
        .collect();
    let truth = Matrix::from_fn(GAUGES, LOADS, |g, l| {
        model[(g, l)] * gains[g] * (1.0 + 0.02 * draw_normal(&mut random))
    });
    let mut runs = Vec::new();
    for group in 0..RUNS / 2 {
        let f: Vec<f64> = (0..LOADS)
            .map(|_| SIZE * (1.0 + 0.5 * draw_normal(&mut random)))
            .collect();
        for _ in 0..2 {
            let acting: Vec<f64> = f
                .iter()
                .map(|f| f * (1.0 + scatter * draw_normal(&mut random)))
                .collect();
            let strain = (0..GAUGES).map(|g| {
                let clean: f64 = (0..LOADS).map(|l| truth[(g, l)] * acting[l]).sum();
                clean + NOISE * draw_normal(&mut random)
            });
            runs.push(KnownRun {
                run: format!("R{}", runs.len()),
                strain: strain.collect(),
                noise_factor: 1.0,
                loads: KnownLoads::from_exact(f.clone()),
                group,
            });
        }
    }
    Task {
        gauges: (0..GAUGES).map(|g| format!("G{g}")).collect(),
        loads: (0..LOADS)
            .map(|l| Load::from_name(format!("L{l}")))
            .collect(),
        noise: NOISE,
        gauge_noise: None,
        model: Some(ModelPrior {
            values: model,
            moves: Vec::new(),
            off_drawing: None,
            uncertainty_rel: 0.05,
        }),
        runs,
        sums: Vec::new(),
        common_zero: CommonZero::None,
        scale_sd: 0.0,
    }
}

#[divan::bench(args = [0.0, 0.03])]
fn forty_runs(bencher: divan::Bencher, scatter: f64) {
    let task = task(scatter);
    bencher.bench(|| {
        let found = calibrate(&task).expect("forty runs determine nine loads");
        next_runs(&found, task.noise, &[SIZE; LOADS]).expect("a size a load")
    });
}
