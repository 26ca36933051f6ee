//! Parts of pages for a page that a server answers: content, style and scripts apart.

use super::command::{Report, live_page};
use super::figure::all_scripts;
use super::page::STYLE;
use super::strain::gauges_csv;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Answer, Outcome};
use crate::workflow::place::CertifiedLayout;

/// Returns the style of all pages.
pub fn page_style() -> &'static str {
    STYLE
}

/// Returns the scripts of all figures, together with `own`, as one text without its element.
pub fn live_scripts(own: &str) -> String {
    all_scripts(own)
}

/// Returns the content of the page of an outcome, as HTML without scripts that run; empty without a page.
pub fn page_content<A: Answer>(outcome: &Outcome<A>) -> String
where
    Outcome<A>: Report,
{
    live_page(outcome).map_or_else(String::new, |page| page.content().into_string())
}

/// Returns the text of `gauges.csv` of a layout.
///
/// # Errors
/// A layout that cannot be written as text, which is a mistake of the program.
pub fn gauges_text(layout: &CertifiedLayout) -> Result<String, Faults> {
    let mistake = |e: &dyn std::fmt::Display| {
        let remedy = "report this as an error of the program";
        Faults::from(Fault::new("gauges.csv", "file", e.to_string(), remedy))
    };
    let mut bytes = Vec::new();
    gauges_csv(
        &mut bytes,
        &layout.gauges,
        layout.job.candidates.grid_length,
    )
    .map_err(|e| mistake(&e))?;
    String::from_utf8(bytes).map_err(|e| mistake(&e))
}
