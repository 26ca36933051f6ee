//! The page of `reconcile` on static strain.

use super::gap_svg::{GapMark, gap_bars, gap_on_model};
use super::page::{Section, number, page, table};
use crate::finding::Finding;
use crate::model::Model;
use crate::reconcile::{NamedEffect, Outcome, Verdict};
use maud::{Markup, PreEscaped, html};

/// The page: verdict, where the gap sits, what was named, what else would explain it, loads before and after, what remains.
pub fn reconcile_page(
    title: &str,
    outcome: &Outcome,
    model: Option<&Model>,
    marks: &[GapMark<'_>],
    findings: &[Finding],
) -> String {
    let mut sections = vec![Section {
        title: "Verdict".into(),
        body: verdict(outcome),
    }];
    let drawing = gap_on_model(model, marks);
    sections.push(Section {
        title: "Where the gap sits".into(),
        body: html! {
            p { (outcome.sits) "." }
            @if !drawing.is_empty() {
                (PreEscaped(drawing))
                p.muted { "Area of a circle: what the model misses at that gauge in the held-out runs, open before, full after. Named: above one and a half times its floor." }
            }
            (PreEscaped(gap_bars(&outcome.channels)))
            p.muted { "Root mean square over the held-out runs, microstrain: upper bar before, lower bar after, stroke the floor." }
        },
    });
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
