//! The page that leads through the story.

use super::chapter::{Chapter, percent};
use crate::finding::Severity;
use crate::report::page::{Block, Card, Page, Section};

/// Errors before and after the correction, for the head of the page.
pub(super) struct Figures {
    /// Whether `reconcile` identified the hidden effect.
    pub found: bool,
    /// Error of the wheel loads, rms, relative: as measured, and with the effect in the model.
    pub before: f64,
    pub after: f64,
    /// Error of the payload, rms, relative.
    pub payload: f64,
}

/// Returns the page with the truck and its gauges, followed by a card for each step.
pub(super) fn page(chapters: &[Chapter], figures: &Figures) -> Page {
    let sections = vec![
        Section::new("The truck", vec![Block::Cards(head(chapters, figures))]),
        Section::new(
            "Step by step",
            vec![
                Block::Cards(chapters.iter().map(card).collect()),
                Block::Note(
                    "Every step is a folder with its job, tables and report: copy one to start your own job.".to_owned(),
                ),
            ],
        ),
    ];
    Page::new(
        "A truck as its own load cell",
        "Strain gauges and a finite element model give wheel loads with intervals",
        &[],
        sections,
    )
}

/// The plan of the gauges, large, with its results.
fn head(chapters: &[Chapter], figures: &Figures) -> Vec<Card> {
    let plan = chapters.iter().find(|c| c.command == "place");
    let found = match figures.found {
        true => "found",
        false => "not found",
    };
    let of = |c: &Chapter| {
        let gauges = c.step.result["gauges"].as_array().map_or(0, Vec::len);
        let mut card = c.step.card.clone();
        card.title =
            format!("{gauges} gauges, nine loads; the gauge with reversed polarity is {found}");
        card.text = "Strokes show the gauges, arrows the loads. One gauge has reversed polarity on purpose.".to_owned();
        let number = |share: f64, what: &str| (percent(share), what.to_owned());
        card.numbers = vec![
            number(figures.before, "error of the wheel loads as measured"),
            number(figures.after, "with the gauge corrected"),
            number(figures.payload, "error of the payload"),
        ];
        card
    };
    plan.map(of).into_iter().collect()
}

fn card(c: &Chapter) -> Card {
    let link = |words: &str, file: &str| (words.to_owned(), format!("{}/{file}", c.folder));
    let mut card = c.step.card.clone();
    card.title = format!("{} ({})", c.title, c.folder);
    card.text.clone_from(&c.words);
    card.numbers.clone_from(&c.numbers);
    card.links = vec![
        link(&format!("report of {}", c.folder), "report.html"),
        link(&format!("numbers of {}", c.folder), "result.json"),
    ];
    card.is_bad = (c.step.findings.iter()).any(|f| f.severity == Severity::Error);
    card
}
