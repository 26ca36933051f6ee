//! Layouts of bundles, which have several rows or different costs: rosettes, symmetric pairs, bridges that take more work than a single grid.
//!
//! A bundle `u` has rows `R_u` and a cost `c_u`. The cost of a layout is limited by a budget. For any regular `M` the criterion of such a layout is
//! at most `value + q ln((tr(G P) + T) / q)`. `T` is the largest `sum t_u tr(R_u G R_u')` with `0 <= t_u <= 1` and `sum t_u c_u` within the budget.
//! It is a knapsack filled in the order of value over cost, with a fraction of the last bundle.
//!
//! - `set`: the bundles, and the requirements on a layout
//! - `relaxation`: weights between 0 and 1 under the budget, and the bound
//! - `exchange`: layouts of whole bundles within the budget, by addition and exchange
//! - `layout`: the best layout of several starts, with its certificate

mod exchange;
mod layout;
mod relaxation;
mod set;

pub use layout::{BundleLayout, place_bundles};
pub use set::{BundleSpec, Bundles};
