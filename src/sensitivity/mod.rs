//! Sensitivity `S` in `eps = S f`: what each gauge reads per unit of each load, and what that can tell apart.

mod bar_points;
mod from_solution;
mod noise;
mod separate;
mod types;
mod uncertainty;

pub use bar_points::bar_points;
pub use from_solution::*;
pub use noise::GaugeNoise;
pub use separate::*;
pub use types::*;
pub use uncertainty::*;

#[cfg(test)]
mod tests;
