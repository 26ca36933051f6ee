//! From a model and loads, or from a result file, to strain fields.

mod solution;
pub use solution::*;
