mod assumptions;
mod bridges;
mod cause;
mod installed_position;
mod labels;
mod next;
mod overfit;
mod planted_faults;
mod repeats;
mod scatter;
mod single_load_runs;
mod synthetic;

use super::Calibration;
use crate::finding::Severity;

/// Returns severity and subject of the first finding with a code.
fn severe(c: &Calibration, code: &str) -> Option<(Severity, String)> {
    let found = c.findings.iter().find(|f| f.code == code);
    found.map(|f| (f.severity, f.subject.clone()))
}
