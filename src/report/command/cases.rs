//! Report files and console output of `cases`.

use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{KeyNumber, Page};
use crate::report::scene::{scene_of_loads, scene_section};
use crate::units::number;
use crate::workflow::cases::UnitLoadDeck;
use serde_json::Value;

impl Report for Outcome<UnitLoadDeck> {
    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        let folder = out.folder().to_owned();
        for (name, bytes) in self.edited.files(&folder) {
            out.write_bytes(&name, &bytes)?;
        }
        write_page(out, self)
    }

    fn page(&self) -> Option<Page> {
        let page = Page::new(
            &self.title,
            "Unit-load deck: run unit_loads.bdf, then name its OP2 as [model] results",
            &self.findings,
            vec![scene_section(
                "Loads",
                &scene_of_loads(&self.job, &self.model),
            )],
        );
        Some(page)
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        vec![
            KeyNumber::new(self.subcases.len().to_string(), "unit-load subcases"),
            KeyNumber::new(self.support.clone(), "structure"),
        ]
    }

    fn console(&self) -> Console {
        let cell = |v: &Value| v.as_str().map_or_else(|| v.to_string(), str::to_owned);
        let row = |s: &Value| {
            let applied = s["applied"].as_f64().unwrap_or(f64::NAN);
            vec![cell(&s["subcase"]), cell(&s["load"]), number(applied)]
        };
        let table = ConsoleTable::new(
            "Subcases of unit_loads.bdf, applied loads in job units",
            &["subcase", "load", "applied"],
            self.subcases.iter().map(row).collect(),
        );
        Console::new(table, Some("unit_loads.bdf"))
            .next("run unit_loads.bdf with Nastran and name its OP2 as [model] results of the job")
    }
}
