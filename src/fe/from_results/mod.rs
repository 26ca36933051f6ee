//! Reads result files into a `Solution`: static subcases, shells at their surfaces, bars at their recovery points, displacements in basic.
//!
//! - `shells` fibre, curvature and corner rows, strain from stress where a file has no strain;
//! - `beams` the three forms of bar and beam rows;
//! - `displacement` from displacement frames to basic;
//! - [`find_repeated_results`](find_repeated_results()) subcases that occur more than once;
//! - `tally` input that was found and can't be used, each kind reported once.

mod beams;
mod blocks;
mod displacement;
mod ids;
mod merge;
mod read;
mod repeated_subcases;
mod shells;
mod tally;

pub use merge::complete_case;
pub use read::{
    Displacements, ReadOptions, solution_from_file, solution_from_results, subcase_labels,
};
pub use repeated_subcases::{HOLD_ONCE, RepeatedSubcase, find_repeated_results};
pub use tally::other_element_types;

#[cfg(test)]
mod tests;
