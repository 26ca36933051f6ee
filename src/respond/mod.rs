//! Strain and stress anywhere from recovered loads, by superposition of the unit fields without a new solution.
//!
//! `rows` computes the load-to-response matrix: stress per unit load at surfaces of shells and recovery points of bars. [`envelope`] computes the
//! largest von Mises stress over all states, with its standard deviation. [`hot_spots`] finds its peaks, and [`fatigue`] computes the damage from the
//! history of the states.

mod envelope;
mod fatigue;
mod rows;

pub use envelope::{LoadState, Peak, Spread, envelope, hot_spots, von_mises_history};
pub use fatigue::{PlaceDamage, StressLaw, fatigue};
pub use rows::{Place, ResponseRow, response_rows};

#[cfg(test)]
mod tests;
