//! CTETRA, CPENTA, CHEXA, CPYRAM with any of their mid-side grids: isoparametric serendipity elements with three translations per grid.
//!
//! Bricks and wedges without mid-side grids have incompatible modes, quadratic along a brick's three directions or along a wedge's axis. Their
//! gradient is taken at the centre and scaled by the ratio of Jacobians, so that constant strain is exact on distorted shapes. Integration is full
//! everywhere, so that an element has exactly six zero-energy modes.
//!
//! # Reference
//! Taylor, Beresford and Wilson, IJNME 10 (1976) 1211; Zienkiewicz and Taylor, The Finite Element Method, volume 1, chapters 8 and 10.

mod form;
mod law;
mod of_model;
mod table;

pub(crate) use of_model::{
    SolidStrain, is_inverted, solid_mass, solid_stiffness, solid_strain, solid_thermal_force,
};

#[cfg(test)]
mod tests;
