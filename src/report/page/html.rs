//! A page as one HTML file: no script from elsewhere, findings first.

use super::block::{Block, Page, Table};
use crate::finding::{Finding, Severity};
use crate::report::figure::{DRAWN, scripts};
use crate::units::number;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("../page.css");

impl Page {
    /// `report.html`: works from the file, without a network.
    pub fn to_html(&self) -> String {
        let findings = self.worst_first();
        let sections = html! {
            @for s in &self.sections {
                section { h2 { (s.title) } @for b in &s.blocks { (block(b)) } }
            }
        };
        let drawn = sections.0.contains(DRAWN);
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width,initial-scale=1";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    h1 { (self.title) }
                    p.muted { (self.lead) }
                    h2 { "Findings" }
                    @if findings.is_empty() { p { "None." } }
                    @for f in findings { (finding(f)) }
                    (sections)
                    @if drawn { (PreEscaped(scripts())) }
                }
            }
        }
        .into_string()
    }
}

fn block(b: &Block) -> Markup {
    match b {
        Block::Text(t) => html! { p { (t) } },
        Block::Stressed(lead, rest) => html! { p { b { (lead) } " " (rest) } },
        Block::Note(t) => html! { p.muted { (t) } },
        Block::Table(t) => table(t),
        Block::Figure(f) => html! { (f) },
        Block::Scene(s) => s.markup.clone(),
        Block::Lines(t) => html! { pre { (t) } },
        Block::Links(links) => html! {
            p.muted { @for (i, (words, path)) in links.iter().enumerate() {
                @if i > 0 { " · " }
                a href=(path) { (words) }
            } }
        },
        Block::Folded { summary, blocks } => html! {
            details { summary { (summary) } @for b in blocks { (block(b)) } }
        },
    }
}

/// A table that scrolls sideways on narrow screens.
fn table(t: &Table) -> Markup {
    html! {
        div.scroll {
            table {
                @if !t.head.is_empty() { tr { @for h in &t.head { th { (h) } } } }
                @for row in &t.rows { tr { @for cell in row { td { (cell) } } } }
            }
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
            b { (word) } " · " (f.subject) ": " (f.message) "."
            @if let Some(m) = f.measured {
                small { " Measured " (number(m)) @if let Some(l) = f.limit { ", limit " (number(l)) } "." }
            }
            @if !f.remedy.is_empty() { div { small { "What to do: " (f.remedy) "." } } }
        }
    }
}
