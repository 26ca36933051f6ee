//! Loads from measured strain: weighted least squares, covariance, and what the residual says of both.
//!
//! `eps = S f + e`, with `e` the noise of the readings and the model's own error. [`runs`] estimates static states, [`history`] streams
//! records of any length, [`verdict`] judges the residual, [`faults`] names gauges that look wired backwards, dead or wrong.

pub mod errors;
pub mod faults;
pub mod history;
mod kernel;
pub mod net;
mod runs;
mod solve;
pub mod verdict;

pub use errors::ErrorModel;
pub use runs::*;
pub use solve::*;

#[cfg(test)]
mod tests;
