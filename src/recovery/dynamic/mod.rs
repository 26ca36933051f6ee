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
//! `G` is nearly a differential operator (force is mass times acceleration and so on), so that a reading hangs on those of a short time round it
//! ([`Kernel::reach`]); nearer to an end of a stretch than that nothing is said.
//!
//! # Reference
//! R. E. Cornwell, R. R. Craig, C. P. Johnson, On the application of the mode-acceleration method to structural engineering problems, Earthquake
//! Engineering and Structural Dynamics 11 (1983) 679.

mod correct;
mod doubt;
mod kernel;
mod plant;

pub use correct::{AtRest, readings_at_rest};
use kernel::Kernel;
use plant::Plant;

/// Where the band ends that is let through, over the frequency up to which loads are wanted: between the two it falls off as a cosine.
pub const BAND_END: f64 = 1.5;

/// An elastic mode as gauges and loads meet it.
#[derive(Clone, Debug, PartialEq)]
pub struct ElasticMode {
    /// Frequency, Hz.
    pub hz: f64,
    /// Strain at every gauge of S for a generalised coordinate of 1, its shape of unit generalised mass.
    pub strain: Vec<f64>,
    /// Work of a unit of every load of S on that shape.
    pub work: Vec<f64>,
}

/// What is known of the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamics {
    /// Modes that answer otherwise than at rest.
    pub modes: Vec<ElasticMode>,
    /// Loads are wanted up to here, Hz.
    pub up_to_hz: f64,
    /// Damping of every mode, share of critical.
    pub damping: f64,
    /// One standard deviation of their frequencies, share of each.
    pub frequency_sd: f64,
    /// One standard deviation of the damping, share of it.
    pub damping_sd: f64,
}

/// Why readings can't be put at rest.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// The record does not hold the band.
    #[error("{rate_hz:.4} samples a second don't hold a band that ends at {end_hz:.4} Hz")]
    Rate {
        /// Its rate.
        rate_hz: f64,
        /// End of the band.
        end_hz: f64,
    },
    /// Loads that the gauges can't tell apart.
    #[error("at {hz:.4} Hz the gauges don't tell the loads apart")]
    Untold {
        /// Where.
        hz: f64,
    },
    /// The reach of a reading exceeds what is reckoned with.
    #[error("a reading at rest would hang on those of more than {seconds:.4} s round it")]
    Rings {
        /// Time.
        seconds: f64,
    },
}

#[cfg(test)]
mod tests;
