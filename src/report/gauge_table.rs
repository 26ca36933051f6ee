//! The table of gauges of a layout as text.

use super::strain::gauges_csv;
use crate::host::fault::{Fault, Faults};
use crate::workflow::place::CertifiedLayout;

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
