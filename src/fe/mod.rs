//! From a model and loads, or from a result file, to strain fields.

mod element;
pub mod belongs;
pub mod from_results;
pub mod shell_frame;
mod solution;
pub mod strain_rows;
pub mod strain_tensor;

pub use solution::*;
