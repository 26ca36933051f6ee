//! Optimal positions of gauges: D-optimal layouts with a certificate of their distance from the optimum.
//!
//! A layout `S` of `s` gauges has the information matrix `M_S = P + sum a_i a_i'`. `a_i` is the sensitivity row of a gauge over the standard
//! deviation of its reading, with each column times the expected size of its load. `P` is the prior information (kept gauges, known load sizes). The
//! best layout has the largest `log det M_S`.
//!
//! Order of steps:
//!
//! - [`candidates`]: rows, or strain tensors that represent all angles at a place
//! - [`relax`]: weights between 0 and 1
//! - [`column_generation`]: the relaxation over millions of rows, with the bound
//! - [`exchange`] and [`spacing`]: rounding and local search
//! - [`branch_and_bound`]: proof of small problems
//! - [`quality`]: properties of a layout
//!
//! Variants: [`robust`] if a gauge may fail, [`condition`] for a small condition number, [`bundles`] for items with several rows or different costs.
//! [`sites`], [`region`] and [`gradient`] make candidates from a model.
//!
//! Certificate: for any positive definite `M` and any layout of distinct rows `log det M_S <= log det M + k ln((tr(M^-1 P) + T) / k)`. `T` is the sum
//! of the `s` largest `d_i = a_i' M^-1 a_i`. The reason is that the arithmetic mean of the eigenvalues of `M^-1 M_S` is not below their geometric
//! mean. A group may allow at most one row: one angle at a place, or one gauge within a spacing. `T` then contains only the largest `d_i` of each
//! group.

pub mod angle_variance;
pub mod branch_and_bound;
pub mod bundles;
pub mod candidates;
pub mod column_generation;
pub mod condition;
mod coordinate_exchange;
pub mod criterion;
pub mod exchange;
pub mod gradient;
mod layout;
mod newton;
mod perturbation;
pub mod quality;
pub mod region;
pub mod relax;
mod relaxation_solution;
pub mod required_places;
pub mod robust;
mod role;
mod shortlist;
pub mod sites;
pub mod spacing;
mod spec;
pub mod variance_scan;
mod variance_table;

pub use criterion::Criterion;
pub use layout::{Layout, PlaceError, place};
pub use role::Role;
pub use spec::{Loss, Spec};

#[cfg(test)]
mod tests;
