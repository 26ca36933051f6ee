//! Sparse symmetric positive definite systems whose unknowns come in small groups (six to a grid): ordering, factor, solution.
//!
//! The order and the structure of the factor are determined on the graph of groups. It has six times fewer vertices than the matrix has rows. The
//! factorization is multifrontal; faer multiplies its dense matrices.

mod assemble;
mod block_matrix;
mod branches;
mod eliminate;
mod error;
mod factor;
mod forest;
mod front;
mod graph;
mod narrow_blocks;
mod order;
mod panel;
mod solve;
mod substitution;
mod supernodes;
mod symbolic;
mod tree_work;

pub use block_matrix::{BlockMatrix, DenseTerm};
pub use error::FactorError;
pub use factor::Factor;
pub use graph::BlockGraph;
pub use order::OrderingMethod;
pub use solve::SolutionAccuracy;
pub use symbolic::Symbolic;
pub use tree_work::TreeWork;

#[cfg(test)]
mod tests;
