//! The page of `reconcile` on static strain.

use crate::estimate::NORMAL_95;
use crate::finding::Finding;
use crate::reconcile::effect::Extension;
use crate::reconcile::{NamedEffect, Outcome, SmoothAt, Verdict};
use crate::report::covariance::covariance_block;
use crate::report::figure::{Ends, GaugePoints, IntervalRow, agreement, gap_by_channel, intervals};
use crate::report::page::{Block, Page, Section, number, table_section};
use crate::report::scene::{Scene, scene_section};

/// Heading over the changes of the model.
pub const ADDED: &str = "What was added";

/// Strain of the runs predicted by the model, without and with the effects.
#[derive(Default)]
pub struct RunStrain {
    /// Readings and predictions of the given model by gauge: runs used, runs held out.
    pub before: Vec<GaugePoints>,
    /// Readings and predictions of the model with the effects by gauge: runs used, runs held out.
    pub after: Vec<GaugePoints>,
    /// Names of the runs used.
    pub used: Vec<String>,
    /// Names of the runs held out.
    pub held_out: Vec<String>,
}

/// Content of the page.
pub struct GapReport<'a> {
    /// Title of the job.
    pub title: &'a str,
    /// Outcome of `reconcile` on strain.
    pub outcome: &'a Outcome,
    /// Changes of the model: effect, path, old and new value; empty without an extended model.
    pub added: Vec<Vec<String>>,
    /// The gap on the model.
    pub scene: Option<&'a Scene<'a>>,
    /// Strain of the runs.
    pub strain: &'a RunStrain,
    /// Findings.
    pub findings: &'a [Finding],
}

/// Returns the page: verdict, place of the gap, changes of the model, gap and scatter before and after, the gap on the model, and notes.
pub fn reconcile_page(report: &GapReport<'_>) -> Page {
    let outcome = report.outcome;
    let mut sections = vec![
        Section::new("Verdict", verdict(outcome)),
        Section::new(
            "Largest gaps",
            vec![Block::Text(format!("{}.", outcome.sits))],
        ),
        added_section(outcome, &report.added),
        gap_section(outcome),
    ];
    sections.extend(scatter_section(report.strain, outcome));
    if let Some(scene) = report.scene {
        let mut section = scene_section("The gap on the model", scene);
        section.blocks.push(Block::Note(format!(
            "Area of a circle: residual at that gauge in the {} runs, orange before, blue after.",
            outcome.gap.basis.words()
        )));
        sections.push(section);
    }
    sections.extend(smooth_section(outcome));
    if !outcome.rivals.is_empty() {
        sections.push(alternatives_section(outcome));
    }
    let moved: Vec<Vec<String>> = outcome
        .loads
        .iter()
        .filter(|l| l.is_significant())
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
            "Loads that change by more than two sigma",
            &head,
            &moved,
            "",
        ));
    }
    sections.push(Section::new(
        "Remaining gap",
        vec![
            Block::Text(format!("{}.", outcome.remains.trim_end_matches('.'))),
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
        report.title,
        "Differences between model and measurement, and missing effects",
        report.findings,
        sections,
    )
}

/// The named effects (or best attempt) with their sizes, their joint probability, and their places in the extended model.
fn added_section(outcome: &Outcome, added: &[Vec<String>]) -> Section {
    if outcome.best_attempt.is_empty() {
        let nothing = Block::Text("No effect is identified.".into());
        return Section::new(ADDED, vec![nothing]);
    }
    let rows = outcome.best_attempt.iter().map(effect).collect();
    let head = [
        "effect",
        "size",
        "± (half width of the 95 % interval)",
        "unit",
        "plausible",
    ];
    let mut blocks = vec![Block::table(&head, rows)];
    blocks.push(match (outcome.verdict, added.is_empty()) {
        (Verdict::Named, false) => Block::table(
            &["effect", "path", "old value", "new value"],
            added.to_vec(),
        ),
        (Verdict::Named, true) => {
            Block::Text("No extended model is written: the findings state the reason.".into())
        }
        _ => Block::Text("The best attempt. It is not identified, and nothing was added.".into()),
    });
    blocks.extend(covariance_block(&sizes(outcome), &outcome.covariance));
    Section::new(ADDED, blocks)
}

/// Name of every size of the set, in the order of its covariance. Amplitudes of runs have sizes, and no place in it.
fn sizes(outcome: &Outcome) -> Vec<String> {
    let n = outcome.covariance.len().isqrt();
    let of = |e: &NamedEffect| {
        let name = |k: usize| match e.size.len() {
            1 => e.id.clone(),
            _ => format!("{} ({})", e.id, k + 1),
        };
        (0..e.size.len()).map(name).collect::<Vec<_>>()
    };
    let has_parameters = |e: &&NamedEffect| !matches!(e.extension, Extension::NuisanceLoads { .. });
    let named = outcome.best_attempt.iter().filter(has_parameters);
    let names: Vec<String> = named.flat_map(of).collect();
    match names.len() == n {
        true => names,
        false => (1..=n).map(|k| format!("parameter {k}")).collect(),
    }
}

fn gap_section(outcome: &Outcome) -> Section {
    let by_channel: Vec<(String, [f64; 3])> = outcome
        .channels
        .iter()
        .map(|c| (c.channel.clone(), [c.before, c.after, c.floor]))
        .collect();
    let listed = by_channel.iter().map(|(name, gap)| {
        let cells = gap.iter().map(|v| number(*v));
        std::iter::once(name.clone()).chain(cells).collect()
    });
    Section::new(
        "Gap before and after",
        vec![
            Block::Text(gap_words(outcome)),
            Block::Figure(gap_by_channel(&by_channel, "µε rms")),
            Block::Note(format!(
                "Root mean square over the {} runs: before and after the identified effects. Stroke: the noise floor, from noise and stated uncertainty.",
                outcome.gap.basis.words()
            )),
            Block::Folded {
                summary: format!("{} gauges, µε rms", by_channel.len()),
                blocks: vec![Block::table(
                    &["gauge", "before, µε", "after, µε", "floor, µε"],
                    listed.collect(),
                )],
            },
        ],
    )
}

/// Measured against predicted strain, before and after.
fn scatter_section(strain: &RunStrain, outcome: &Outcome) -> Option<Section> {
    if strain.before.is_empty() {
        return None;
    }
    let kinds = ["runs used for fitting", "held-out runs"];
    let runs: [&[String]; 2] = [&strain.used, &strain.held_out];
    let mut rows = Vec::new();
    for (k, kind) in kinds.into_iter().enumerate() {
        let scatter = [&strain.before, &strain.after].map(|p| scatter_of(p, k));
        if let [Some(before), Some(after)] = scatter {
            rows.push(vec![kind.to_owned(), number(before), number(after)]);
        }
    }
    let mut blocks = vec![
        Block::table(&["", "before, µε rms", "after, µε rms"], rows),
        Block::Figure(agreement(&strain.before, kinds, runs)),
        Block::Note("Measured against predicted strain: the model as given.".into()),
    ];
    if !outcome.best_attempt.is_empty() {
        blocks.push(Block::Figure(agreement(&strain.after, kinds, runs)));
        blocks.push(Block::Note(
            "Strain of the model with the identified effects, except for the parts that differ from run to run."
                .into(),
        ));
    }
    Some(Section::new("Scatter before and after", blocks))
}

/// Root mean square of measured less predicted strain of one kind of runs; `None` if there are no such runs.
fn scatter_of(points: &[GaugePoints], kind: usize) -> Option<f64> {
    let all = points.iter().filter_map(|g| g.points.get(kind)).flatten();
    let square = |p: &(f64, f64)| (p.1 - p.0).powi(2);
    let squares: Vec<f64> = all.map(square).filter(|v| v.is_finite()).collect();
    let n = squares.len();
    (n > 0).then(|| (squares.iter().sum::<f64>() / n as f64).sqrt())
}

/// The smooth error of the model over the gauges, along the structure's longest direction.
fn smooth_section(outcome: &Outcome) -> Option<Section> {
    let at = |s: &SmoothAt, axis: usize| s.place_m[axis];
    let extent = |axis: usize| {
        let places = || outcome.smooth.iter().map(|s| at(s, axis));
        places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min)
    };
    let longest = (0..3).max_by(|a, b| extent(*a).total_cmp(&extent(*b)))?;
    let mut sorted: Vec<&SmoothAt> = outcome.smooth.iter().collect();
    sorted.sort_by(|a, b| at(a, longest).total_cmp(&at(b, longest)));
    let mut groups: Vec<(String, Vec<IntervalRow>)> = Vec::new();
    for s in sorted {
        let name = s.load.clone().unwrap_or_else(|| "all loads".into());
        let half = NORMAL_95 * s.sd;
        let row = (
            format!("{} at {:.2} m", s.gauge, at(s, longest)),
            [s.factor - half, s.factor, s.factor + half],
        );
        match groups.iter_mut().find(|g| g.0 == name) {
            Some(g) => g.1.push(row),
            None => groups.push((name, vec![row])),
        }
    }
    let axis = ["x", "y", "z"][longest];
    (!groups.is_empty()).then(|| {
        Section::new(
            "The smooth error of the model",
            vec![
                Block::Figure(intervals(
                    &groups,
                    "strain divided by predicted strain",
                    Ends::Interval,
                    "Measured over predicted strain of each gauge with its 95 % interval: nearer to 1 is better.",
                )),
                Block::Note(format!(
                    "Gauges in the order of their {axis}."
                )),
            ],
        )
    })
}

fn verdict(outcome: &Outcome) -> Vec<Block> {
    let words = match outcome.verdict {
        Verdict::Named => "An effect is missing in the model and is identified:",
        Verdict::None => "Model and readings agree within noise and stated uncertainty.",
        Verdict::Unknown => {
            "Model and readings differ, and no effect of the library explains the gap. The best attempt:"
        }
        Verdict::BelowDetectability => {
            "The readings indicate an effect that is too small to identify. The best attempt:"
        }
    };
    let mut out = vec![Block::Stressed(
        format!("{}.", outcome.verdict.word()),
        words.into(),
    )];
    if !outcome.best_attempt.is_empty() {
        let ids: Vec<&str> = outcome.best_attempt.iter().map(|e| e.id.as_str()).collect();
        out.push(Block::Text(format!(
            "{}. {} of 100 resampled run sets contain every effect.",
            ids.join(", "),
            outcome.wins
        )));
    }
    out
}

/// Returns the sentence on the gap before and after, both computed in the same way.
fn gap_words(outcome: &Outcome) -> String {
    let g = &outcome.gap;
    let percent = |v: f64| format!("{:.2} %", 100.0 * v);
    let mut gap = format!(
        "Gap on {} runs, RMS(reading − model) / RMS(reading): {} before, {} after, floor {}; {:.0} % of the possible reduction is reached.",
        g.basis.words(),
        percent(g.before),
        percent(g.after),
        percent(g.floor),
        100.0 * g.explained_share()
    );
    if let Some(found) = g.loads_found {
        gap.push_str(&format!(
            " With the errors of the recorded wheel loads estimated in every run: {} before, {} after, floor {}.",
            percent(found.before),
            percent(found.after),
            percent(found.floor)
        ));
    }
    if let Some(mesh) = g.mesh {
        gap.push_str(&format!(
            " The mesh alone causes {}: the difference from a mesh half as wide.",
            percent(mesh)
        ));
    }
    gap
}

fn effect(e: &NamedEffect) -> Vec<String> {
    let list = |v: &[f64]| v.iter().map(|x| number(*x)).collect::<Vec<_>>().join(", ");
    let half: Vec<f64> = e.sigma.iter().map(|s| NORMAL_95 * s).collect();
    let plausible = if e.plausible { "yes" } else { "no" };
    vec![
        e.id.clone(),
        list(&e.size),
        list(&half),
        e.unit.into(),
        plausible.into(),
    ]
}

fn alternatives_section(outcome: &Outcome) -> Section {
    let row = |r: &crate::reconcile::AlternativeExplanation| {
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
        "can be distinguished",
    ];
    let rows: Vec<Vec<String>> = outcome.rivals.iter().map(row).collect();
    table_section("Other explanations", &head, &rows, "")
}
