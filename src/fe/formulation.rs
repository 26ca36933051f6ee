//! Where an element stands for another than its card names.

use crate::finding::{Finding, Severity};
use crate::model::Model;
use nastran::cards::ShellShape;

/// Says where an element stands for another than its card names.
pub(super) fn formulations(model: &Model) -> Vec<Finding> {
    let told: [(&[ShellShape], &str, &str); 2] = [
        (
            &[ShellShape::QuadR, ShellShape::TriaR],
            "CQUADR, CTRIAR",
            "solved as CQUAD4 and CTRIA3 whose sides bend with the rotation about the normal (Allman 1984)",
        ),
        (
            &[ShellShape::Quad8, ShellShape::Tria6],
            "CQUAD8, CTRIA6",
            "solved as one quadrilateral a corner around a point in the middle, on the curved surface through the grids",
        ),
    ];
    told.into_iter()
        .filter_map(|(shapes, cards, what)| {
            let n = model.shells.iter().filter(|s| shapes.contains(&s.shape)).count();
            (n > 0).then(|| {
                Finding::new(
                    Severity::Info,
                    "formulation",
                    cards,
                    format!("{n} elements: {what}"),
                    "nothing for meshes of several elements a side; solve with Nastran where single elements carry the answer",
                )
            })
        })
        .collect()
}
