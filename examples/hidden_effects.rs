//! Hides effects in frames and counts the results of `reconcile`: hit rate, false names, gap closed, detectable size.
//!
//! `cargo run --example hidden_effects [SEEDS] [CONTROLS] [EFFECT,EFFECT..]` prints the table of the README (2 seeds, 200 controls). The frames are
//! from two cases of ../shared/hidden_effects; runs, loads, noise, background and effect are new in every case. Cases without a correct result are
//! listed on standard error.
#![allow(clippy::print_stdout, clippy::print_stderr)]

#[path = "../tests/reconcile/hidden/mod.rs"]
mod hidden;

use hidden::generator::{Background, EFFECTS, UNMODELLED, hide};
use hidden::judge::{Answer, judge};
use rayon::prelude::*;
use strainbridge::reconcile::strain::{StrainFrame, examine};

/// Result of one case.
struct Line {
    size: f64,
    answer: Answer,
    share: f64,
}

fn answer(
    bases: &[StrainFrame],
    effect: &str,
    size: f64,
    background: Background,
    seed: u64,
) -> Line {
    let base = &bases[seed as usize % bases.len()];
    let case = hide(base, effect, size, background, seed);
    let outcome = examine(&case.frame, &[]);
    let answer = judge(&case, &outcome);
    if !matches!(answer, Answer::Hit | Answer::Alias) {
        let tried: Vec<_> = outcome
            .best_attempt
            .iter()
            .map(|e| (&e.id, &e.size))
            .collect();
        eprintln!(
            "{answer:?}: {effect} {size} {background:?} seed {seed}, truth {:?}, signal {:.2} noise sd, answer {} {tried:?}, chi2 {:.2?}",
            case.truth,
            case.signal,
            outcome.verdict.word(),
            outcome.reduced_chi2
        );
    }
    Line {
        size,
        answer,
        share: outcome.gap.explained_share().clamp(-1.0, 1.0),
    }
}

/// Returns the share of `lines` with an answer among `wanted`, in percent.
fn percent(lines: &[Line], wanted: &[Answer]) -> f64 {
    let n = lines.iter().filter(|l| wanted.contains(&l.answer)).count();
    100.0 * n as f64 / lines.len().max(1) as f64
}

/// Returns the smallest size from which on every case is a hit.
fn always_hit(lines: &[Line], sizes: &[f64; 5]) -> String {
    let missed = |size: f64| {
        lines
            .iter()
            .any(|l| l.size == size && !matches!(l.answer, Answer::Hit | Answer::Alias))
    };
    match sizes.iter().rposition(|s| missed(*s)) {
        None => format!("{}", sizes[0]),
        Some(i) => sizes
            .get(i + 1)
            .map_or("above all".into(), |s| format!("{s}")),
    }
}

fn row(name: &str, lines: &[Line], detectable: &str) {
    use Answer::{Alias, False, Hit, None, Partial, Unknown};
    let hits: Vec<f64> = lines
        .iter()
        .filter(|l| l.answer == Hit)
        .map(|l| l.share)
        .collect();
    let share = 100.0 * hits.iter().sum::<f64>() / hits.len().max(1) as f64;
    println!(
        "| {name} | {} | {:.0} | {:.0} | {:.0} | {:.0} | {:.1} | {share:.0} | {detectable} |",
        lines.len(),
        percent(lines, &[Hit]),
        percent(lines, &[Alias]),
        percent(lines, &[None]),
        percent(lines, &[Unknown, Partial]),
        percent(lines, &[False])
    );
}

fn main() {
    let Some(dir) = hidden::find_shared_folder() else {
        return;
    };
    let args: Vec<String> = std::env::args().collect();
    let number = |i: usize, or: u64| args.get(i).and_then(|a| a.parse().ok()).unwrap_or(or);
    let (seeds, controls) = (number(1, 2), number(2, 200));
    let only = args.get(3).cloned().unwrap_or_default();
    let wanted = |name: &str| only.is_empty() || only.split(',').any(|o| o == name);
    let bases = ["dev-s1", "dev-s2"].map(|c| hidden::frame_of(&dir.join("static").join(c)));
    let run = |cases: Vec<(&str, f64, Background, u64)>| -> Vec<Line> {
        cases
            .into_par_iter()
            .map(|(e, s, b, k)| answer(&bases, e, s, b, k))
            .collect()
    };
    println!(
        "| effect, background | cases | named % | rival named % | none % | unknown % | false % | gap closed % | found from size |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for background in [Background::Clean, Background::Messy] {
        let say = |name: &str| format!("{name}, {background:?}").to_lowercase();
        if wanted("none") {
            let cases = (0..controls / 2).map(|k| ("none", 0.0, background, 1000 + k));
            row(&say("control"), &run(cases.collect()), "");
        }
        for (effect, sizes) in EFFECTS.iter().filter(|e| wanted(e.0)) {
            let each = sizes.iter().enumerate().flat_map(|(i, s)| {
                (0..seeds).map(move |k| (*effect, *s, background, 100 * (i as u64) + k))
            });
            let lines = run(each.collect());
            row(&say(effect), &lines, &always_hit(&lines, sizes));
        }
        for form in UNMODELLED
            .iter()
            .filter(|s| wanted(s) || wanted("unmodelled"))
        {
            let sizes = [0.3, 0.6, 1.0];
            let each = sizes.iter().enumerate().flat_map(|(i, s)| {
                (0..seeds).map(move |k| (*form, *s, background, 5000 + 100 * (i as u64) + k))
            });
            row(
                &say(&format!("unmodelled: {form}")),
                &run(each.collect()),
                "",
            );
        }
        if wanted("pairs") {
            let names = pairs(10 * seeds);
            let cases = (9000..)
                .zip(&names)
                .map(|(k, n)| (n.as_str(), f64::NAN, background, k));
            row(&say("two effects at once"), &run(cases.collect()), "");
        }
    }
}

/// Returns pairs of effects, joined by `+`.
fn pairs(n: u64) -> Vec<String> {
    // Effects that change the analyst's model cannot be combined with another effect.
    let alone = [
        "payload_gravity_missing",
        "uneven_ground",
        "zero_drift_creep",
    ];
    let kinds: Vec<&str> = EFFECTS
        .iter()
        .map(|e| e.0)
        .filter(|e| !alone.contains(e))
        .collect();
    let at = |k: u64| kinds[k as usize % kinds.len()];
    let both = (0..n).map(|k| (at(k * 7 + 1), at(k * 11 + 5 + k / 13)));
    both.filter(|(a, b)| a != b)
        .map(|(a, b)| format!("{a}+{b}"))
        .collect()
}
