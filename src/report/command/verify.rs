//! Files and words of `verify`.

use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::page::{Block, Page, Section};
use crate::workflow::verify::Verified;

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

    fn words(&self) -> String {
        let mut text = format!(
            "{} the same, {} differences\n",
            self.same.len(),
            self.differs.len()
        );
        for d in &self.differs {
            let at = if d.at.is_empty() {
                String::new()
            } else {
                format!(" {}", d.at)
            };
            text.push_str(&format!("{}{at}: was {}, is {}\n", d.file, d.was, d.now));
        }
        text
    }
}
