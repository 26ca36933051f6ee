//! Counts how often hidden effects of motion are identified, by effect, size and background.
//!
//! Run: `cargo run --example moving_effects -- SEEDS CONTROLS [EFFECT,..] [clean|messy]`. Prints the table of the README.

#![allow(clippy::print_stdout)]

#[path = "../tests/moving/mod.rs"]
mod moving;

use moving::generator::{Background, Layout, hide};
use moving::{Score, frame_of, score};
use strainbridge::reconcile::motion::examine;

/// Effects, with the vehicles in which they are hidden.
const EFFECTS: [(&str, &[Layout]); 16] = [
    ("viscous_damper", &[Layout::Front, Layout::Rear]),
    (
        "cubic_stiffness",
        &[Layout::Front, Layout::FrontAccelerationsOnly, Layout::Rear],
    ),
    (
        "coulomb_friction",
        &[Layout::Front, Layout::FrontAccelerationsOnly, Layout::Rear],
    ),
    (
        "bump_stop",
        &[Layout::Front, Layout::FrontAccelerationsOnly, Layout::Rear],
    ),
    (
        "asymmetric_damper",
        &[Layout::Front, Layout::FrontAccelerationsOnly, Layout::Rear],
    ),
    ("accel_gain", &[Layout::Front, Layout::Rear]),
    ("sign_flip", &[Layout::Front]),
    (
        "time_offset",
        &[Layout::Front, Layout::FrontAccelerationsOnly, Layout::Rear],
    ),
    ("axle_coupling", &[Layout::Pair, Layout::Rear]),
    ("roll_coupling", &[Layout::Pair]),
    ("mass_change", &[Layout::Front, Layout::Rear]),
    ("modulated_stiffness", &[Layout::Front]),
    ("memory", &[Layout::Front, Layout::FrontAccelerationsOnly]),
    ("quadratic_damping", &[Layout::Front]),
    ("dead_zone", &[Layout::Front]),
    ("stiffness_drift", &[Layout::Front]),
];

#[derive(Default, Clone)]
struct Tally {
    n: usize,
    exact: usize,
    abstained: usize,
    missed: usize,
    wrong: usize,
    share: f64,
}

impl Tally {
    fn add(&mut self, o: &Tally) {
        self.n += o.n;
        self.exact += o.exact;
        self.abstained += o.abstained;
        self.missed += o.missed;
        self.wrong += o.wrong;
        self.share += o.share;
    }
    fn line(&self, name: &str) {
        let part = |x: usize| x as f64 / self.n.max(1) as f64;
        println!(
            "{name:34} n {:4} exact {:.2} unknown {:.2} none {:.2} FALSE {:.3} share {:.3}",
            self.n,
            part(self.exact),
            part(self.abstained),
            part(self.missed),
            part(self.wrong),
            self.share / self.exact.max(1) as f64
        );
    }
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let number = |i: usize, or: u64| args.get(i).and_then(|a| a.parse().ok()).unwrap_or(or);
    let (seeds, controls) = (number(1, 1), number(2, 4));
    let only = args.get(3).cloned().unwrap_or_default();
    let wanted =
        |name: &str| only.is_empty() || only == "all" || only.split(',').any(|o| o == name);
    let grounds = match args.get(4).map(String::as_str) {
        Some("clean") => vec![Background::Clean],
        Some("messy") => vec![Background::Messy],
        _ => vec![Background::Clean, Background::Messy],
    };
    for background in grounds {
        let mut total = Tally::default();
        let run = |layout: Layout, effect: &str, size: usize, seed: u64, tally: &mut Tally| {
            let case = hide(layout, effect, size, background, seed);
            let start = std::time::Instant::now();
            let Ok(o) = examine(&frame_of(&case), &[]) else {
                println!("   failed {effect} {layout:?} {seed}");
                return;
            };
            let s = score(&case, &o);
            tally.n += 1;
            match s {
                Score::Exact | Score::Group => {
                    tally.exact += 1;
                    tally.share += o.gap.explained_share();
                }
                Score::Abstained => tally.abstained += 1,
                Score::Missed => tally.missed += 1,
                _ => tally.wrong += 1,
            }
            if !matches!(s, Score::Exact | Score::Group) || args.len() > 6 {
                let tried: Vec<String> = o
                    .best_attempt
                    .iter()
                    .map(|e| format!("{} {:.4?}", e.id, e.size))
                    .collect();
                let rivals: Vec<String> = o
                    .rivals
                    .iter()
                    .take(2)
                    .map(|r| format!("{} {:.1}", r.ids.join("+"), r.evidence_difference))
                    .collect();
                println!(
                    "   {s:?} {effect} {size} {layout:?} {background:?} seed {seed} {:?} -> {} {tried:?} dE {:.1} chi2 {:.2?} left {:.4?} gap {:.4} {:.4} {:.4} share {:.2} rivals {rivals:?} {:.1} s",
                    case.channel,
                    o.verdict.word(),
                    o.evidence,
                    o.reduced_chi2,
                    o.left,
                    o.gap.before,
                    o.gap.after,
                    o.gap.floor,
                    o.gap.explained_share(),
                    start.elapsed().as_secs_f64()
                );
            }
        };
        if wanted("none") {
            let mut t = Tally::default();
            for k in 0..controls {
                let layouts = [
                    Layout::Front,
                    Layout::Rear,
                    Layout::Pair,
                    Layout::FrontAccelerationsOnly,
                ];
                run(
                    layouts[k as usize % 4],
                    "none",
                    0,
                    number(5, 1000) + k,
                    &mut t,
                );
            }
            t.line(&format!("none {background:?}"));
            total.add(&t);
        }
        for (effect, layouts) in EFFECTS {
            if !wanted(effect) {
                continue;
            }
            let mut t = Tally::default();
            for layout in layouts {
                for size in 0..3 {
                    for k in 0..seeds {
                        run(
                            *layout,
                            effect,
                            size,
                            100 * size as u64 + 10_000 + k,
                            &mut t,
                        );
                    }
                }
            }
            t.line(&format!("{effect} {background:?}"));
            total.add(&t);
        }
        total.line(&format!("all {background:?}"));
    }
}
