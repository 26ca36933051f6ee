//! A structure standing on a flat, level, frictionless floor.
//!
//! [`solve_standing`] solves unit forces at the contacts on the free structure; [`Floor`] turns their displacements into reactions.

mod reactions;
mod stand;

pub use reactions::{Floor, FloorError, FloorLoad};
pub use stand::{FloorSolution, solve_standing};

#[cfg(test)]
mod tests;
