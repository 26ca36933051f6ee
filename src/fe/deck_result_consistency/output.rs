//! Output that the deck does not request, and output in another frame.

use crate::finding::{Finding, Severity};
use crate::model::Model;
use nastran::results::{Analysis, Quantity, ResultsFile};
use std::collections::BTreeSet;

/// Returns the findings for static subcases without strain of shells or bars, and for PARAM,OMID.
pub fn check_output(model: &Model, name: &str, file: &ResultsFile) -> Vec<Finding> {
    let mut findings = Vec::new();
    let subcases = |wanted: &[Quantity]| -> BTreeSet<u32> {
        let fits = |q: Quantity, element: Option<u32>| {
            wanted.contains(&q) && element.is_none_or(is_strained)
        };
        let blocks = file
            .blocks()
            .iter()
            .filter(|b| b.analysis == Analysis::Statics && !b.complex);
        blocks
            .filter(|b| fits(b.quantity, b.element.map(|e| e.0)))
            .map(|b| b.subcase)
            .collect()
    };
    let all: BTreeSet<u32> = file
        .blocks()
        .iter()
        .filter(|b| b.analysis == Analysis::Statics)
        .map(|b| b.subcase)
        .collect();
    let (strain, stress) = (subcases(&[Quantity::Strain]), subcases(&[Quantity::Stress]));
    let without: Vec<u32> = all
        .iter()
        .copied()
        .filter(|s| !strain.contains(s) && !stress.contains(s))
        .collect();
    if !without.is_empty() && !(model.shells.is_empty() && model.beams.is_empty()) {
        let message = format!(
            "{} of {} static subcases have neither strain nor stress of shells or bars: {without:?}",
            without.len(),
            all.len()
        );
        let remedy = "request STRAIN(FIBER) = ALL (or a SET) in every subcase";
        findings.push(
            Finding::new(Severity::Warning, "no-strain-output", name, message, remedy)
                .with_numbers(without.len() as f64, 0.0),
        );
    }
    if model.params.omid {
        let message = "PARAM,OMID,YES: solvers may write shell strain in the material frame; it is read as in the element frame, which was not verified \
         with this parameter";
        findings.push(Finding::new(
            Severity::Warning,
            "omid",
            name,
            message,
            "run without PARAM,OMID",
        ));
    }
    findings
}

/// Shell, bar and beam types.
fn is_strained(element: u32) -> bool {
    matches!(
        element,
        2 | 33 | 34 | 64 | 70 | 74 | 75 | 82 | 100 | 144 | 227 | 228
    )
}
