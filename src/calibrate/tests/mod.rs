mod assumptions;
mod bridges;
mod cause;
mod glued;
mod labels;
mod next;
mod overfit;
mod repeats;
mod scatter;
mod synthetic;
mod taught;
mod wrong;

use super::Calibration;
use crate::finding::Severity;

/// Severity and subject of the first finding of a code.
fn severe(c: &Calibration, code: &str) -> Option<(Severity, String)> {
    let found = c.findings.iter().find(|f| f.code == code);
    found.map(|f| (f.severity, f.subject.clone()))
}
