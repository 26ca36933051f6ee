//! From result files to a [`Solution`]: static subcases, shells at their surfaces, bars at their recovery points, displacements in basic.
//!
//! - [`shells`] fibre, curvature and corner rows, strain from stress where a file has no strain;
//! - [`beams`] the three forms of bar and beam rows;
//! - [`displacement`] from displacement frames to basic;
//! - [`tally`] what was met and could not be used, told once each.

mod beams;
mod displacement;
mod ids;
mod merge;
mod read;
mod shells;
mod surface_z;
mod tally;

pub use read::{Displacements, ReadOptions, solution_from_file, solution_from_results};
pub use surface_z::surface_z;

#[cfg(test)]
mod tests;
