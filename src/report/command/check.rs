//! Files and words of `check`.

use super::{Report, write_page};
use crate::app::check::Checked;
use crate::app::fault::Faults;
use crate::app::outcome::Outcome;
use crate::app::output::Output;
use crate::report::page::{Block, Page, Section};

impl Report for Outcome<Checked> {
    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        write_page(out, self, page(self))
    }

    fn words(&self) -> String {
        let mut text = String::new();
        let decks = self.decks.iter().map(|d| d.text());
        let results = self.results.iter().map(|r| r.text());
        for line in self.jobs.iter().cloned().chain(decks).chain(results) {
            text.push_str(&line);
            text.push('\n');
        }
        text
    }
}

/// Faults, then every file as on the terminal.
fn page(found: &Outcome<Checked>) -> Page {
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
    Page::new("Check", "What is in the files", &found.findings, sections)
}
