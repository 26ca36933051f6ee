//! The frame of a report page: one file, no script from elsewhere, findings first.

use crate::finding::{Finding, Severity};
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

/// A part that is a drawing with a note under it.
pub fn drawing_section(title: &str, svg: String, note: &str) -> Section {
    Section {
        title: title.to_owned(),
        body: html! { (PreEscaped(svg)) @if !note.is_empty() { p.muted { (note) } } },
    }
}

const STYLE: &str = "body{font:15px/1.45 system-ui,sans-serif;color:#1c2530;max-width:1100px;margin:2em auto;padding:0 1.2em}\
h1{font-size:1.6em;margin:0 0 .2em}h2{font-size:1.15em;margin:1.8em 0 .5em;border-bottom:1px solid #d6dce3;padding-bottom:.2em}\
table{border-collapse:collapse;font-size:.92em}td,th{padding:.22em .7em;text-align:right;border-bottom:1px solid #e6eaef}\
th{color:#516173;font-weight:600}td:first-child,th:first-child{text-align:left}.scroll{overflow-x:auto}\
.f{border-left:4px solid;padding:.4em .8em;margin:.5em 0;background:#f6f8fa}.error{border-color:#c0392b}.warning{border-color:#d68910}\
.info{border-color:#5d7f9e}.f b{text-transform:capitalize}.f small{color:#516173}svg{max-width:100%;height:auto}\
.small{display:flex;flex-wrap:wrap;gap:.6em}.small svg{width:11em}.muted{color:#516173}pre{white-space:pre-wrap}@media print{body{margin:0}}";

/// A page with `lead` under its title, findings, then the sections.
pub fn page(title: &str, lead: &str, findings: &[Finding], sections: Vec<Section>) -> String {
    let mut sorted: Vec<&Finding> = findings.iter().collect();
    sorted.sort_by_key(|f| std::cmp::Reverse(f.severity));
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
                    h2 { (s.title) }
                    (s.body)
                }
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
