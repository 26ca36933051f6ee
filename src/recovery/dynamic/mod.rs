//! Conversion of readings of a vibrating structure into quasi-static readings, which the same loads would cause without vibration.
//!
//! The strain of loads `f` at the circular frequency `w`, with the static `S` and the elastic modes near the band, is
//!
//! `eps = H(w) f`, `H(w) = S + sum_j psi_j a_j(w) c_j'`, `a_j = 1 / (1 - r^2 + 2 i zeta r) - 1`, `r = w / w_j`, `c_j = phi_j' F / w_j^2`,
//!
//! with `psi_j` the strain of the shape `phi_j` of unit generalised mass and `F` the unit loads. All other modes respond quasi-statically, which `S`
//! includes (mode acceleration). Rigid-body motion causes no strain, so the form also applies to a free structure under inertia relief with its
//! elastic modes.
//!
//! Let `G(w)` be the least squares gain of `H`. The quasi-static readings are `eps - Psi a C G eps`, band-limited. They still contain the residual,
//! which the usual tests examine. All functions that recover loads from strain can use them like other readings.
//!
//! `G` is nearly a differential operator (force is mass times acceleration and so on). A quasi-static reading therefore depends on the readings of a
//! short time around it ([`AtRest::reach`]). Samples nearer than that to an end of a stretch have no result.
//!
//! # Reference
//! R. E. Cornwell, R. R. Craig, C. P. Johnson, On the application of the mode-acceleration method to structural engineering problems, Earthquake
//! Engineering and Structural Dynamics 11 (1983) 679.

mod block;
mod correct;
mod estimate;
mod kernel;
mod normal_equations;
mod plant;
mod reading_covariance;
mod residual_courses;
mod rules;
mod types;

pub use correct::{AtRest, readings_at_rest, window};
pub use estimate::{Deviation, EstimatedModes, estimate_modes};
pub use reading_covariance::{AddedCovariance, ReadingCovariance, triangle};
pub use rules::RULES;
pub use types::{Dynamics, ElasticMode, Unfit};

#[cfg(test)]
mod tests;
