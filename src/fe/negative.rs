//! Springs of negative stiffness.

use super::error::Refusal;
use crate::finding::LISTED;
use crate::model::Model;
use nastran::place::Place;

/// Returns a refusal for each CELAS and CBUSH with negative stiffness. They stop a solution if the negative stiffness exceeds the stiffness of the
/// remaining structure.
pub(super) fn negative_springs(model: &Model) -> Vec<Refusal> {
    let springs = model.springs.iter();
    let springs = springs.map(|s| (format!("CELAS {}", s.id), s.at, s.k));
    let bushes = model.bushes.iter().map(|b| {
        let lowest = b.k.iter().fold(f64::INFINITY, |a, k| a.min(*k));
        (format!("CBUSH {}", b.id), b.at, lowest)
    });
    let refusal = |(card, at, k): (String, Place, f64)| {
        Refusal {
        card,
        at,
        reason: format!(
            "its stiffness is {k}, and the structure around it is less stiff: the equilibrium is unstable"
        ),
        remedy:
            "give it a stiffness above 0, or hold the structure so that the total stiffness is positive"
                .to_owned(),
    }
    };
    springs
        .chain(bushes)
        .filter(|s| s.2 < 0.0)
        .take(LISTED)
        .map(refusal)
        .collect()
}
