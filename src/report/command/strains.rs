//! Report files and console output of `strains`.

use super::{Report, write_page};
use crate::fe::CaseResult;
use crate::fe::strain_rows::{StrainRow, largest_strain, largest_strain_rows};
use crate::finding::list_few;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{KeyNumber, Page};
use crate::report::strain::strains_page;
use crate::report::{strains_columns, write_strains};
use crate::units::number;
use crate::workflow::strains::Strains;

impl Report for Outcome<Strains> {
    const FILES: &'static [&'static str] = &["result.json", "report.html", "strains.csv"];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        out.declare("strains.csv", strains_columns());
        out.write("strains.csv", |mut w| {
            write_strains(&self.model, &self.solution, &mut w).map(|_| ())
        })?;
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let title = format!("Strain of {}", self.given);
        let page = strains_page(&title, &self.model, &self.solution, &self.findings);
        Some(page)
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        vec![
            KeyNumber::new(self.rows.to_string(), "rows of strains.csv"),
            KeyNumber::new(self.subcases.to_string(), "static subcases"),
            KeyNumber::new(self.model.shells.len().to_string(), "shells of the model"),
        ]
    }

    /// Returns a row for each subcase: its element of the largest strain.
    fn result_table(&self) -> ConsoleTable {
        let row = |case: &CaseResult| {
            let largest = largest_strain_rows(&self.model, case, 1);
            let of = |of: &dyn Fn(&StrainRow) -> String| {
                largest.first().map_or_else(|| "-".to_owned(), of)
            };
            vec![
                format!("{} {}", case.subcase, case.label).trim().to_owned(),
                of(&|r| number(1e6 * largest_strain(r))),
                of(&|r| format!("{} {}", r.card, r.element)),
            ]
        };
        ConsoleTable::new(
            "Largest strain of each subcase in any direction",
            &["subcase", "strain, µε", "element"],
            self.solution.cases.iter().map(row).collect(),
        )
    }

    fn console(&self) -> Console {
        let fields = [
            ("subcases", list_few(&self.subcase_ids)),
            ("rows of strains.csv", self.rows.to_string()),
        ];
        Console::new(ConsoleTable::of_fields("", &fields), Some("strains.csv"))
            .next(format!("run `strainbridge init {}` for a job", self.given))
    }
}
