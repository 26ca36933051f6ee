//! A zero interpolated between runs without load, with a known drift.

use super::{Drift, ZeroWeights, zero_run_weights};
use crate::measured::strain_table::{StrainRows, StrainTable};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Returns a random number with variance 1, the sum of three uniform numbers. Its second moments are close enough to those of a Gaussian.
fn draw_normal(random: &mut ChaCha8Rng) -> f64 {
    (0..3).map(|_| random.random_range(-1.0..1.0)).sum()
}

/// Returns the ratio of the error of the interpolated zero to its stated sd, as root mean square over trials.
///
/// The first ratio is for rows between zero runs, the second for rows after the last.
fn ratios(steady: f64, walk: f64) -> [f64; 2] {
    const NOISE: f64 = 0.5;
    const GAUGES: usize = 8;
    let at = [0, 5, 11, 14, 20];
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut errors = [(0.0, 0.0); 2];
    for _ in 0..300 {
        let slopes: Vec<f64> = (0..GAUGES)
            .map(|_| steady * draw_normal(&mut random))
            .collect();
        let mut zero = vec![vec![0.0; GAUGES]];
        for i in 1..24 {
            let before: &Vec<f64> = &zero[i - 1];
            let next = before.iter().zip(&slopes);
            zero.push(
                next.map(|(z, s)| z + s + walk * draw_normal(&mut random))
                    .collect(),
            );
        }
        let read: Vec<f64> = zero
            .iter()
            .flatten()
            .map(|z| z + NOISE * draw_normal(&mut random))
            .collect();
        let table = StrainTable {
            file: "strain.csv".into(),
            gauges: (0..GAUGES).map(|g| format!("G{g}")).collect(),
            rows: StrainRows::Runs((0..24).map(|i| format!("R{i}")).collect()),
            microstrain: read,
        };
        let drift = Drift::from_zero_runs(&table, &at, NOISE);
        for i in (0..24).filter(|i| !at.contains(i)) {
            let ZeroWeights {
                weights,
                wander,
                outside,
            } = zero_run_weights(&at, i);
            let place = usize::from(i > 20);
            let of_zero: f64 = weights.iter().map(|w| w.1 * w.1).sum();
            let variance =
                NOISE * NOISE * of_zero + drift.walk * wander + drift.steady * outside * outside;
            for g in 0..GAUGES {
                let followed: f64 = weights.iter().map(|(a, w)| w * table.row(*a)[g]).sum();
                errors[place].0 += (followed - zero[i][g]).powi(2);
                errors[place].1 += variance;
            }
        }
    }
    errors.map(|(error, stated)| f64::sqrt(error / stated))
}

#[test]
fn a_followed_zero_is_as_far_off_as_is_stated_whether_it_wanders_or_drifts_on() {
    // No drift, a random walk, a steady drift of ten times the noise between two zero runs, and both.
    for (steady, walk) in [(0.0, 0.0), (0.0, 0.4), (1.0, 0.0), (1.0, 0.4)] {
        // The ratio has the scatter of 300 times 8 zeros, plus a tenth for estimates that are cut off at zero.
        for ratio in ratios(steady, walk) {
            assert!((0.8..1.2).contains(&ratio), "{steady} {walk}: {ratio}");
        }
    }
}
