//! Input of the PDF template: the page as JSON, with printable text only.

use super::columns::{LONGEST_WORD, TableLayout, fit_table, is_numeric};
use super::glyphs::{make_breakable, make_printable, short_printable};
use super::shapes::picture_json;
use crate::finding::{Finding, Severity};
use crate::host::words::{capitalize, numbers_in_words};
use crate::report::drawing::picture::Picture;
use crate::report::drawing::{STROKES, pictures, views};
use crate::report::page::{Block, Card, Page, Paper, Section, Table};
use serde_json::{Value, json};

/// Origin of a report.
#[derive(Clone, Copy, Debug)]
pub struct Origin<'a> {
    /// Program and version.
    pub program: &'a str,
    /// Command that wrote the report.
    pub command: &'a str,
    /// Files read: path and SHA-256, hexadecimal.
    pub inputs: &'a [(String, String)],
    /// Quantity and unit.
    pub units: &'a [(String, String)],
}

/// Longest word of running text that is not broken.
const IN_TEXT: usize = 48;
/// Maximum number of rows of a table and lines of a text on paper. The files contain all of them.
const MOST_ROWS: usize = 2000;

/// Returns the content of a page as JSON for the Typst template.
pub(super) fn content(page: &Page, origin: &Origin) -> Value {
    let findings: Vec<Value> = page.worst_first().into_iter().map(finding).collect();
    let units: Vec<[String; 2]> = origin
        .units
        .iter()
        .map(|(q, u)| [make_printable(q), make_printable(u)])
        .collect();
    let inputs: Vec<[String; 2]> = origin
        .inputs
        .iter()
        .map(|(path, hash)| [make_breakable(path, 40), hash.clone()])
        .collect();
    json!({
        "title": make_breakable(&page.title, IN_TEXT),
        "plain_title": make_printable(&page.title),
        "running": short_printable(&page.title, 80),
        "summary": make_breakable(&page.summary, IN_TEXT),
        "lead": make_printable(&page.lead),
        "running_lead": short_printable(&page.lead, 50),
        "program": origin.program,
        "command": origin.command,
        "units": units,
        "inputs": inputs,
        "findings": findings,
        "sheets": sheets(&page.sections),
        "signed": page.paper == Paper::Signed,
    })
}

fn finding(f: &Finding) -> Value {
    let (word, colour) = match f.severity {
        Severity::Error => ("Error", "#c0392b"),
        Severity::Warning => ("Warning", "#d68910"),
        Severity::Info => ("Note", "#5d7f9e"),
    };
    let numbers = numbers_in_words(f);
    let numbers = numbers.map_or_else(String::new, |words| format!("{}.", capitalize(&words)));
    json!({
        "word": word,
        "colour": colour,
        "subject": make_breakable(&f.subject, IN_TEXT),
        "message": make_breakable(&f.message, IN_TEXT),
        "numbers": numbers,
        "remedy": make_breakable(&f.remedy, IN_TEXT),
    })
}

/// Groups the sections by page orientation. Consecutive sections with one orientation share their pages.
fn sheets(sections: &[Section]) -> Vec<Value> {
    let mut out: Vec<(bool, Vec<Value>)> = Vec::new();
    for s in sections {
        let blocks = blocks(&s.blocks);
        let across = blocks.iter().any(|b| b["across"] == true);
        let section = json!({ "title": make_printable(&s.title), "blocks": blocks });
        match out.last_mut() {
            Some((last, list)) if *last == across => list.push(section),
            _ => out.push((across, vec![section])),
        }
    }
    out.into_iter()
        .map(|(across, sections)| json!({ "across": across, "sections": sections }))
        .collect()
}

fn blocks(list: &[Block]) -> Vec<Value> {
    list.iter().flat_map(block).collect()
}

fn block(b: &Block) -> Vec<Value> {
    let words = |kind: &str, t: &str| json!({ "kind": kind, "text": make_breakable(t, IN_TEXT) });
    match b {
        Block::Text(t) => vec![words("text", t)],
        Block::Note(t) => vec![words("note", t)],
        Block::Stressed(lead, rest) => vec![json!({
            "kind": "stressed", "lead": make_breakable(lead, IN_TEXT), "text": make_breakable(rest, IN_TEXT),
        })],
        Block::Table(t) => table(t),
        Block::Figure(f) => {
            let left = f.choices.len().saturating_sub(f.on_paper);
            let mut out = picture_blocks(pictures(f));
            out.push(words("note", &f.caption));
            if left > 0 && f.on_paper > 1 {
                let n = f.choices.len();
                let note = format!("The first {} of {n}; all are in report.html.", f.on_paper);
                out.push(words("note", &note));
            }
            out
        }
        Block::Scene(s) => {
            let mut out = picture_blocks(views(s));
            out.push(words("note", &s.caption));
            if s.marks.iter().any(|m| m.axes.is_some()) {
                out.push(words("note", STROKES));
            }
            out
        }
        Block::Lines(t) => {
            let lines: Vec<String> = t.lines().take(MOST_ROWS).map(make_printable).collect();
            vec![json!({ "kind": "lines", "lines": lines })]
        }
        Block::Cards(cards) => cards.iter().flat_map(card).collect(),
        // Paper has no links.
        Block::Links(_) => Vec::new(),
        Block::Folded { summary, blocks } => {
            let mut out = vec![words("heading", summary)];
            out.extend(self::blocks(blocks));
            out
        }
    }
}

fn card(c: &Card) -> Vec<Value> {
    let words = |kind: &str, t: &str| json!({ "kind": kind, "text": make_breakable(t, IN_TEXT) });
    let mut out = vec![words("heading", &c.title), words("text", &c.text)];
    out.extend(picture_blocks(c.picture.iter().cloned().collect()));
    let number = |(value, what): &(String, String)| words("note", &format!("{value} {what}"));
    out.extend(c.numbers.iter().map(number));
    out
}

fn picture_blocks(pictures: Vec<Picture>) -> Vec<Value> {
    let value = |p: Picture| json!({ "kind": "picture", "picture": picture_json(&p) });
    pictures.into_iter().map(value).collect()
}

fn table(t: &Table) -> Vec<Value> {
    let mut out: Vec<Value> = fit_table(t).iter().map(|f| piece(t, f)).collect();
    if t.rows.len() > MOST_ROWS {
        let n = t.rows.len();
        let text =
            format!("The first {MOST_ROWS} of {n} rows; all are in the tables in this folder.");
        out.push(json!({ "kind": "note", "text": text }));
    }
    out
}

fn piece(t: &Table, f: &TableLayout) -> Value {
    let cell = |row: &Vec<String>, c: &usize| {
        let text = row.get(*c).map_or("", String::as_str);
        make_breakable(text, LONGEST_WORD)
    };
    let line =
        |row: &Vec<String>| -> Vec<String> { f.columns.iter().map(|c| cell(row, c)).collect() };
    let right: Vec<bool> = f.columns.iter().map(|c| is_numeric(t, *c)).collect();
    json!({
        "kind": "table",
        "across": f.across,
        "halved": f.halved,
        "size": f.size,
        "right": right,
        "head": if t.head.is_empty() { Vec::new() } else { line(&t.head) },
        "rows": t.rows.iter().take(MOST_ROWS).map(line).collect::<Vec<_>>(),
    })
}
