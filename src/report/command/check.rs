//! Report files and console output of `check`.

use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::model::Model;
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{Block, KeyNumber, Page, Section};
use crate::report::scene::{Places, scene_of_model, scene_section};
use crate::workflow::check::CheckedFiles;

impl Report for Outcome<CheckedFiles> {
    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        Some(page(self))
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        let files = self.decks.len() + self.results.len() + self.records.len() + self.jobs.len();
        let mut numbers = vec![
            KeyNumber::new(files.to_string(), "files read"),
            KeyNumber::new(self.faults.len().to_string(), "faults"),
        ];
        if let Some(deck) = self.decks.first() {
            let [grids, elements] = deck.counts();
            numbers.push(KeyNumber::new(grids.to_string(), "grids"));
            numbers.push(KeyNumber::new(elements.to_string(), "elements"));
        }
        numbers
    }

    fn console(&self) -> Console {
        let decks = self.decks.iter().map(|d| d.text());
        let results = self.results.iter().map(|r| r.text());
        let records = self.records.iter().map(|r| r.text());
        let jobs = self.jobs.iter().cloned();
        let all = jobs.chain(decks).chain(results).chain(records);
        let rows = all.flat_map(|text| {
            let row = |line: &str| {
                // Further lines of a text are aligned below the first.
                let kind = line.split_once(' ').filter(|_| !line.starts_with(' '));
                let (kind, text) = kind.unwrap_or(("", line.trim_start()));
                vec![kind.to_owned(), text.to_owned()]
            };
            text.lines().map(row).collect::<Vec<_>>()
        });
        let table = ConsoleTable::new("", &[], rows.collect());
        Console {
            next: self.next_step(),
            ..Console::new(table, None)
        }
    }
}

/// Faults, then every file as on the terminal.
fn page(found: &Outcome<CheckedFiles>) -> Page {
    let faults: Vec<Vec<String>> = found.faults.iter().map(|f| vec![f.to_string()]).collect();
    let list = match faults.is_empty() {
        true => Block::Text("None.".into()),
        false => Block::table(&["file:line: field: what is wrong: what to do"], faults),
    };
    let mut sections = vec![Section::new("Faults", vec![list])];
    let lines_section = |title: &str, text: String| Section::new(title, vec![Block::Lines(text)]);
    for d in &found.decks {
        sections.push(lines_section("Deck", d.text()));
        let drawn = |m: &&Model| !(m.shells.is_empty() && m.solids.is_empty());
        if let Some(model) = d.model().filter(drawn) {
            let places = found
                .candidates
                .as_ref()
                .map_or_else(Places::default, Places::from_candidates);
            sections.push(scene_section("Model", &scene_of_model(model, places)));
        }
    }
    let results = found.results.iter();
    sections.extend(results.map(|r| lines_section("Results", r.text())));
    let records = found.records.iter();
    sections.extend(records.map(|r| lines_section("Record", r.text())));
    Page::new("Check", "Contents of the files", &found.findings, sections)
}
