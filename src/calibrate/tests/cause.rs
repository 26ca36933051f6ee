//! Causes reported for gauges of the clamped strip that have one known fault.

use super::installed_position::{NOISE, draw_normal, pushes, reading, row, sites};
use crate::calibrate::*;
use crate::linalg::Matrix;
use crate::sensitivity::Load;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// Relative error of the true rows, common to a gauge and for each entry.
const OFF: f64 = 0.02;
/// Length over which rows change evenly: an element of such a strip.
const REACH: f64 = 20.0;

/// Returns the changes of the rows by an offset, as differences of the closed form.
fn off_drawing() -> OffDrawing {
    let sites = sites();
    let between = |from: [f64; 3], to: [f64; 3], span: f64| {
        Matrix::from_fn(sites.len(), 4, |g, l| {
            (row(sites[g], to)[l] - row(sites[g], from)[l]) / span
        })
    };
    let (a, x) = (0.01, 1.0);
    OffDrawing {
        turned: between([0.0, 0.0, -a], [0.0, 0.0, a], 2.0 * a),
        crossed: between([0.0; 3], [0.0, 0.0, FRAC_PI_2], 1.0),
        along: between([-x, 0.0, 0.0], [x, 0.0, 0.0], 2.0 * x),
        across: between([0.0, -x, 0.0], [0.0, x, 0.0], 2.0 * x),
        reach: REACH,
    }
}

/// Returns the pushes of a strip whose gauge `wrong` has an offset (along, across, turned) and a gain.
fn task(wrong: usize, offset: [f64; 3], gain: f64, seed: u64) -> Task {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let sites = sites();
    let truth: Vec<Vec<f64>> = (0..sites.len())
        .map(|g| {
            let (at, own) = match g == wrong {
                true => (offset, gain),
                false => ([0.0; 3], 1.0),
            };
            let common = own * (1.0 + OFF * draw_normal(&mut random));
            let mut row = row(sites[g], at);
            for s in &mut row {
                *s *= common * (1.0 + OFF * draw_normal(&mut random));
            }
            row
        })
        .collect();
    let pushes = pushes();
    let runs = pushes.iter().enumerate().map(|(i, f)| KnownRun {
        run: format!("R{i}"),
        strain: truth
            .iter()
            .map(|row| reading(row, f) + NOISE * draw_normal(&mut random))
            .collect(),
        noise_factor: 1.0,
        loads: KnownLoads::from_exact(f.to_vec()),
        group: i,
    });
    Task {
        gauges: (0..sites.len()).map(|g| format!("G{g}")).collect(),
        loads: (0..4).map(|l| Load::from_name(format!("L{l}"))).collect(),
        noise: NOISE,
        runs: runs.collect(),
        model: Some(ModelPrior {
            values: Matrix::from_fn(sites.len(), 4, |g, l| row(sites[g], [0.0; 3])[l]),
            moves: Vec::new(),
            off_drawing: Some(off_drawing()),
            uncertainty_rel: OFF,
        }),
        sums: Vec::new(),
        common_zero: CommonZero::None,
        scale_sd: 0.0,
        gauge_noise: None,
    }
}

/// Returns the reported causes for the wrong gauge, for every gauge in turn and four draws each. No other gauge may have the cause `Angle` or
/// `Place`.
fn words(offset: [f64; 3], gain: f64) -> Vec<ShiftWord> {
    let n = sites().len();
    (0..4 * n)
        .into_par_iter()
        .map(|i| {
            let wrong = i % n;
            let c = calibrate(&task(wrong, offset, gain, i as u64)).unwrap();
            for (g, s) in c.shifts.iter().enumerate().filter(|(g, _)| *g != wrong) {
                let named = matches!(s.word, ShiftWord::Angle | ShiftWord::Place);
                assert!(!named, "G{g} next to G{wrong}: {s:?}");
            }
            c.shifts[wrong].word
        })
        .collect()
}

fn count(words: &[ShiftWord], word: ShiftWord) -> usize {
    words.iter().filter(|w| **w == word).count()
}

/// Asserts that every cause is `word`, `None` or `Undetermined`, and that at least `least` of a hundred are `word`.
fn is_named(words: &[ShiftWord], word: ShiftWord, least: usize) {
    let silent = count(words, ShiftWord::None) + count(words, ShiftWord::Undetermined);
    let named = count(words, word);
    assert_eq!(named + silent, words.len(), "{words:?}");
    assert!(100 * named >= least * words.len(), "{words:?}");
}

#[test]
fn a_gain_is_a_gain_and_never_an_angle_or_a_place() {
    for gain in [0.7, 1.4] {
        is_named(&words([0.0; 3], gain), ShiftWord::Gain, 95);
    }
    let clean = words([0.0; 3], 1.0);
    assert_eq!(count(&clean, ShiftWord::None), clean.len(), "{clean:?}");
}

#[test]
fn a_turned_gauge_is_identified_if_the_pushes_determine_it() {
    for degrees in [10.0_f64, -10.0, -20.0] {
        let words = words([0.0, 0.0, degrees.to_radians()], 1.0);
        // Two of eight gauges, at 60 and 90 degrees, read little of the bending. Their change may stay within the error of the model.
        is_named(&words, ShiftWord::Angle, 70);
    }
}

#[test]
fn a_displaced_gauge_is_identified_if_the_pushes_determine_it() {
    for across in [20.0, -20.0] {
        // Across the strip only the in-plane moment changes. Gauges at 60 and 90 degrees read little of it.
        is_named(&words([0.0, across, 0.0], 1.0), ShiftWord::Place, 60);
    }
}

#[test]
fn without_the_change_of_rows_an_angle_is_not_guessed() {
    let mut task = task(0, [0.0, 0.0, 10_f64.to_radians()], 1.0, 1);
    let model = task.model.as_mut().unwrap();
    let off = model.off_drawing.take().unwrap();
    assert_ne!(calibrate(&task).unwrap().shifts[0].word, ShiftWord::Angle);
    // An installation tolerance states how the row would change. A fit of this change is not a comparison with other causes.
    task.model.as_mut().unwrap().moves = vec![Move {
        kind: MoveKind::Turned,
        change: off.turned,
        sd: 1e-6,
        at: vec![0.0; task.gauges.len()],
    }];
    assert_ne!(calibrate(&task).unwrap().shifts[0].word, ShiftWord::Angle);
}

#[test]
fn without_the_change_of_rows_neither_an_angle_nor_a_place_is_guessed() {
    let mut undetermined = 0;
    for off in [[0.0, 0.0, 10_f64.to_radians()], [0.0, 20.0, 0.0]] {
        for seed in 1..4 {
            let mut task = task(0, off, 1.0, seed);
            task.model.as_mut().unwrap().off_drawing = None;
            let word = calibrate(&task).unwrap().shifts[0].word;
            assert!(
                !matches!(word, ShiftWord::Angle | ShiftWord::Place),
                "{word:?}"
            );
            undetermined += u32::from(word == ShiftWord::Undetermined);
        }
    }
    assert!(undetermined > 0);
}
