//! Strain that moves: readings of a structure that vibrates, turned into those that the same loads would make at rest.
//!
//! Strain of loads `f` at the circular frequency `w`, with the static `S` and the elastic modes that lie near the band:
//!
//! `eps = H(w) f`, `H(w) = S + sum_j psi_j a_j(w) c_j'`, `a_j = 1 / (1 - r^2 + 2 i zeta r) - 1`, `r = w / w_j`, `c_j = phi_j' F / w_j^2`,
//!
//! with `psi_j` the strain of the shape `phi_j` of unit generalised mass and `F` the unit loads. All other modes answer as they do at rest, which
//! `S` holds (mode acceleration). Rigid motions strain nothing, so a free structure under inertia relief has the same form with its elastic modes.
//! With `G(w)` the least squares gain of `H`, the readings at rest are `eps - Psi a C G eps`, band-limited: what the loads don't explain stays in
//! them, for the judges of the residual, and everything that recovers loads from strain takes them as any other readings.
//!
//! `G` is nearly a differential operator (force is mass times acceleration and so on). A quasi-static reading therefore depends on the readings of a
//! short time around it ([`AtRest::reach`]). Samples nearer than that to an end of a stretch have no result.
//!
//! # Reference
//! R. E. Cornwell, R. R. Craig, C. P. Johnson, On the application of the mode-acceleration method to structural engineering problems, Earthquake
//! Engineering and Structural Dynamics 11 (1983) 679.

mod block;
mod correct;
mod doubt;
mod estimate;
mod kernel;
mod plant;
mod types;

pub use correct::{AtRest, readings_at_rest, window};
pub use doubt::{AddedCovariance, Doubt, triangle};
pub use estimate::{Deviation, EstimatedModes, estimate_modes};
pub use types::{Dynamics, ElasticMode, Unfit};

#[cfg(test)]
mod tests;
