//! Counts false names on controls: 400 cases without a hidden effect, alternately static and dynamic.
//!
//! `cargo run --release --example reconcile_controls -- [--from 0] [--to 400]` prints one line for each case, and the share of false names with its
//! interval (Wilson 1927, 95 %). A case without a verdict is counted separately, and the exit code is then 1. A case depends only on its number, so
//! parts of the sweep can be run separately and their lines joined. The cases include position errors of the gauges (standard deviation 2 mm), and
//! stated noise of 1/1.5 and 1.5 times the true noise. They use the vehicles of all shared cases, and records of 200 to 1,000 Hz from four layouts of
//! sensors.
#![allow(clippy::print_stdout)]

#[path = "../tests/reconcile/hidden/mod.rs"]
#[allow(dead_code, reason = "controls alone")]
mod hidden;
#[path = "../tests/moving/mod.rs"]
mod moving;

use moving::generator::{Dice, Layout};
use rayon::prelude::*;
use std::time::Instant;
use strainbridge::reconcile::Verdict;
use strainbridge::reconcile::strain::{Scatter, StrainFrame};
use strainbridge::reconcile::{motion, strain};

/// Ratios of the stated noise to the true noise.
const STATED: [f64; 3] = [1.0, 1.0 / 1.5, 1.5];
/// Standard deviation of a gauge's position along its axis, mm.
const PLACE_MM: f64 = 2.0;
/// Lengths over which strain changes by its own size, mm: from the width of a rail to the distance between two cross members.
const CHANGES_MM: [f64; 2] = [100.0, 600.0];

/// Result of a case.
struct Said {
    what: String,
    /// The verdict and the identified causes, or the reason why there is no verdict.
    found: Result<(Verdict, Vec<String>), String>,
    seconds: f64,
}

/// Counts of cases.
#[derive(Default)]
struct Tally {
    /// Cases with a verdict.
    tested: usize,
    wrong: usize,
    unknown: usize,
    /// Cases without a verdict, which neither pass nor fail.
    failed: usize,
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let number = |key: &str, other: usize| {
        let at = arguments.iter().position(|a| a == key);
        let text = at.and_then(|i| arguments.get(i + 1));
        text.map_or(other, |t| t.parse().expect("a whole number"))
    };
    let (from, to) = (number("--from", 0), number("--to", 400));
    let bases = bases();
    let mut tally = Tally::default();
    let cases: Vec<usize> = (from..to).collect();
    for some in cases.chunks(rayon::current_num_threads()) {
        let results: Vec<Said> = some.par_iter().map(|c| case(&bases, *c)).collect();
        for (case, s) in some.iter().zip(&results) {
            let found = match &s.found {
                Ok((verdict, names)) => {
                    tally.tested += 1;
                    tally.wrong += usize::from(*verdict == Verdict::Named);
                    tally.unknown += usize::from(*verdict == Verdict::Unknown);
                    format!("{} {names:?}", verdict.word())
                }
                Err(why) => {
                    tally.failed += 1;
                    format!("no verdict: {why}")
                }
            };
            println!("{case} {}: {found} ({:.1} s)", s.what, s.seconds);
        }
    }
    let Tally {
        tested,
        wrong,
        unknown,
        failed,
    } = tally;
    let [low, high] = wilson(wrong, tested);
    println!(
        "{tested} controls tested ({from} to {to}): {wrong} false names, {:.2} % ({:.2} to {:.2} %); {unknown} unknown; {failed} more without a verdict",
        percent(wrong, tested),
        100.0 * low,
        100.0 * high
    );
    // A control without a verdict did not pass.
    if failed > 0 {
        std::process::exit(1);
    }
}

fn percent(k: usize, n: usize) -> f64 {
    100.0 * k as f64 / n.max(1) as f64
}

/// Returns Wilson's 95 % interval of a share.
fn wilson(k: usize, n: usize) -> [f64; 2] {
    const Z: f64 = 1.959_964;
    let n = n.max(1) as f64;
    let p = k as f64 / n;
    let middle = p + Z * Z / (2.0 * n);
    let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + Z * Z / n;
    [(middle - half).max(0.0) / scale, (middle + half) / scale]
}

/// Returns the frames of the shared static cases, each with its name.
fn bases() -> Vec<(String, StrainFrame)> {
    let folder = hidden::find_shared_folder().expect("../shared/hidden_effects");
    let names = (1..=9).map(|k| format!("dev-s{k}"));
    let there = names.filter(|n| folder.join("static").join(n).is_dir());
    let read = |n: String| {
        let frame = hidden::frame_of(&folder.join("static").join(&n));
        (n, frame)
    };
    there.map(read).collect()
}

fn case(bases: &[(String, StrainFrame)], number: usize) -> Said {
    let start = Instant::now();
    let seed = 70_000 + number as u64;
    let stated = STATED[(number / 2 + number / 18) % STATED.len()];
    let (what, found) = if number.is_multiple_of(2) {
        let (name, base) = &bases[(number / 2) % bases.len()];
        let placed = (number / 6).is_multiple_of(2);
        let outcome = strain::examine(&make_static_control(base, seed, stated, placed), &[]);
        let place = if placed { ", places 2 mm" } else { "" };
        let names = outcome.effects.into_iter().map(|e| e.id).collect();
        (
            format!("static {name}, noise stated {stated:.2}{place}"),
            Ok((outcome.verdict, names)),
        )
    } else {
        run_dynamic_control(number, seed, stated)
    };
    Said {
        what,
        found,
        seconds: start.elapsed().as_secs_f64(),
    }
}

/// Returns a static control. Gains, angles and coefficients have the generator's errors; positions have errors if `placed`.
fn make_static_control(base: &StrainFrame, seed: u64, stated: f64, placed: bool) -> StrainFrame {
    use hidden::generator::{Background, hide};
    let mut frame = hide(base, "none", 0.0, Background::Messy, seed).frame;
    frame.noise *= stated;
    if !placed {
        return frame;
    }
    let mut dice = Dice::from_seed(seed);
    let n_c = frame.n_columns();
    let mut per_mm = frame.influence.clone();
    let mut moved = frame.clone();
    for row in per_mm.chunks_exact_mut(n_c) {
        let length = dice.draw_between(CHANGES_MM[0], CHANGES_MM[1]);
        row.iter_mut()
            .for_each(|v| *v *= dice.draw_normal() / length);
    }
    for (row, slope) in moved
        .influence
        .chunks_exact_mut(n_c)
        .zip(per_mm.chunks_exact(n_c))
    {
        let off = PLACE_MM * dice.draw_normal();
        row.iter_mut().zip(slope).for_each(|(v, s)| *v = off * s);
    }
    let change = strain::predict(&moved, &[]);
    let readings = frame.observations.values.iter_mut().zip(change);
    readings.for_each(|(v, c)| *v += c);
    let declared = per_mm.iter().map(|s| PLACE_MM * s).collect();
    frame.scatter.push(Scatter::Together(declared));
    frame.per_mm = Some(per_mm);
    frame
}

/// Runs a dynamic control.
fn run_dynamic_control(
    number: usize,
    seed: u64,
    stated: f64,
) -> (String, Result<(Verdict, Vec<String>), String>) {
    use moving::generator::{Background, hide_at};
    let layouts = [
        Layout::Front,
        Layout::FrontAccelerationsOnly,
        Layout::Pair,
        Layout::Rear,
    ];
    let rates = [200.0, 250.0, 400.0, 500.0, 1000.0];
    let (layout, rate) = (
        layouts[(number / 2) % layouts.len()],
        rates[(number / 2) % rates.len()],
    );
    let background = if (number / 6).is_multiple_of(2) {
        Background::Messy
    } else {
        Background::Clean
    };
    let case = hide_at(layout, rate, background, seed);
    let mut frame = moving::frame_of(&case);
    let factor = |sd: Option<f64>| sd.map(|s| s * stated);
    frame.noise_acc = factor(frame.noise_acc);
    frame.noise_force = factor(frame.noise_force);
    let what = format!("dynamic {layout:?} {rate} Hz, {background:?}, noise stated {stated:.2}");
    let found = motion::examine(&frame, &[]).map_err(|e| e.to_string());
    (
        what,
        found.map(|o| (o.verdict, o.effects.into_iter().map(|e| e.id).collect())),
    )
}
