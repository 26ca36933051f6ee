//! Stiffness of every element, kind by kind.

use super::beam::beam_stiffness;
use super::bush::bush_stiffness;
use super::joint::{joint_dofs, joint_stiffness};
use super::matrix::ElementMatrix;
use super::rod::rod_stiffness;
use super::shear_panel::shear_panel_stiffness;
use super::shell::shell_stiffness;
use super::solid::solid_stiffness;
use super::spring::spring_stiffness;
use crate::fe::error::Refusal;
use crate::fe::prepared_model::PreparedModel;
use crate::model::ElementRef;

impl PreparedModel<'_> {
    /// Returns the dofs of an element's grids that may get stiffness from the element, one bit for each dof.
    pub(crate) fn dofs(&self, element: ElementRef) -> u8 {
        match element {
            ElementRef::Solid(_) | ElementRef::ShearPanel(_) => 0b000_111,
            ElementRef::Joint(i) => joint_dofs(&self.model.joints[i]),
            ElementRef::Shell(_)
            | ElementRef::Beam(_)
            | ElementRef::Rod(_)
            | ElementRef::Bush(_)
            | ElementRef::Spring(_) => 0b111_111,
        }
    }

    /// Returns the stiffness.
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
