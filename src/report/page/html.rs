//! A page as one HTML file: no script from elsewhere, findings first.

use super::block::{Block, Card, Page, Table};
use crate::finding::{Finding, Severity};
use crate::report::drawing::picture::Picture;
use crate::report::drawing::{pictures, to_svg};
use crate::report::figure::scripts;
use crate::units::number;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("page.css");

impl Page {
    /// `report.html`: works from the file, without a network.
    pub fn to_html(&self) -> String {
        let findings = self.worst_first();
        let sections = html! {
            @for s in &self.sections {
                section { h2 { (s.title) } @for b in &s.blocks { (block(b)) } }
            }
        };
        let scripts = scripts(&sections.0);
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width,initial-scale=1";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) }
                    noscript { style { ".controls,.pick,.bar,.tools,.canvas{display:none}" } }
                }
                body {
                    h1 { (self.title) }
                    @if !self.summary.is_empty() { p.summary { b { (self.summary) } } }
                    p.muted { (self.lead) }
                    @if !(findings.is_empty() && self.is_of_cards()) {
                        h2 { "Findings" }
                        (judged(&findings))
                    }
                    (sections)
                    (PreEscaped(scripts))
                }
            }
        }
        .into_string()
    }
}

/// Whether the answer can be relied on, and why.
pub(in crate::report) fn judged(findings: &[&Finding]) -> Markup {
    html! { (verdict(findings)) (listed(findings)) }
}

/// A block as a page has it.
pub(in crate::report) fn block(b: &Block) -> Markup {
    match b {
        Block::Text(t) => html! { p { (t) } },
        Block::Stressed(lead, rest) => html! { p { b { (lead) } " " (rest) } },
        Block::Note(t) => html! { p.muted { (t) } },
        Block::Table(t) => table(t),
        Block::Figure(f) => html! {
            (f)
            noscript { @for p in pictures(f) { (still(&p, &f.label)) } }
        },
        Block::Scene(s) => html! {
            (s.markup)
            noscript { (still(&s.still, "the model with its gauges and loads")) }
        },
        Block::Lines(t) => html! { pre { (t) } },
        Block::Cards(cards) => html! { div.cards { @for c in cards { (card(c)) } } },
        Block::Links(links) => html! { p.muted { (list_of_links(links)) } },
        Block::Folded { summary, blocks } => html! {
            details { summary { (summary) } @for b in blocks { (block(b)) } }
        },
    }
}

fn list_of_links(links: &[(String, String)]) -> Markup {
    html! {
        @for (i, (words, path)) in links.iter().enumerate() {
            @if i > 0 { " · " }
            a href=(path) { (words) }
        }
    }
}

/// A picture that needs no script.
fn still(picture: &Picture, label: &str) -> Markup {
    html! {
        figure.plot {
            @if !picture.title.is_empty() { b { (picture.title) } }
            (to_svg(picture, label))
            @if !picture.caption.is_empty() { figcaption.muted { (picture.caption) } }
        }
    }
}

fn card(c: &Card) -> Markup {
    html! {
        article.card.bad[c.is_bad] {
            h3 { (c.title) }
            @if c.is_bad { p { b { "This result cannot be relied on." } } }
            @if let Some(p) = &c.picture { (to_svg(p, &format!("Picture: {}", c.title))) }
            p { (c.text) }
            p.numbers { @for (value, what) in &c.numbers { span { b { (value) } " " (what) } } }
            @if !c.links.is_empty() { p { (list_of_links(&c.links)) } }
        }
    }
}

/// A table that scrolls sideways on narrow screens.
fn table(t: &Table) -> Markup {
    html! {
        div.scroll {
            table {
                @if !t.head.is_empty() { tr { @for h in &t.head { th { (h) } } } }
                @for (r, row) in t.rows.iter().enumerate() {
                    tr { @for (c, cell) in row.iter().enumerate() { td { (linked(t, r, c, cell)) } } }
                }
            }
        }
    }
}

/// A cell, as a link where it leads to a file.
fn linked(t: &Table, row: usize, column: usize, cell: &str) -> Markup {
    // Links stand in the order of their rows.
    let first = t.links.partition_point(|l| l.row < row);
    let mut of_row = t.links.iter().skip(first).take_while(|l| l.row == row);
    match of_row.find(|l| l.column == column) {
        Some(l) => html! { a href=(reference(&l.path)) title=(l.title) { (cell) } },
        None => html! { (cell) },
    }
}

/// A path as a reference of a page: what has a meaning there by its number.
fn reference(path: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"-_.~/".contains(&b);
    let mut out = String::new();
    for b in path.replace('\\', "/").bytes() {
        match plain(b) {
            true => out.push(char::from(b)),
            false => out.push_str(&format!("%{b:02X}")),
        }
    }
    out
}

/// Whether the answer can be relied on, and how much there is to say of it.
fn verdict(findings: &[&Finding]) -> Markup {
    let count = |severity, one: &str, many: &str| {
        let n = findings.iter().filter(|f| f.severity == severity).count();
        match n {
            0 => None,
            1 => Some(format!("1 {one}")),
            n => Some(format!("{n} {many}")),
        }
    };
    let errors = count(Severity::Error, "error", "errors");
    let warnings = count(Severity::Warning, "warning", "warnings");
    let lead = match (&errors, &warnings) {
        (Some(_), _) => "This answer can't be relied on: ",
        (None, Some(_)) => "Look before you trust this answer: ",
        (None, None) => "Nothing speaks against this answer: ",
    };
    let counts = [errors, warnings, count(Severity::Info, "note", "notes")];
    let said: Vec<String> = counts.into_iter().flatten().collect();
    html! {
        @if said.is_empty() { p { "None." } } @else { p { b { (lead) } (said.join(", ")) "." } }
    }
}

/// The findings by code: of those that are alike the first, the others folded; notes folded altogether.
fn listed(findings: &[&Finding]) -> Markup {
    let mut groups: Vec<Vec<&Finding>> = Vec::new();
    for &f in findings {
        let alike = |g: &&mut Vec<&Finding>| {
            g.iter()
                .any(|o| (o.severity, o.code) == (f.severity, f.code))
        };
        match groups.iter_mut().find(alike) {
            Some(group) => group.push(f),
            None => groups.push(vec![f]),
        }
    }
    let is_note = |g: &Vec<&Finding>| g.iter().all(|f| f.severity == Severity::Info);
    let (notes, serious): (Vec<_>, Vec<_>) = groups.into_iter().partition(is_note);
    html! {
        @for g in &serious { (group(g)) }
        @if !notes.is_empty() {
            details { summary { "Notes" } @for g in &notes { (group(g)) } }
        }
    }
}

/// Findings of one code.
fn group(findings: &[&Finding]) -> Markup {
    let more = findings.len().saturating_sub(1);
    html! {
        @for f in findings.iter().take(1) { (finding(f)) }
        @if more > 0 {
            details { summary { (more) " more like it" } @for f in findings.iter().skip(1) { (finding(f)) } }
        }
    }
}

fn finding(f: &Finding) -> Markup {
    let (class, word) = match f.severity {
        Severity::Error => ("f error", "error"),
        Severity::Warning => ("f warning", "warning"),
        Severity::Info => ("f info", "note"),
    };
    html! {
        div class=(class) {
            b { (word) } " · " (f.subject) ": " (f.message.trim_end_matches('.')) "."
            @if let Some((m, limit)) = f.shown_numbers() {
                small { " Measured " (number(m)) @if let Some(l) = limit { ", limit " (number(l)) } "." }
            }
            @if !f.remedy.is_empty() { div { small { "What to do: " (f.remedy.trim_end_matches('.')) "." } } }
        }
    }
}
