//! Where to put gauges: D-optimal layouts with a certificate of how far from the best possible they are.
//!
//! A layout `S` of `s` gauges has the information matrix `M_S = P + sum a_i a_i'`, with `a_i` the sensitivity row of a gauge over the
//! standard deviation of its reading, columns times the expected size of their load, and `P` prior information (kept gauges, known
//! load sizes). The best layout has the largest `log det M_S`.
//!
//! Order of work: [`candidates`] (rows, or strain tensors that represent all angles at a place), [`relax`] (weights between 0 and 1),
//! [`column_generation`] (the same over millions of rows; gives the bound), [`exchange`] (rounding and local search), [`spacing`],
//! [`branch_and_bound`] (proof of small problems), [`quality`]; [`robust`] where a gauge may be lost, [`condition`] where errors shall not grow,
//! [`bundles`] where things have several rows or unlike costs. [`sites`], [`region`] and [`gradient`] make candidates of a model.
//!
//! Certificate: for any positive definite `M` and any layout of distinct rows
//! `log det M_S <= log det M + k ln((tr(M^-1 P) + T) / k)`, `T` the sum of the `s` largest `d_i = a_i' M^-1 a_i`, because the arithmetic mean
//! of the eigenvalues of `M^-1 M_S` is not below their geometric mean. Where at most one row of a group can be used (one angle a place, one
//! gauge within a spacing) `T` counts the largest of each group only.

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
