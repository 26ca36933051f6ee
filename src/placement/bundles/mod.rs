//! Layouts of things with several rows or unlike costs: rosettes, symmetric pairs, bridges that take more work than a single grid.
//!
//! A bundle `u` has rows `R_u` and a cost `c_u`; layouts spend at most a budget. For any regular `M` the criterion of such a layout is at most
//! `value + q ln((tr(G P) + T) / q)`, `T` the largest `sum t_u tr(R_u G R_u')` with `0 <= t_u <= 1` and `sum t_u c_u` within the budget (a
//! knapsack filled by price over cost, the last bundle in part).
//!
//! - `set`: the bundles, and what is asked of a layout of them
//! - `relaxation`: weights between 0 and 1 under the budget, and the bound
//! - `exchange`: whole bundles within the budget, filled in and exchanged
//! - `layout`: the best of several starts, with its certificate

mod exchange;
mod layout;
mod relaxation;
mod set;

pub use layout::{BundleLayout, place_bundles};
pub use set::{BundleSpec, Bundles};
