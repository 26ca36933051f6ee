//! Report files and console output of `verify`.

use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{KeyNumber, Page, table_section};
use crate::workflow::verify::{Difference, Recomputation};

fn equal_file_row(file: &str) -> Vec<String> {
    vec![file.to_owned(), "the same".to_owned()]
}

impl Report for Outcome<Recomputation> {
    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let row = |d: &Difference| vec![d.file.clone(), d.at.clone(), d.was.clone(), d.now.clone()];
        let mut sections = Vec::new();
        if !self.differs.is_empty() {
            sections.push(table_section(
                "Differences",
                &["file", "where", "in the folder", "now"],
                &self.differs.iter().map(row).collect::<Vec<_>>(),
                "",
            ));
        }
        sections.push(table_section(
            "Files that are the same",
            &["file", "check"],
            &self.same.iter().map(|f| equal_file_row(f)).collect::<Vec<_>>(),
            "An input is unchanged if it has the digest that the folder states. A table, page or `result.json` is unchanged if its inputs give the same content now.",
        ));
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

    /// Returns a row for each check, the differences first. There is no picture: bytes and numbers are compared.
    fn result_table(&self) -> ConsoleTable {
        let differs = self.differs.iter().map(|d| {
            let place = format!("{} {}", d.file, d.at).trim().to_owned();
            vec![place, "differs".to_owned()]
        });
        let same = self.same.iter().map(|f| equal_file_row(f));
        ConsoleTable::new(
            "Checks of inputs and files",
            &["file", "check"],
            differs.chain(same).collect(),
        )
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
