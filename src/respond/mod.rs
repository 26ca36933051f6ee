//! From recovered loads to strain and stress anywhere: superposition of the unit fields, no new solution.
//!
//! `rows` is the load-to-response matrix (stress at surfaces of shells and recovery points of bars per unit load), [`envelope`] the
//! largest von Mises stress over all states with its standard deviation, [`hot_spots`] where it peaks, [`fatigue`] the damage of
//! its history.

mod envelope;
mod fatigue;
mod rows;

pub use envelope::{LoadState, Peak, Spread, envelope, hot_spots, von_mises_history};
pub use fatigue::{PlaceDamage, fatigue};
pub use rows::{Place, ResponseRow, response_rows};

#[cfg(test)]
mod tests;
