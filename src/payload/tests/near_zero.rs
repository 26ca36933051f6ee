//! Weighing at and near an empty structure, and together with runs that have no answer.

use crate::linalg::Matrix;
use crate::payload::robust::cut_at_zero;
use crate::payload::{PayloadModel, PayloadRun, Place, Refusal, WeighSpec, weigh};
use crate::units::MICROSTRAIN;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Microstrain per newton of eight gauges on a clamped plate.
const ANSWERS: [f64; 8] = [2.5, -2.5, 1.36, -1.36, 0.6, -0.65, 0.4, -0.35];

/// Returns the sd of least squares over all gauges at one microstrain of noise, N.
fn sigma() -> f64 {
    1.0 / ANSWERS.iter().map(|a| a * a).sum::<f64>().sqrt()
}

fn plate() -> PayloadModel {
    PayloadModel {
        gauges: (0..ANSWERS.len()).map(|g| format!("G{g}")).collect(),
        wheels: Matrix::zeros(ANSWERS.len(), 0),
        payload: Matrix::from_fn(ANSWERS.len(), 3, |g, k| {
            if k == 0 {
                MICROSTRAIN * ANSWERS[g]
            } else {
                0.0
            }
        }),
        floor: Some(Matrix::zeros(0, 3)),
        calibrated: None,
        noise: None,
        arms: None,
    }
}

fn spec() -> WeighSpec {
    WeighSpec {
        place: Place::Known,
        model_rel: 0.01,
        reaction_sigma: 1.0,
        largest: 1e5,
        region: None,
    }
}

fn simulate_run(force: f64, random: &mut ChaCha8Rng) -> PayloadRun {
    let mut normal = || {
        let u: f64 = random.random_range(1e-12..1.0);
        let v: f64 = random.random_range(0.0..1.0);
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    };
    let strain = ANSWERS.iter().map(|a| MICROSTRAIN * (a * force + normal()));
    PayloadRun {
        run: format!("{force}"),
        strain: strain.collect(),
        sigma: vec![MICROSTRAIN; ANSWERS.len()],
        reactions: Vec::new(),
        shift: [0.0; 2],
    }
}

#[test]
fn intervals_hold_the_truth_of_an_empty_structure_and_of_small_payloads() {
    let trials = 500_u64;
    for (at, most) in [(0.0, 1.0), (0.5, 1.0), (2.0, 1.0), (10.0, 0.99)] {
        let truth = at * sigma();
        let one = |seed: u64| -> Option<(bool, f64)> {
            let mut random = ChaCha8Rng::seed_from_u64(7000 + seed);
            let found = weigh(&plate(), &[simulate_run(truth, &mut random)], &spec());
            let w = &found.runs[0];
            if w.refused.is_some() {
                return None;
            }
            let [low, high] = w.interval;
            assert!(low >= 0.0 && low <= w.force && w.force <= high, "{w:?}");
            assert!(
                high - w.force > 1.5 * sigma(),
                "the noise of the readings is in every interval: {w:?}"
            );
            Some((low <= truth && truth <= high, high - low))
        };
        let found: Vec<_> = (0..trials).into_par_iter().map(one).collect();
        let held = found.iter().flatten().filter(|f| f.0).count() as f64 / trials as f64;
        // 95 % less three standard errors of 500 trials. A refused run counts as a miss.
        assert!(
            held > 0.95 - 3.0 * (0.95 * 0.05 / trials as f64).sqrt() && held <= most,
            "at {at} sigma: {held}"
        );
        let wide = found.iter().flatten().map(|f| f.1).sum::<f64>() / trials as f64;
        // 2 x 1.96 sigma, plus the widening because gauges may be worse than stated.
        assert!(wide < 1.35 * 3.92 * sigma(), "at {at} sigma: {wide}");
    }
}

#[test]
fn an_interval_is_cut_at_zero_as_the_equation_states_and_left_alone_above_it() {
    assert_eq!(cut_at_zero(5.0, [3.0, 7.0]), (5.0, [3.0, 7.0]));
    assert_eq!(cut_at_zero(1.0, [-1.0, 3.0]), (1.0, [0.0, 3.0]));
    assert_eq!(cut_at_zero(-1.0, [-3.0, 1.0]), (0.0, [0.0, 2.0]));
    // The upper end is never below the half width, however negative the readings are by chance.
    assert_eq!(cut_at_zero(-2.5, [-4.5, -0.5]), (0.0, [0.0, 2.0]));
}

#[test]
fn a_run_without_an_answer_changes_nothing_of_the_others() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let good: Vec<PayloadRun> = [50.0, 80.0, 0.0]
        .iter()
        .map(|f| simulate_run(*f, &mut random))
        .collect();
    let pulled = simulate_run(-20.0, &mut random);
    let little = simulate_run(-2.0, &mut random);
    let mut blank = simulate_run(30.0, &mut random);
    blank.strain.fill(f64::NAN);
    let alone = weigh(&plate(), &good, &spec());
    let mut all = good.clone();
    all.insert(0, pulled);
    all.insert(2, little);
    all.push(blank);
    let found = weigh(&plate(), &all, &spec());
    for i in [0, 2] {
        let refused = found.runs[i].refused;
        assert!(
            matches!(refused, Some(Refusal::Negative { .. })),
            "{refused:?}"
        );
    }
    assert_eq!(found.runs[5].refused, Some(Refusal::Undetermined));
    for (i, truth) in [(1, 50.0), (3, 80.0), (4, 0.0)] {
        let w = &found.runs[i];
        assert_eq!(w.refused, None);
        // Four standard deviations of noise, and three of the model error of 1 %.
        assert!(
            (w.force - truth).abs() < 4.0 * sigma() + 0.03 * truth,
            "{w:?}"
        );
    }
    let kept = [1, 3, 4].map(|i| found.runs[i].clone());
    assert_eq!(kept.to_vec(), alone.runs);
    assert_eq!(found.gauges, alone.gauges);
    assert!(found.gauges.iter().all(|g| g.used), "{:?}", found.gauges);
}
