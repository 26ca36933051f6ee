//! `check`: what is in the files, every fault, and whether deck and results belong together.
//!
//! [`kind`] tells files apart by content; [`decks`] and [`results`] describe them; [`jobs`] follows a job to the files it names;
//! [`together`] compares.

mod decks;
mod jobs;
mod kind;
mod results;
mod together;

use super::fault::{FaultList, Faults};
use super::{FilesArguments, Session};
use crate::finding::Finding;
use crate::report::page::{Block, Page, Section};
use decks::DeckEntry;
use kind::{Kind, kind_of};
use results::ResultEntry;
use std::path::Path;

/// What was found in all files.
#[derive(Default)]
struct Found {
    decks: Vec<DeckEntry>,
    results: Vec<ResultEntry>,
    faults: FaultList,
}

/// Reads every file and reports.
pub fn run(arguments: &FilesArguments, session: &mut Session) -> Result<(), Faults> {
    let mut found = Found::default();
    for file in &arguments.files {
        let given = file.display().to_string();
        session.stage("read", |s| look(s, Path::new(""), &given, &mut found));
    }
    session.stage("compare", |s| together::compare(s, &mut found));
    found.decks.iter().for_each(|d| session.say(d.text()));
    found.results.iter().for_each(|r| session.say(r.text()));
    session.put("decks", &found.decks)?;
    session.put("results", &found.results)?;
    let page = page_of(&found, &session.findings);
    if let Some(output) = session.output_if_asked()? {
        output
            .write_bytes("report.html", page.to_html().as_bytes())
            .map_err(Faults::from)?;
    }
    session.put_faults(found.faults);
    Ok(())
}

/// `report.html`: faults, then every file as on the terminal.
fn page_of(found: &Found, findings: &[Finding]) -> Page {
    let faults: Vec<Vec<String>> = found.faults.iter().map(|f| vec![f.to_string()]).collect();
    let list = match faults.is_empty() {
        true => Block::Text("None.".into()),
        false => Block::table(&["file:line: field: what is wrong: what to do"], faults),
    };
    let mut sections = vec![Section::new("Faults", vec![list])];
    let decks = found.decks.iter().map(|d| ("Deck", d.text()));
    let results = found.results.iter().map(|r| ("Results", r.text()));
    sections.extend(
        decks
            .chain(results)
            .map(|(title, text)| Section::new(title, vec![Block::Lines(text)])),
    );
    Page::new("Check", "What is in the files", findings, sections)
}

/// Looks into one file.
fn look(session: &mut Session, base: &Path, given: &str, found: &mut Found) {
    let bytes = match session.inputs.read(base, given) {
        Ok(b) => b,
        Err(f) => return found.faults.push(f),
    };
    match kind_of(given, &bytes) {
        Kind::Job => jobs::look(session, base, given, found),
        Kind::Deck => decks::look(session, base, given, &bytes, found),
        Kind::Results => results::look(session, given, bytes, found),
    }
}
