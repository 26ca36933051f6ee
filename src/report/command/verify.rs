//! Files and words of `verify`.

use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{Block, KeyNumber, Page, Section};
use crate::workflow::verify::{Difference, Verified};

impl Report for Outcome<Verified> {
    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let rows: Vec<Vec<String>> = self
            .differs
            .iter()
            .map(|d| vec![d.file.clone(), d.at.clone(), d.was.clone(), d.now.clone()])
            .collect();
        let differs = match rows.is_empty() {
            true => Block::Text("Nothing.".into()),
            false => Block::table(&["file", "where", "in the folder", "now"], rows),
        };
        let sections = vec![
            Section::new("Differs", vec![differs]),
            Section::new("Same", vec![Block::Lines(self.same.join("\n"))]),
        ];
        let page = Page::new(
            "Verify",
            "A result folder recomputed",
            &self.findings,
            sections,
        );
        Some(page)
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        vec![
            KeyNumber::new(self.same.len().to_string(), "files that are equal"),
            KeyNumber::new(self.differs.len().to_string(), "differences"),
        ]
    }

    fn console(&self) -> Console {
        let row = |d: &Difference| {
            let cells = [&d.file, &d.at, &d.was, &d.now];
            cells.map(String::clone).to_vec()
        };
        let table = ConsoleTable::new(
            "Differences",
            &["file", "where", "in the folder", "now"],
            self.differs.iter().map(row).collect(),
        );
        Console::new(table, None).next(match self.differs.is_empty() {
            true => "keep the folder together with its inputs",
            false => "restore the inputs that differ, or run the command of the folder again",
        })
    }
}
