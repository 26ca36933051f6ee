//! Reports: `report.html` as soon as a command has its page, `report.pdf` once everything that it must state is known.

use super::Session;
use super::fault::Faults;
use crate::report::page::Page;
use std::path::Path;

impl Session<'_> {
    /// Writes `report.html`; a page that is meant for paper is kept for [`Session::write_paper`].
    ///
    /// # Errors
    /// A fault where it can't be written.
    pub fn write_page(&mut self, main_input: &Path, page: Page) -> Result<(), Faults> {
        self.output_for(main_input)?
            .write_bytes("report.html", page.to_html().as_bytes())
            .map_err(Faults::from)?;
        #[cfg(feature = "pdf")]
        if page.paper != crate::report::page::Paper::None {
            self.paper = Some(page);
        }
        Ok(())
    }

    /// Writes `report.pdf` of the page that was kept, with all findings, inputs and units.
    ///
    /// # Errors
    /// A fault where it can't be drawn, which is a mistake of the program.
    #[cfg(feature = "pdf")]
    pub(super) fn write_paper(&mut self) -> Result<(), Faults> {
        use super::fault::Fault;
        use crate::report::pdf::{Origin, write_pdf};
        let Some(mut page) = self.paper.take() else {
            return Ok(());
        };
        page.findings = self.findings.clone();
        let inputs = self.inputs.list();
        let inputs: Vec<(String, String)> =
            inputs.into_iter().map(|i| (i.path, i.sha256)).collect();
        let units = self.units_in_words();
        let origin = Origin {
            program: concat!("strainbridge ", env!("CARGO_PKG_VERSION")),
            command: self.command,
            inputs: &inputs,
            units: &units,
        };
        let drawn = self.stage("report.pdf", |_| write_pdf(&page, &origin));
        let bytes = drawn.map_err(|e| {
            Faults::from(Fault::of(
                "report.pdf",
                "page",
                e.to_string(),
                "report this as an error of the program",
            ))
        })?;
        // The page came from a command that has its folder.
        match self.output.as_mut() {
            Some(output) => output
                .write_bytes("report.pdf", &bytes)
                .map_err(Faults::from),
            None => Ok(()),
        }
    }

    /// What the numbers are counted in, by quantity.
    #[cfg(feature = "pdf")]
    fn units_in_words(&self) -> Vec<(String, String)> {
        let stated = self.units.list().iter();
        let (system, mut units): (Vec<_>, Vec<_>) = stated
            .map(|(quantity, unit)| ((*quantity).to_owned(), unit.clone()))
            .partition(|(quantity, _)| quantity == "system");
        let system = system.into_iter().map(|s| ("model and job in".into(), s.1));
        units.extend(system);
        units
    }
}
