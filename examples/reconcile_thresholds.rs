//! Shows how halving and doubling each threshold of `reconcile` changes the identified causes.
//!
//! `cargo run --release --example reconcile_thresholds -- [--controls 40] [--effects 1] [--from 0] [--to 21] [--only static|motion]` prints one row
//! for each threshold. The row counts controls (no hidden effect) with an identified cause, effects that are hit, and effects with a wrong cause.
//! Each count is with the threshold halved, as it is, and doubled. Every threshold uses the same cases: `--controls` for strain and for motion, and
//! every effect of the generators `--effects` times. `--from` and `--to` are numbers of thresholds, strain first, so that parts of the table can be
//! run separately.
#![allow(clippy::print_stdout)]

#[path = "../tests/reconcile/hidden/mod.rs"]
#[allow(dead_code, reason = "the generator alone")]
mod hidden;
#[path = "../tests/moving/mod.rs"]
mod moving;

use moving::generator::Layout;
use rayon::prelude::*;
use strainbridge::reconcile::strain::StrainFrame;
use strainbridge::reconcile::{MotionRules, Rule, StrainRules, Verdict, motion, strain};

/// Factors on a threshold.
const FACTORS: [f64; 3] = [0.5, 1.0, 2.0];
/// Index of the effect size that is hidden in strain: the fourth of five.
const SIZE: usize = 3;
/// Effects of motion, each with the layout in which it is hidden.
const MOVING: [(&str, Layout); 12] = [
    ("viscous_damper", Layout::Front),
    ("cubic_stiffness", Layout::Front),
    ("coulomb_friction", Layout::FrontAccelerationsOnly),
    ("bump_stop", Layout::Rear),
    ("asymmetric_damper", Layout::Front),
    ("accel_gain", Layout::Rear),
    ("sign_flip", Layout::Front),
    ("time_offset", Layout::Front),
    ("axle_coupling", Layout::Pair),
    ("mass_change", Layout::Rear),
    ("quadratic_damping", Layout::Front),
    ("dead_zone", Layout::Front),
];
/// Layouts of the motion controls.
const LAYOUTS: [Layout; 4] = [
    Layout::Front,
    Layout::FrontAccelerationsOnly,
    Layout::Pair,
    Layout::Rear,
];

/// Counts of cases.
#[derive(Clone, Copy, Default)]
struct Tally {
    controls: usize,
    /// Controls with an identified cause.
    named: usize,
    effects: usize,
    hit: usize,
    /// Effects with a wrong cause.
    wrong: usize,
    /// Cases without a verdict.
    failed: usize,
}

impl Tally {
    fn join(mut self, other: Self) -> Self {
        self.controls += other.controls;
        self.named += other.named;
        self.effects += other.effects;
        self.hit += other.hit;
        self.wrong += other.wrong;
        self.failed += other.failed;
        self
    }

    fn cells(&self) -> String {
        format!(
            "{} / {} | {} / {} | {}",
            self.named, self.controls, self.hit, self.effects, self.wrong
        )
    }
}

/// Numbers of cases.
#[derive(Clone, Copy)]
struct Cases {
    controls: u64,
    effects: u64,
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let word = |key: &str| {
        let at = arguments.iter().position(|a| a == key)?;
        arguments.get(at + 1)
    };
    let number =
        |key: &str, other: u64| word(key).map_or(other, |t| t.parse().expect("a whole number"));
    let cases = Cases {
        controls: number("--controls", 40),
        effects: number("--effects", 1),
    };
    let all = StrainRules::ALL.len() + MotionRules::ALL.len();
    let wanted = number("--from", 0) as usize..number("--to", all as u64) as usize;
    let only = word("--only").map_or("", String::as_str);
    println!(
        "| threshold | value | halved: names of controls | hits | wrong | as it is: names of controls | hits | wrong | doubled: names of controls | hits | wrong |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let mut failed = 0;
    if only != "motion" {
        let bases = bases();
        let judged = |rules: StrainRules| tally_static_cases(&bases, cases, rules);
        failed += rows("strain", &StrainRules::ALL, 0, &wanted, judged);
    }
    if only != "static" {
        let first = StrainRules::ALL.len();
        let judged = |rules: MotionRules| tally_dynamic_cases(cases, rules);
        failed += rows("motion", &MotionRules::ALL, first, &wanted, judged);
    }
    if failed > 0 {
        println!("{failed} cases without a verdict");
        std::process::exit(1);
    }
}

/// Prints a row for each requested threshold; returns the number of cases without a verdict.
fn rows<R: Copy + Default>(
    world: &str,
    list: &[Rule<R>],
    first: usize,
    wanted: &std::ops::Range<usize>,
    judged: impl Fn(R) -> Tally,
) -> usize {
    let own: Vec<&Rule<R>> = (list.iter().enumerate())
        .filter(|(k, _)| wanted.contains(&(first + k)))
        .map(|(_, rule)| rule)
        .collect();
    if own.is_empty() {
        return 0;
    }
    let plain = judged(R::default());
    let mut failed = plain.failed;
    for (name, place) in own {
        let mut value = R::default();
        let value = *place(&mut value);
        let cells = FACTORS.map(|factor| {
            if factor == 1.0 {
                return plain.cells();
            }
            let mut rules = R::default();
            *place(&mut rules) *= factor;
            let tally = judged(rules);
            failed += tally.failed;
            tally.cells()
        });
        println!("| {world} {name} | {value} | {} |", cells.join(" | "));
    }
    failed
}

/// Returns the frames of the shared static cases.
fn bases() -> Vec<StrainFrame> {
    let folder = hidden::find_shared_folder().expect("../shared/hidden_effects");
    ["dev-s1", "dev-s2"]
        .map(|c| hidden::frame_of(&folder.join("static").join(c)))
        .into()
}

/// Counts strain cases: controls on messy backgrounds, then every effect.
fn tally_static_cases(bases: &[StrainFrame], cases: Cases, rules: StrainRules) -> Tally {
    use hidden::generator::{Background, EFFECTS, hide};
    use hidden::judge::{Answer, judge};
    let controls = (0..cases.controls).map(|k| ("none", 0.0, 80_000 + k));
    let hidden = EFFECTS.iter().flat_map(|(effect, sizes)| {
        let seed = |k: u64| 90_000 + k;
        (0..cases.effects).map(move |k| (*effect, sizes[SIZE], seed(k)))
    });
    let all: Vec<(&str, f64, u64)> = controls.chain(hidden).collect();
    let one = |&(effect, size, seed): &(&str, f64, u64)| {
        let base = &bases[seed as usize % bases.len()];
        let mut case = hide(base, effect, size, Background::Messy, seed);
        case.frame.rules = rules;
        let outcome = strain::examine(&case.frame, &[]);
        if effect == "none" {
            return Tally {
                controls: 1,
                named: usize::from(outcome.verdict == Verdict::Named),
                ..Tally::default()
            };
        }
        let answer = judge(&case, &outcome);
        Tally {
            effects: 1,
            hit: usize::from(matches!(answer, Answer::Hit | Answer::Alias)),
            wrong: usize::from(answer == Answer::False),
            ..Tally::default()
        }
    };
    all.par_iter().map(one).reduce(Tally::default, Tally::join)
}

/// Counts motion cases: controls on clean and messy backgrounds, then every effect.
fn tally_dynamic_cases(cases: Cases, rules: MotionRules) -> Tally {
    use moving::generator::{Background, hide};
    use moving::{Score, score};
    let controls = (0..cases.controls).map(|k| {
        let layout = LAYOUTS[k as usize % LAYOUTS.len()];
        ("none", layout, 80_000 + k)
    });
    let hidden = MOVING.iter().flat_map(|(effect, layout)| {
        (0..cases.effects).map(move |k| (*effect, *layout, 90_000 + k))
    });
    let all: Vec<(&str, Layout, u64)> = controls.chain(hidden).collect();
    let one = |&(effect, layout, seed): &(&str, Layout, u64)| {
        let background = match seed.is_multiple_of(2) {
            true => Background::Messy,
            false => Background::Clean,
        };
        let case = hide(layout, effect, 1, background, seed);
        let mut frame = moving::frame_of(&case);
        frame.rules = rules;
        let Ok(outcome) = motion::examine(&frame, &[]) else {
            return Tally {
                failed: 1,
                ..Tally::default()
            };
        };
        if effect == "none" {
            return Tally {
                controls: 1,
                named: usize::from(outcome.verdict == Verdict::Named),
                ..Tally::default()
            };
        }
        let found = score(&case, &outcome);
        let wrong = matches!(found, Score::False | Score::Misplaced | Score::Partial);
        Tally {
            effects: 1,
            hit: usize::from(matches!(found, Score::Exact | Score::Group)),
            wrong: usize::from(wrong),
            ..Tally::default()
        }
    };
    all.par_iter().map(one).reduce(Tally::default, Tally::join)
}
