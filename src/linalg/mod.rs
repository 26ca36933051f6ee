//! Linear algebra: the only place that names outside linear-algebra crates.

pub mod dense;
pub mod spd;

pub use dense::{Matrix, Vector};
