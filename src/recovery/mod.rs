//! Loads from measured strain: weighted least squares, covariance, and tests of the residual.
//!
//! `eps = S f + e`, with `e` the noise of the readings and the model's own error. One estimate ([`gain`]) serves static states (`runs`) and records
//! of any length ([`history`], tested on `samples`), so that both have the same intervals. [`residuals`] combines over the runs the part of the
//! readings that no load can cause, and [`verdict`] tests it. `outlier` and the search for wrong inputs (`misfit`) report suspect gauges.
//! `determined` and [`plausible`] test the plausibility of loads and readings, [`stuck`] finds dead gauges. `noise` estimates the noise by gauge
//! from the residuals. [`calibrated`] is the estimate for a calibrated S, [`unlike`] and `taught` are its tests. [`dynamic`] converts readings of a
//! structure that vibrates into quasi-static readings.

pub mod by_calibration;
pub mod calibrated;
pub mod clock;
mod determined;
pub mod dynamic;
pub mod errors;
pub mod gain;
pub mod history;
mod kernel;
mod misfit;
mod missing;
pub mod net;
mod noise;
mod outlier;
pub mod outside_calibration;
pub mod plausible;
pub mod residuals;
mod runs;
mod samples;
mod solved;
pub mod stuck;
mod sums;
mod taught;
mod types;
pub mod unlike;
pub mod validation;
pub mod verdict;

pub use determined::{beyond_expected, check_planned};
pub use errors::ErrorModel;
pub use gain::Gain;
pub use misfit::Alternatives;
pub use missing::Missing;
pub use noise::{NOISE_ASSUMED, noise_without_load};
pub use outlier::ALARM;
pub use runs::{recover, recover_with_alternatives};
pub use samples::{check_gaps, recover_samples, recover_samples_with_alternatives};
pub use solved::estimate;
pub use sums::Sums;
pub use types::*;
pub use verdict::{NOT_SOLVABLE, UNEXPLAINED};

#[cfg(test)]
mod tests;
