//! The first screen of a page: the sentence, key numbers, the picture and the table of the result.

use super::block::{Block, Page, Table};
use super::findings::{FindingsBySeverity, group, groups_of, passed_conditions};
use super::table::{list_of_links, table};
use crate::finding::Finding;
use crate::host::words::count_of;
use crate::report::drawing::picture::Picture;
use crate::report::drawing::{card_picture, pictures, to_svg};
use crate::report::figure::Figure;
use maud::{Markup, html};

/// Rows that the table of a first screen has room for; the file and the sections below have all.
const MOST_ROWS: usize = 14;

/// Groups of errors shown open above the picture. Further groups follow below it.
const OPEN_ERRORS: usize = 2;

/// Returns the first screen as HTML.
pub(super) fn first_screen(page: &Page, findings: &FindingsBySeverity) -> Markup {
    let picture = first_picture(page);
    let (class, sign, word) = mark(findings);
    let errors = groups_of(&findings.errors);
    let has_table = !page.first.table.rows.is_empty();
    html! {
        div.first {
            header {
                h1 { (page.title) }
                p.muted {
                    (page.lead)
                    @if !page.first.command.is_empty() {
                        @if !page.lead.is_empty() { " · " }
                        "strainbridge " (page.first.command) " " (env!("CARGO_PKG_VERSION"))
                    }
                }
            }
            div class={ "verdict " (class) } {
                span.mark role="img" aria-label=(word) { (sign) }
                p.summary { b { (page.summary) } }
            }
            @for g in errors.iter().take(OPEN_ERRORS) { (group(g)) }
            @if !findings.warnings.is_empty() { (fold_findings("warning", &findings.warnings)) }
            @if !page.first.numbers.is_empty() {
                dl.tiles { @for n in &page.first.numbers {
                    div.tile { dt { (n.meaning) } dd { (n.value) } }
                } }
            }
            @if picture.is_some() || has_table {
                div class=(if picture.is_some() && has_table { "two" } else { "one" }) {
                    @if let Some(p) = &picture { (p.markup(page)) }
                    @if has_table { (result_table(page)) }
                }
            }
        }
        @for g in errors.iter().skip(OPEN_ERRORS) { (group(g)) }
    }
}

/// Returns CSS class, symbol and label of the mark before the summary.
fn mark(findings: &FindingsBySeverity) -> (&'static str, &'static str, &'static str) {
    match (findings.errors.is_empty(), findings.warnings.is_empty()) {
        (false, _) => ("bad", "✕", "error"),
        (true, false) => ("warn", "!", "usable, with warnings"),
        (true, true) => ("good", "✓", "no errors, no warnings"),
    }
}

/// Findings of one severity, folded under a heading with their number and their codes in plain words.
fn fold_findings(what: &str, findings: &[&Finding]) -> Markup {
    let groups = groups_of(findings);
    html! {
        details.folded {
            summary { (count_of(findings.len(), what)) ": " (codes_in_words(&groups)) }
            @for g in &groups { (group(g)) }
        }
    }
}

fn codes_in_words(groups: &[Vec<&Finding>]) -> String {
    let words = |g: &Vec<&Finding>| g.first().map(|f| f.code.replace('-', " "));
    let words: Vec<String> = groups.iter().filter_map(words).collect();
    words.join(", ")
}

/// Returns the notes, and the conditions that the command tested and did not find.
pub(super) fn notes_and_tests(page: &Page, findings: &FindingsBySeverity) -> Markup {
    let passed = passed_conditions(page.first.command, &page.findings);
    let notes = groups_of(&findings.notes);
    html! {
        @if !(notes.is_empty() && passed.is_empty()) {
            section {
                h2 { "Notes and tests" }
                @if !notes.is_empty() { (fold_findings("note", &findings.notes)) }
                @if !passed.is_empty() {
                    details.folded {
                        summary { (count_of(passed.len(), "condition")) " tested and not found" }
                        p.muted { "`" (page.first.command) "` reports each of these if it applies to the job. This result contains none of them." }
                        ul.passed { @for c in &passed { li { b { (c.code.replace('-', " ")) } " (limit: " (c.limit.trim_end_matches('.')) ")" } } }
                    }
                }
            }
        }
    }
}

/// The table of the result, as many rows as fit.
fn result_table(page: &Page) -> Markup {
    let first = &page.first;
    let all = first.table.rows.len();
    let kept = match all <= MOST_ROWS {
        true => all,
        false => MOST_ROWS - 1,
    };
    let shown = Table {
        head: first.table.head.clone(),
        rows: first.table.rows.iter().take(kept).cloned().collect(),
        links: Vec::new(),
    };
    html! {
        div.result {
            (table(&shown, &first.title))
            @if kept < all {
                p.muted {
                    "The first " (kept) " of " (all) " rows"
                    @if let Some(file) = first.file { "; all are in " (list_of_links(&[(file.to_owned(), file.to_owned())])) }
                    "."
                }
            }
        }
    }
}

/// The picture of a first screen.
struct FirstPicture {
    picture: Picture,
    /// For the width of a phone.
    narrow: Option<Picture>,
    label: String,
    caption: String,
    /// Number of the section that shows more, from 1.
    section: usize,
    is_model: bool,
}

impl FirstPicture {
    fn markup(&self, page: &Page) -> Markup {
        let section = self.section.checked_sub(1);
        let title = section
            .and_then(|i| page.sections.get(i))
            .map_or("", |s| s.title.as_str());
        html! {
            figure.picture {
                div.model[self.is_model].wide[self.narrow.is_some()] { (to_svg(&self.picture, &self.label)) }
                @if let Some(narrow) = &self.narrow { div.narrow { (to_svg(narrow, &self.label)) } }
                figcaption.muted {
                    (self.caption) " "
                    @if self.is_model { "Turn, zoom and point at things in " } @else { "More in " }
                    a href=(format!("#s{}", self.section)) { (title) }
                    "."
                }
            }
        }
    }
}

/// The model of a page; without one the first figure.
fn first_picture(page: &Page) -> Option<FirstPicture> {
    let blocks = || {
        let sections = page.sections.iter().enumerate();
        sections.flat_map(|(i, s)| s.blocks.iter().map(move |b| (i + 1, b)))
    };
    let model = blocks().find_map(|(section, b)| match b {
        Block::Scene(s) => Some(FirstPicture {
            picture: s.still.clone(),
            narrow: None,
            label: MODEL.to_owned(),
            caption: format!("{} {}", s.caption, s.still.caption),
            section,
            is_model: true,
        }),
        _ => None,
    });
    // A low figure of a few rows shows little at this size.
    let tall = |f: &Figure| f.height >= TALL;
    let has_tall = blocks().any(|b| matches!(b.1, Block::Figure(f) if tall(f)));
    let figure = || {
        blocks().find_map(|(section, b)| match b {
            Block::Figure(f) if tall(f) || !has_tall => Some(FirstPicture {
                picture: pictures(f).into_iter().next()?,
                narrow: card_picture(f),
                label: f.label.clone(),
                caption: f.caption.clone(),
                section,
                is_model: false,
            }),
            _ => None,
        })
    };
    model.or_else(figure)
}

/// Pixels of a figure that fills the space of a picture.
const TALL: usize = 200;

/// Label of the still picture of a model.
const MODEL: &str = "the model with its gauges and loads";
