//! Elements: stiffness, mass and strain, one formulation a file.
//!
//! Every element works in the basic frame with six unknowns a grid: three translations, then three rotations. Its stiffness K
//! satisfies K R = 0 for the six rigid motions R of its grids.

pub(crate) mod beam;
mod bush;
mod joint;
mod list;
mod matrix;
mod rod;
mod shear_panel;
pub(crate) mod shell;
pub(crate) mod solid;
mod spring;
mod triangle_points;

pub(crate) use matrix::{ElementMatrix, point_mass};
pub(crate) use rod::{rod_mass, rod_thermal_force};
pub(crate) use shear_panel::shear_panel_mass;
pub(crate) use spring::between_dofs;
