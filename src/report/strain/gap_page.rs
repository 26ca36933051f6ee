//! The page of `reconcile` on static strain.

use crate::finding::Finding;
use crate::reconcile::{NamedEffect, Outcome, Verdict};
use crate::report::figure::{GaugePoints, agreement, gap_by_channel};
use crate::report::page::{Block, Page, Section, figure_section, number, table_section};
use crate::report::scene::{Scene, scene_section};

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
) -> Page {
    let mut sections = vec![Section::new("Verdict", verdict(outcome))];
    let by_channel: Vec<(String, [f64; 3])> = outcome
        .channels
        .iter()
        .map(|c| (c.channel.clone(), [c.before, c.after, c.floor]))
        .collect();
    let listed = by_channel.iter().map(|(name, gap)| {
        let cells = gap.iter().map(|v| number(*v));
        std::iter::once(name.clone()).chain(cells).collect()
    });
    sections.push(Section::new(
        "Where the gap sits",
        vec![
            Block::Text(format!("{}.", outcome.sits)),
            Block::Figure(gap_by_channel(&by_channel, "µε")),
            Block::Note("Root mean square over the held-out runs: before and after the named effects; stroke: the floor, what noise and stated uncertainty leave.".into()),
            Block::Folded {
                summary: format!("{} gauges, µε rms", by_channel.len()),
                blocks: vec![Block::table(&["gauge", "before, µε", "after, µε", "floor, µε"], listed.collect())],
            },
        ],
    ));
    if let Some(scene) = scene {
        let mut section = scene_section("The gap on the model", scene);
        section.blocks.push(Block::Note("Area of a circle: what the model misses at that gauge in the held-out runs, orange before, blue after.".into()));
        sections.push(section);
    }
    if !strain.points.is_empty() {
        let kinds = ["runs used for fitting", "held-out runs"];
        let runs: [&[String]; 2] = [&strain.used, &strain.held_out];
        sections.push(figure_section(
            "Measured against predicted strain",
            agreement(&strain.points, kinds, runs),
            "Prediction of the model as it was given, before any effect.",
        ));
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
                .chain([l.unit.to_owned()])
                .collect()
        })
        .collect();
    if !moved.is_empty() {
        let head = [
            "run",
            "load",
            "stated",
            "recovered before",
            "after",
            "sigma",
            "unit",
        ];
        sections.push(table_section(
            "Loads that moved by more than two sigma",
            &head,
            &moved,
            "",
        ));
    }
    sections.push(Section::new(
        "What remains",
        vec![
            Block::Text(format!("{}.", outcome.remains)),
            Block::Stressed(
                "Next measurement:".into(),
                format!("{}.", outcome.next_measurement),
            ),
        ],
    ));
    let seen: Vec<Vec<String>> = outcome
        .detectable
        .iter()
        .map(|d| vec![d.id.clone(), number(d.size), d.unit.into()])
        .collect();
    sections.push(Section::new(
        "Smallest sizes that these runs would show",
        vec![Block::Folded {
            summary: format!("{} effects", seen.len()),
            blocks: vec![Block::table(&["effect", "size", "unit"], seen)],
        }],
    ));
    Page::new(
        title,
        "Where simulation and measurement disagree, and what is missing",
        findings,
        sections,
    )
}

fn verdict(outcome: &Outcome) -> Vec<Block> {
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
    let mut out = vec![Block::Stressed(
        format!("{}.", outcome.verdict.word()),
        words.into(),
    )];
    if !outcome.best_attempt.is_empty() {
        let rows = outcome.best_attempt.iter().map(effect).collect();
        let head = ["effect", "size", "sigma", "unit", "plausible"];
        out.push(Block::table(&head, rows));
    }
    let mut gap = format!(
        "Gap on {} runs, RMS(reading − model) / RMS(reading): {} before, {} after, floor {}; {:.0} % of what can be closed is closed.",
        g.basis.words(),
        percent(g.before),
        percent(g.after),
        percent(g.floor),
        100.0 * g.explained_share()
    );
    if let Some(found) = g.loads_found {
        gap.push_str(&format!(
            " With the errors of the noted wheel loads found anew in every run, before and after alike: {} before, {} after, floor {}.",
            percent(found.before),
            percent(found.after),
            percent(found.floor)
        ));
    }
    if let Some(mesh) = g.mesh {
        gap.push_str(&format!(
            " The mesh alone makes {}: the difference from a mesh half as wide.",
            percent(mesh)
        ));
    }
    if !outcome.best_attempt.is_empty() {
        gap.push_str(&format!(
            " When the runs are drawn anew it stays ahead in {} of 100 drawings.",
            outcome.wins
        ));
    }
    out.push(Block::Text(gap));
    out
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
    let head = [
        "instead",
        "log evidence behind",
        "gap after",
        "can be told apart",
    ];
    let rows: Vec<Vec<String>> = outcome.rivals.iter().map(row).collect();
    table_section("Other explanations", &head, &rows, "")
}
