//! CBAR and CBEAM: Timoshenko beams by the flexibility method, exact for end loads, tapered ones by integration along the beam.
//!
//! The reference line joins the offset ends; for a CBEAM it is the line of shear centres. Element frame x, y, z; plane 1 is x-y.

mod flexibility;
mod interior;
mod mass;
mod of_model;
mod warping;

pub(crate) use flexibility::section_at;
pub(crate) use interior::{Interior, LineLoad, LineStrain};
pub(crate) use mass::{beam_coupled_mass, beam_inertia, beam_lumped_mass};
pub(crate) use of_model::{
    BeamForces, StationStrain, beam_end_forces, beam_forces, beam_stiffness, modulus_and_length,
    strain_at,
};

#[cfg(test)]
mod tests;
