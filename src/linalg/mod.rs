//! Linear algebra: the only place that names outside linear-algebra crates.
//!
//! - [`tall`]: least squares with many rows and few columns
//! - [`levenberg`]: nonlinear least squares

pub mod dense;
pub mod levenberg;
pub mod spd;
pub mod tall;

pub use dense::{Matrix, Vector};
