//! Rainflow cycles and their pseudo-damage.
//!
//! - [`nullable_numbers`]: numbers that are not finite, kept in JSON
//! - `bias`: damage that noise adds, from counts with more noise
//! - [`count`]: the four-point count, whose residues can be joined. With the residue as half cycles it equals the count of ASTM E1049
//! - `counter`: a tally in progress; `counts`: cycles and rises by class
//! - `marks`: a number for each sample, which seeds the noise of the counts with more noise
//! - `turning_points`: the samples where a signal turns, without small reversals
//! - `mean_stress`: the fully reversed cycle that does the damage of a cycle with a mean
//! - [`law`]: the damage of a cycle, by the slope and knee of an S-N line
//! - [`tally`]: cycles by class, levels, extremes and sums of a load over a time. Tallies of days join to the tally of a year
//! - [`interval`]: damage with its 95 % interval
//! - `damage`: damage of one record, range by range

mod bias;
pub mod count;
mod counter;
mod counts;
mod damage;
pub mod interval;
pub mod law;
mod marks;
mod mean_stress;
pub mod nullable_numbers;
pub mod tally;
mod turning_points;

pub use count::{Cycle, Point, Rainflow, Reversal, half_cycles};
pub use counter::Counter;
pub use damage::{Bin, Damage};
pub use interval::{DamageInterval, DamageParts, Ratio, SharedErrors, damage_interval};
pub use law::{Knee, Law};
pub use marks::Marks;
pub use mean_stress::MeanStress;
pub use tally::{Extreme, Tally};
pub use turning_points::{TurningPointFinder, turning_points};

#[cfg(test)]
mod tests;
