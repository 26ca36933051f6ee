//! Gauges on elements whose single strain has not been verified against another solver.

use super::arms::{Gauge, Spot};
use crate::finding::{Finding, Severity};
use crate::model::Model;
use nastran::cards::ShellShape;

/// Returns a warning for gauges on CQUADR, CTRIAR, CQUAD8 and CTRIA6 whose strain the built-in solver computes: single elements of these kinds differ
/// from Nastran's.
pub fn on_unverified_elements(model: &Model, gauges: &[Gauge]) -> Option<Finding> {
    use ShellShape::{Quad8, QuadR, Tria6, TriaR};
    let doubtful = |g: &&Gauge| {
        g.arms.iter().any(|arm| match arm.spot {
            Spot::Shell { shell, .. } => model
                .shells
                .get(shell.us())
                .is_some_and(|s| matches!(s.shape, Quad8 | QuadR | Tria6 | TriaR)),
            _ => false,
        })
    };
    let names: Vec<&str> = gauges
        .iter()
        .filter(doubtful)
        .map(|g| g.name.as_str())
        .collect();
    let first = names.first()?;
    let more = match names.len() {
        1 => String::new(),
        n => format!(" and {} more", n - 1),
    };
    Some(
        Finding::new(
            Severity::Warning,
            "gauge-on-unverified-element",
            format!("{first}{more}"),
            "the gauge is on a CQUADR, CTRIAR, CQUAD8 or CTRIA6: the built-in solver's strain of a single such element is not verified against Nastran's",
            "take the strain from Nastran ([model] results), or mesh the place with CQUAD4",
        )
        .with_numbers(names.len() as f64, 0.0),
    )
}
