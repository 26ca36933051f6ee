//! Loads from measured strain: weighted least squares, covariance, and tests of the residual.
//!
//! `eps = S f + e`, with `e` the noise of the readings and the model's own error. One estimate ([`gain`]) serves static states (`runs`) and records
//! of any length ([`history`], tested on `samples`), so that both have the same intervals. [`residuals`] combines over the runs the part of the
//! readings that no load can cause, and [`verdict`] tests it. `outlier` and the search for wrong inputs (`misfit`) report suspect gauges.
//! `load_determinacy` tests whether the gauges determine the loads, [`reading_plausibility`] tests the readings, [`dead_gauges`] finds dead gauges.
//! `noise` estimates the noise by gauge from the residuals. [`calibrated_loads`] is the estimate for a calibrated S. [`uncalibrated_strain`],
//! [`outside_calibration`] and `simultaneous_loads` are its tests. [`dynamic`] converts readings of a structure that vibrates into quasi-static
//! readings.

pub mod by_calibration;
pub mod calibrated_loads;
pub mod clock;
pub mod dead_gauges;
pub mod dynamic;
pub mod errors;
pub mod gain;
pub mod history;
mod kernel;
mod load_determinacy;
mod misfit;
mod missing_readings;
pub mod net;
mod noise;
mod outlier;
pub mod outside_calibration;
pub mod reading_plausibility;
pub mod residuals;
mod run_estimates;
mod runs;
mod samples;
mod simultaneous_loads;
mod sums;
mod types;
pub mod uncalibrated_strain;
pub mod validation;
pub mod verdict;

pub use errors::ErrorModel;
pub use gain::Gain;
pub use load_determinacy::{beyond_expected, check_planned};
pub use misfit::Alternatives;
pub use missing_readings::MissingReadings;
pub use noise::{NOISE_ASSUMED, noise_without_load};
pub use outlier::ALARM;
pub use run_estimates::estimate;
pub use runs::{recover, recover_with_alternatives};
pub use samples::{check_gaps, recover_samples, recover_samples_with_alternatives};
pub use sums::Sums;
pub use types::*;
pub use verdict::{NOT_SOLVABLE, UNEXPLAINED};

#[cfg(test)]
mod tests;
