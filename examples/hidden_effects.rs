//! Hides effects in frames and counts what the workflow says of them: hit rate, false names, gap closed, detectable size.
//!
//! `cargo run --release --example hidden_effects [CONTROLS] [SEEDS]` prints the table of the README.
#![allow(clippy::print_stdout)]

#[path = "../tests/hidden/mod.rs"]
mod hidden;

use hidden::generator::{Background, EFFECTS, Hidden, STRANGERS, hide};
use strainbridge::reconcile::strain::{StrainFrame, examine};
use strainbridge::reconcile::{Outcome, Verdict};

#[derive(Default, Clone, Copy)]
struct Count {
    n: usize,
    hit: usize,
    alias: usize,
    partial: usize,
    none: usize,
    unknown: usize,
    wrong: usize,
    share: f64,
}

fn family(id: &str) -> String {
    id.split(':').next().unwrap_or(id).to_string()
}

fn judge(count: &mut Count, case: &Hidden, outcome: &Outcome) -> &'static str {
    count.n += 1;
    let ids: Vec<String> = match outcome.verdict {
        Verdict::Named => outcome.effects.iter().map(|e| e.id.clone()).collect(),
        Verdict::Unknown => vec!["unknown".into()],
        _ => vec!["none".into()],
    };
    let mut got: Vec<String> = ids.iter().map(|i| family(i)).collect();
    got.sort();
    got.dedup();
    let mut want: Vec<String> = case.truth.iter().map(|i| family(i)).collect();
    want.sort();
    want.dedup();
    let (slot, word) = if got == want {
        count.share += outcome.gap.explained_share().clamp(-1.0, 1.0);
        (&mut count.hit, "hit")
    } else if got == ["unknown"] && want != ["none"] {
        (&mut count.unknown, "unknown")
    } else if got == ["none"] {
        (&mut count.none, "none")
    } else if outcome.verdict == Verdict::Named
        && outcome.rivals.iter().any(|r| {
            let mut f: Vec<String> = r.ids.iter().map(|i| family(i)).collect();
            f.sort();
            r.indistinguishable && f == want
        })
    {
        (&mut count.alias, "alias")
    } else if got.iter().all(|g| want.contains(g)) {
        (&mut count.partial, "partial")
    } else {
        (&mut count.wrong, "FALSE")
    };
    *slot += 1;
    word
}

fn line(name: &str, c: &Count) {
    println!(
        "{name:28} n {:4} hit {:.2} alias {:.2} partial {:.2} none {:.2} unknown {:.2} FALSE {:.3} share {:.2}",
        c.n,
        c.hit as f64 / c.n as f64,
        c.alias as f64 / c.n as f64,
        c.partial as f64 / c.n as f64,
        c.none as f64 / c.n as f64,
        c.unknown as f64 / c.n as f64,
        c.wrong as f64 / c.n as f64,
        c.share / c.hit.max(1) as f64
    );
}

fn run(
    base: &[StrainFrame],
    effect: &str,
    size: f64,
    background: Background,
    seed: u64,
    count: &mut Count,
    show: bool,
) {
    let case = hide(
        &base[seed as usize % base.len()],
        effect,
        size,
        background,
        seed,
    );
    let start = std::time::Instant::now();
    let o = examine(&case.frame, &[]);
    let word = judge(count, &case, &o);
    if show || !["hit", "alias"].contains(&word) {
        let ids: Vec<String> = o
            .best_attempt
            .iter()
            .map(|e| format!("{} {:.2?}", e.id, e.size))
            .collect();
        println!(
            "   {word:8} {effect} {size} {background:?} seed {seed} truth {:?} signal {:.2} -> {:?} {ids:?} dE {:.1} chi2 {:.2?} share {:.2} rivals {:?} off {:?} {:?} {:.1}s",
            case.truth,
            case.signal,
            o.verdict,
            o.evidence,
            o.reduced_chi2,
            o.gap.explained_share(),
            o.rivals
                .iter()
                .take(2)
                .map(|r| format!("{:?} {:.1}", r.ids, r.evidence_difference))
                .collect::<Vec<_>>(),
            o.gauges_off
                .iter()
                .take(2)
                .map(|m| format!("{} {:.1}", m.name, m.deviate))
                .collect::<Vec<_>>(),
            o.runs_off
                .iter()
                .take(2)
                .map(|m| format!("{} {:.1}", m.name, m.deviate))
                .collect::<Vec<_>>(),
            start.elapsed().as_secs_f64()
        );
    }
}

fn main() {
    let Some(dir) = hidden::shared() else { return };
    let args: Vec<String> = std::env::args().collect();
    let number = |i: usize, or: u64| args.get(i).and_then(|a| a.parse().ok()).unwrap_or(or);
    let (controls, seeds) = (number(1, 20), number(2, 1));
    let only = args.get(3).cloned().unwrap_or_default();
    let wanted = |name: &str| only.is_empty() || only.split(',').any(|o| o == name);
    let base: Vec<StrainFrame> = ["dev-s1", "dev-s2"]
        .iter()
        .map(|c| hidden::frame_of(&dir.join("static").join(c)))
        .collect();
    if wanted("given") {
        for case in ["dev-s1", "dev-s2", "dev-s3", "dev-s4"] {
            let start = std::time::Instant::now();
            let o = examine(&hidden::frame_of(&dir.join("static").join(case)), &[]);
            println!(
                "{case} {:?} {:?} {:.1?} {:?} share {:.2} chi2 {:.2?} next: {} remains: {} {:.2} s",
                o.verdict,
                o.effects
                    .iter()
                    .map(|e| (&e.id, &e.size))
                    .collect::<Vec<_>>(),
                o.evidence,
                o.gap,
                o.gap.explained_share(),
                o.reduced_chi2,
                o.next_measurement,
                o.remains,
                start.elapsed().as_secs_f64()
            );
        }
    }
    for background in [Background::Clean, Background::Messy] {
        let mut total = Count::default();
        if wanted("none") {
            let mut c = Count::default();
            for k in 0..controls / 2 {
                run(&base, "none", 0.0, background, 1000 + k, &mut c, false);
            }
            line(&format!("none {background:?}"), &c);
        }
        for (effect, sizes) in EFFECTS {
            if !wanted(effect) {
                continue;
            }
            let mut c = Count::default();
            for (i, size) in sizes.into_iter().enumerate() {
                for k in 0..seeds {
                    run(
                        &base,
                        effect,
                        size,
                        background,
                        100 * (i as u64) + k,
                        &mut c,
                        false,
                    );
                }
            }
            line(&format!("{effect} {background:?}"), &c);
            for (t, v) in [
                (&mut total.n, c.n),
                (&mut total.hit, c.hit),
                (&mut total.alias, c.alias),
                (&mut total.partial, c.partial),
                (&mut total.none, c.none),
                (&mut total.unknown, c.unknown),
                (&mut total.wrong, c.wrong),
            ] {
                *t += v;
            }
            total.share += c.share;
        }
        line(&format!("all {background:?}"), &total);
        let mut strangers = Count::default();
        for s in STRANGERS {
            if wanted(s) || wanted("strangers") {
                let mut c = Count::default();
                for (i, size) in [0.3, 0.6, 1.0].into_iter().enumerate() {
                    for k in 0..seeds {
                        run(
                            &base,
                            s,
                            size,
                            background,
                            5000 + 100 * (i as u64) + k,
                            &mut c,
                            false,
                        );
                    }
                }
                line(&format!("{s} {background:?}"), &c);
                strangers.n += c.n;
                strangers.hit += c.hit;
                strangers.none += c.none;
                strangers.wrong += c.wrong;
            }
        }
        if strangers.n > 0 {
            line("strangers", &strangers);
        }
        if wanted("pairs") {
            let mut c = Count::default();
            let kinds: Vec<&str> = EFFECTS
                .iter()
                .map(|e| e.0)
                .filter(|e| {
                    ![
                        "payload_gravity_missing",
                        "uneven_ground",
                        "zero_drift_creep",
                    ]
                    .contains(e)
                })
                .collect();
            for k in 0..10 * seeds {
                let (a, b) = (
                    kinds[(k * 7 + 1) as usize % kinds.len()],
                    kinds[(k * 11 + 5 + k / 13) as usize % kinds.len()],
                );
                if a == b {
                    continue;
                }
                // Sizes are those of the first: of common magnitude per kind is asked of `hide` by a size each.
                run(
                    &base,
                    &format!("{a}+{b}"),
                    f64::NAN,
                    background,
                    9000 + k,
                    &mut c,
                    false,
                );
            }
            line(&format!("pairs {background:?}"), &c);
        }
    }
}
