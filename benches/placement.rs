//! Placement at the sizes of the README: rows by loads by gauges, certificate included.
//!
//! Candidates are tensors of random bars and plates under random loads: rank and spread are those of a frame, not its values.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use strainbridge::placement::candidates::{Angles, Candidates, Scatter};
use strainbridge::placement::exchange::Effort;
use strainbridge::placement::{Spec, place};

fn main() {
    divan::main();
}

/// Smooth fields over places along a line: each load is a sum of a few waves in exx, eyy, gxy.
fn tensors(places: usize, loads: usize, angles: Angles) -> Candidates {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let waves: Vec<[f64; 4]> = (0..loads * 9)
        .map(|_| {
            [
                rng.random_range(0.2..6.0),
                rng.random_range(0.0..6.3),
                rng.random_range(-1.0..1.0),
                rng.random_range(0.0..1.0),
            ]
        })
        .collect();
    Candidates::from_tensors(loads, places, angles, Scatter::uniform(1.0), |p, out| {
        let x = p as f64 / places as f64;
        for (c, v) in out.iter_mut().enumerate() {
            *v = waves[c * 3..c * 3 + 3]
                .iter()
                .map(|[f, phase, a, _]| 100.0 * a * (std::f64::consts::TAU * f * x + phase).sin())
                .sum();
        }
    })
}

fn grid() -> Angles {
    Angles::Grid(
        (0..12)
            .map(|i| (15.0 * f64::from(i)).to_radians())
            .collect(),
    )
}

fn spec(gauges: usize, loads: usize) -> Spec {
    Spec {
        effort: Effort {
            starts: 4,
            kicks: 2,
            seed: 1,
        },
        ..Spec::new(gauges, loads)
    }
}

#[divan::bench(args = [6, 9, 20, 40], sample_count = 5, sample_size = 1)]
fn rows_200_thousand_loads_6(bencher: divan::Bencher, gauges: usize) {
    let c = tensors(200_000 / 12, 6, grid());
    bencher.bench(|| place(&c, &spec(gauges, 6)));
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn rows_2_million_loads_36_gauges_40(bencher: divan::Bencher) {
    let c = tensors(2_000_000 / 12, 36, grid());
    bencher.bench(|| place(&c, &spec(40, 36)));
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn rows_10_million_loads_6_gauges_20(bencher: divan::Bencher) {
    let c = tensors(10_000_000 / 12, 6, grid());
    bencher.bench(|| place(&c, &spec(20, 6)));
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn places_800_thousand_any_angle_loads_6_gauges_20(bencher: divan::Bencher) {
    let c = tensors(800_000, 6, Angles::Continuous);
    bencher.bench(|| place(&c, &spec(20, 6)));
}
