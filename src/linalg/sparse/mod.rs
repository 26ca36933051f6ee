//! Sparse symmetric positive definite systems whose unknowns come in small groups (six to a grid): ordering, factor, solution.
//!
//! Orders are found and compared on the graph of groups, which has six times fewer vertices than the matrix has rows; the factor
//! itself is faer's supernodal Cholesky.

mod block_matrix;
mod branches;
mod error;
mod factor;
mod graph;
mod order;
mod solve;
mod substitution;
mod symbolic;

pub use block_matrix::{BlockMatrix, DenseTerm};
pub use error::FactorError;
pub use factor::Factor;
pub use graph::BlockGraph;
pub use order::OrderingMethod;
pub use solve::Refined;
pub use symbolic::Symbolic;

#[cfg(test)]
mod tests;
