//! Files and words of `cases`.

use super::{Report, write_page};
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::page::Page;
use crate::workflow::cases::UnitLoadDeck;

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
            Vec::new(),
        );
        Some(page)
    }

    fn words(&self) -> String {
        let n = self.subcases.len();
        format!(
            "unit_loads.bdf: {n} subcase{}; the structure is {}\n",
            if n == 1 { "" } else { "s" },
            self.support
        )
    }
}
