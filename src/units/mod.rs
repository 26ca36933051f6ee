//! Units of input and output: the unit system of a model, the units of reports and of measured files, and factors between them.
//!
//! A model keeps the units of its deck. A number is converted once when it is read and once in a report.

mod interval;
mod number;
mod report;
mod strain;
mod system;
mod unit;
mod unit_plausibility;

#[cfg(test)]
mod tests;

pub use interval::{half_width, plus_minus};
pub use number::{format_fixed, number, percent};
pub use report::*;
pub use strain::microstrain_in;
pub use system::*;
pub use unit::*;
pub use unit_plausibility::*;

/// Strain in one microstrain.
pub const MICROSTRAIN: f64 = 1e-6;
/// Units in one thousand of them: newtons in a kilonewton.
pub const KILO: f64 = 1e3;
/// Standard gravity, m/s^2.
///
/// # Reference
/// CGPM 3 (1901), resolution 2.
pub const STANDARD_GRAVITY_M_S2: f64 = 9.806_65;
