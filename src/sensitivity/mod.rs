//! Sensitivity `S` in `eps = S f`: the reading of each gauge per unit of each load, and the loads that the gauges separate.

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
