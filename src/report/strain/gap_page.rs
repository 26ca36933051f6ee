//! The page of `reconcile` on static strain.

use crate::finding::Finding;
use crate::reconcile::{NamedEffect, Outcome, Verdict};
use crate::report::figure::{GaugePoints, agreement, gap_by_channel};
use crate::report::page::{Section, number, page, table};
use crate::report::scene::{Scene, scene_section};
use maud::{Markup, html};

/// Strain of the runs as the given model predicts it.
#[derive(Default)]
pub struct RunStrain {
    /// By gauge: runs used, runs held out.
    pub points: Vec<GaugePoints>,
    /// Names of the runs used.
    pub used: Vec<String>,
    /// Names of those held out.
    pub held_out: Vec<String>,
}

/// The page: verdict, where the gap sits, what was named, what else would explain it, loads before and after, what remains.
pub fn reconcile_page(
    title: &str,
    outcome: &Outcome,
    scene: Option<&Scene>,
    strain: &RunStrain,
    findings: &[Finding],
) -> String {
    let mut sections = vec![Section {
        title: "Verdict".into(),
        body: verdict(outcome),
    }];
    let by_channel: Vec<(String, [f64; 3])> = outcome
        .channels
        .iter()
        .map(|c| (c.channel.clone(), [c.before, c.after, c.floor]))
        .collect();
    sections.push(Section {
        title: "Where the gap sits".into(),
        body: html! {
            p { (outcome.sits) "." }
            (gap_by_channel(&by_channel, "µε"))
            p.muted { "Root mean square over the held-out runs: before and after the named effects; stroke: the floor, what noise and stated uncertainty leave." }
        },
    });
    if let Some(scene) = scene {
        let mut section = scene_section("The gap on the model", scene);
        section.body = html! {
            (section.body)
            p.muted { "Area of a circle: what the model misses at that gauge in the held-out runs, orange before, blue after." }
        };
        sections.push(section);
    }
    if !strain.points.is_empty() {
        sections.push(Section {
            title: "Measured against predicted strain".into(),
            body: html! {
                (agreement(&strain.points, ["runs used for fitting", "held-out runs"], [&strain.used, &strain.held_out]))
                p.muted { "Prediction of the model as it was given, before any effect." }
            },
        });
    }
    if !outcome.rivals.is_empty() {
        sections.push(rivals(outcome));
    }
    let moved: Vec<Vec<String>> = outcome
        .loads
        .iter()
        .filter(|l| l.moved())
        .map(|l| {
            let kn = [l.stated, l.before, l.after, l.sigma].map(|v| format!("{v:.2}"));
            [l.run.clone(), l.load.clone()]
                .into_iter()
                .chain(kn)
                .collect()
        })
        .collect();
    if !moved.is_empty() {
        sections.push(Section {
            title: "Loads that moved by more than two sigma, kN".into(),
            body: table(
                &[
                    "run",
                    "load",
                    "stated",
                    "recovered before",
                    "after",
                    "sigma",
                ],
                &moved,
            ),
        });
    }
    sections.push(Section {
        title: "What remains".into(),
        body: html! {
            p { (outcome.remains) "." }
            p { b { "Next measurement: " } (outcome.next_measurement) "." }
        },
    });
    let seen: Vec<Vec<String>> = outcome
        .detectable
        .iter()
        .map(|d| vec![d.id.clone(), number(d.size), d.unit.into()])
        .collect();
    sections.push(Section {
        title: "Smallest sizes that these runs would show".into(),
        body: html! { details { summary { (seen.len()) " effects" } (table(&["effect", "size", "unit"], &seen)) } },
    });
    page(
        title,
        "Where simulation and measurement disagree, and what is missing",
        findings,
        sections,
    )
}

fn verdict(outcome: &Outcome) -> Markup {
    let words = match outcome.verdict {
        Verdict::Named => "An effect is missing in the model, and it is named:",
        Verdict::None => "Model and readings agree within noise and stated uncertainty.",
        Verdict::Unknown => {
            "There is a gap, and nothing in the library closes it. The best attempt:"
        }
        Verdict::BelowDetectability => {
            "There is a hint of an effect, too small for these runs to name. The best attempt:"
        }
    };
    let g = &outcome.gap;
    let percent = |v: f64| format!("{:.2} %", 100.0 * v);
    html! {
        p { b { (outcome.verdict.word()) } ". " (words) }
        @if !outcome.best_attempt.is_empty() {
            (table(&["effect", "size", "sigma", "unit", "plausible"], &outcome.best_attempt.iter().map(effect).collect::<Vec<_>>()))
        }
        p {
            "Gap on held-out runs, RMS(reading − model) / RMS(reading): " (percent(g.before)) " before, " (percent(g.after)) " after, floor "
            (percent(g.floor)) "; " (format!("{:.0} %", 100.0 * g.explained_share())) " of what can be closed is closed."
            @if g.mesh > 0.0 { " The mesh alone makes " (percent(g.mesh)) ": the difference from a mesh half as wide." }
        }
    }
}

fn effect(e: &NamedEffect) -> Vec<String> {
    let list = |v: &[f64]| v.iter().map(|x| number(*x)).collect::<Vec<_>>().join(", ");
    let plausible = if e.plausible { "yes" } else { "no" };
    vec![
        e.id.clone(),
        list(&e.size),
        list(&e.sigma),
        e.unit.into(),
        plausible.into(),
    ]
}

fn rivals(outcome: &Outcome) -> Section {
    let row = |r: &crate::reconcile::Rival| {
        let apart = if r.indistinguishable { "no" } else { "yes" };
        vec![
            r.ids.join(" + "),
            format!("{:.1}", r.evidence_difference),
            format!("{:.2} %", 100.0 * r.gap_after),
            apart.into(),
        ]
    };
    Section {
        title: "Other explanations".into(),
        body: table(
            &[
                "instead",
                "log evidence behind",
                "gap after",
                "can be told apart",
            ],
            &outcome.rivals.iter().map(row).collect::<Vec<_>>(),
        ),
    }
}
