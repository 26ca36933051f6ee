//! All stiff elements of a model as one list.

use super::beam::{beam_grids, beam_stiffness};
use super::bush::bush_stiffness;
use super::joint::{joint_dofs, joint_grids, joint_stiffness};
use super::matrix::ElementMatrix;
use super::rod::rod_stiffness;
use super::shear_panel::shear_panel_stiffness;
use super::shell::{many_grids, shell_stiffness};
use super::solid::{solid_grids, solid_stiffness};
use super::spring::spring_stiffness;
use crate::fe::error::Refusal;
use crate::fe::prepared::Prepared;
use crate::model::GridIx;

/// One element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ElementRef {
    Shell(usize),
    Beam(usize),
    Rod(usize),
    Bush(usize),
    Joint(usize),
    Spring(usize),
    Solid(usize),
    ShearPanel(usize),
}

impl Prepared<'_> {
    /// Every element with stiffness.
    pub(crate) fn elements(&self) -> Vec<ElementRef> {
        let m = self.model;
        let shells = (0..m.shells.len()).map(ElementRef::Shell);
        let beams = (0..m.beams.len()).map(ElementRef::Beam);
        let rods = (0..m.rods.len()).map(ElementRef::Rod);
        let bushes = (0..m.bushes.len()).map(ElementRef::Bush);
        shells
            .chain(beams)
            .chain(rods)
            .chain(bushes)
            .chain((0..m.joints.len()).map(ElementRef::Joint))
            .chain((0..m.springs.len()).map(ElementRef::Spring))
            .chain((0..m.solids.len()).map(ElementRef::Solid))
            .chain((0..m.shear_panels.len()).map(ElementRef::ShearPanel))
            .collect()
    }

    /// Its grids.
    pub(crate) fn grids(&self, element: ElementRef) -> Vec<GridIx> {
        let m = self.model;
        match element {
            ElementRef::Shell(i) => many_grids(&m.shells[i]).0,
            ElementRef::Beam(i) => beam_grids(&m.beams[i]),
            ElementRef::Rod(i) => m.rods[i].grids.to_vec(),
            ElementRef::Bush(i) => [Some(m.bushes[i].grids.0), m.bushes[i].grids.1]
                .into_iter()
                .flatten()
                .collect(),
            ElementRef::Joint(i) => joint_grids(&m.joints[i]),
            ElementRef::Spring(i) => {
                let mut list: Vec<GridIx> =
                    m.springs[i].ends.iter().flatten().map(|e| e.0).collect();
                list.dedup();
                list
            }
            ElementRef::Solid(i) => solid_grids(&m.solids[i]),
            ElementRef::ShearPanel(i) => m.shear_panels[i].grids.to_vec(),
        }
    }

    /// Dofs of its grids that it may give stiffness to, a bit each.
    pub(crate) fn dofs(&self, element: ElementRef) -> u8 {
        match element {
            ElementRef::Solid(_) | ElementRef::ShearPanel(_) => 0b000_111,
            ElementRef::Joint(i) => joint_dofs(&self.model.joints[i]),
            _ => 0b111_111,
        }
    }

    /// Its stiffness.
    ///
    /// # Errors
    /// A shape or property that makes no element.
    pub(crate) fn stiffness(&self, element: ElementRef) -> Result<ElementMatrix, Refusal> {
        match element {
            ElementRef::Shell(i) => shell_stiffness(self, i),
            ElementRef::Beam(i) => beam_stiffness(self.model, i),
            ElementRef::Rod(i) => rod_stiffness(self.model, i),
            ElementRef::Bush(i) => Ok(bush_stiffness(self.model, i)),
            ElementRef::Joint(i) => Ok(joint_stiffness(&self.model.joints[i])),
            ElementRef::Spring(i) => Ok(spring_stiffness(self, i)),
            ElementRef::Solid(i) => solid_stiffness(self.model, i),
            ElementRef::ShearPanel(i) => shear_panel_stiffness(self.model, i),
        }
    }
}
