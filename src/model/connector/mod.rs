//! CWELD, CFAST and CGAP: where their ends are, how those move with the grids around them, and the springs between.
//!
//! [`patch`] projects points onto shells; [`tie`] gives the motion of an end. A weld is a short round beam: as the springs that a
//! beam of constant section is, at its middle.

mod fastener;
mod gap;
mod patch;
mod place;
mod tie;
mod weld;

use super::build::Builder;
use super::fault::FaultKind;
use super::frame::unit;
use super::types::*;
use patch::Patches;
use std::collections::HashSet;

/// Share of the diameter under which the ends of a connector coincide.
const COINCIDENT: f64 = 1e-6;

impl Builder<'_> {
    /// Builds CWELD, CFAST and CGAP. It must run after shells, bushes, masses and rigid elements.
    pub(super) fn joints(&mut self) {
        let mut patches = Patches::default();
        // Piercing grids that already follow a patch.
        let mut tied: HashSet<GridIx> = HashSet::new();
        let mut out = Vec::new();
        self.welds(&mut patches, &mut tied, &mut out);
        self.fasteners(&mut patches, &mut tied, &mut out);
        self.gaps(&mut out);
        out.sort_by_key(|j: &Joint| j.id);
        self.model.joints = out;
        self.model.masses.sort_by_key(|m| m.id);
        self.model.rigids.sort_by_key(|r| r.id);
    }

    fn refuse(
        &mut self,
        name: &str,
        field: &'static str,
        at: nastran::place::Place,
        what: impl Into<String>,
        remedy: &'static str,
    ) {
        let kind = FaultKind::Unsupported {
            what: what.into(),
            remedy,
        };
        self.fault(name.to_owned(), field, at, kind);
    }
}

/// Returns the axes of a connector by rows. The first axis runs from A to B, or along `normal` if both points coincide. The second axis is in the
/// plane of the first and of the basic axis that is closest to perpendicular to it.
///
/// # Reference
/// MSC Nastran Quick Reference Guide, CFAST and CWELD (element coordinate system).
fn connector_axes(a: Vec3, b: Vec3, normal: Vec3, diameter: f64) -> Option<Mat3> {
    let line = b - a;
    let x = if line.norm() > COINCIDENT * diameter {
        unit(line)?
    } else {
        unit(normal)?
    };
    let mut basic = Vec3::zeros();
    basic[x.iamin()] = 1.0;
    let y = unit(basic - x * x.dot(&basic))?;
    Some(Mat3::from_rows(&[
        x.transpose(),
        y.transpose(),
        x.cross(&y).transpose(),
    ]))
}
