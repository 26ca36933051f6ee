//! The frame of a report page: one file, no script from elsewhere, findings first.

use crate::finding::{Finding, Severity};
use crate::report::figure::{DRAWN, Figure, scripts};
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// A titled part of a page.
pub struct Section {
    /// Heading.
    pub title: String,
    /// Content.
    pub body: Markup,
}

/// A part that is a table with a note under it.
pub fn table_section(title: &str, header: &[&str], rows: &[Vec<String>], note: &str) -> Section {
    Section {
        title: title.to_owned(),
        body: html! {
            (table(header, rows))
            @if !note.is_empty() { p.muted { (note) } }
        },
    }
}

/// A part that is a figure with a note under it.
pub fn figure_section(title: &str, figure: &Figure, note: &str) -> Section {
    Section {
        title: title.to_owned(),
        body: html! { (figure) @if !note.is_empty() { p.muted { (note) } } },
    }
}

const STYLE: &str = include_str!("page.css");

/// A page with `lead` under its title, findings, then the sections.
pub fn page(title: &str, lead: &str, findings: &[Finding], sections: Vec<Section>) -> String {
    let mut sorted: Vec<&Finding> = findings.iter().collect();
    sorted.sort_by_key(|f| std::cmp::Reverse(f.severity));
    let drawn = sections.iter().any(|s| s.body.0.contains(DRAWN));
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width,initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (title) }
                p.muted { (lead) }
                h2 { "Findings" }
                @if sorted.is_empty() { p { "None." } }
                @for f in sorted { (finding(f)) }
                @for s in sections {
                    section { h2 { (s.title) } (s.body) }
                }
                @if drawn { (PreEscaped(scripts())) }
            }
        }
    }
    .into_string()
}

/// A table that scrolls sideways on narrow screens.
pub fn table(head: &[&str], rows: &[Vec<String>]) -> Markup {
    html! {
        div.scroll {
            table {
                tr { @for h in head { th { (h) } } }
                @for row in rows { tr { @for cell in row { td { (cell) } } } }
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

/// Four significant digits.
pub fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !x.is_finite() {
        return "∞".into();
    }
    let digits = x.abs().log10().floor() as i32;
    if (-4..6).contains(&digits) {
        format!("{x:.*}", (3 - digits).max(0) as usize)
    } else {
        format!("{x:.3e}")
    }
}
