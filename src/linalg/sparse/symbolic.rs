//! The shape of the factor: elimination order, place of every unknown, faer's symbolic factorisation.

use super::branches::Branches;
use super::error::FactorError;
use super::graph::{BlockGraph, inverse};
use super::order::{EliminationForest, OrderingMethod, candidates};
use faer::Side;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};

/// The symbolic factor.
#[derive(Debug)]
pub struct Symbolic {
    /// New to old group.
    pub(super) order: Vec<u32>,
    /// Old to new group.
    pub(super) position: Vec<u32>,
    /// First unknown by new group, and the total.
    pub(super) start: Vec<usize>,
    /// First unknown by old group, and the total.
    pub(super) old_start: Vec<usize>,
    /// Supernodes of the factor, in elimination order.
    pub(super) cholesky: SymbolicCholesky<u32>,
    pub(super) branches: Branches,
    method: OrderingMethod,
}

impl Symbolic {
    /// The smaller factor of the orders compared; `sizes` are the unknowns in each group.
    ///
    /// Orders are compared on the graph of groups, each postordered; the kept one is expanded to unknowns.
    ///
    /// # Errors
    /// A matrix or factor with more entries than 32-bit indices count, or that memory holds.
    pub fn analyse(graph: &BlockGraph, sizes: &[u8]) -> Result<Self, FactorError> {
        use rayon::prelude::*;
        let best = candidates(graph)
            .into_par_iter()
            .map(|(method, order)| (method, EliminationForest::new(graph, &order, sizes)))
            .min_by_key(|(_, forest)| forest.nonzeros);
        let (method, forest) = best.ok_or(FactorError::TooLarge)?;
        let order = forest.order;
        let start = running(order.iter().map(|&v| sizes[v as usize]));
        let old_start = running(sizes.iter().copied());
        let position = inverse(&order);
        let cholesky = {
            let (columns, rows) = upper_pattern(graph, &order, &position, &start)?;
            let n = old_start.last().copied().unwrap_or(0);
            let pattern = SymbolicSparseColMatRef::new_checked(n, n, &columns, None, &rows);
            let parameters = CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..CholeskySymbolicParams::default()
            };
            factorize_symbolic_cholesky(
                pattern,
                Side::Upper,
                SymmetricOrdering::Identity,
                parameters,
            )
            .map_err(|_| FactorError::TooLarge)?
        };
        Ok(Self {
            position,
            order,
            start,
            old_start,
            branches: Branches::of(&cholesky),
            cholesky,
            method,
        })
    }

    /// Which ordering was kept.
    pub fn method(&self) -> OrderingMethod {
        self.method
    }

    /// Entries of the factor, explicit zeros of merged supernodes included.
    pub fn factor_nonzeros(&self) -> usize {
        self.cholesky.len_val()
    }

    /// Number of unknowns.
    pub fn n_unknowns(&self) -> usize {
        self.old_start.last().copied().unwrap_or(0)
    }

    /// First unknown of each group in the caller's numbering, and the total.
    pub fn unknown_start(&self) -> &[usize] {
        &self.old_start
    }

    /// The unknown, caller's numbering, at a place of the elimination order.
    pub(super) fn old_unknown(&self, new: usize) -> usize {
        let g = self.start.partition_point(|&s| s <= new) - 1;
        self.old_start[self.order[g] as usize] + new - self.start[g]
    }
}

/// Sums before each entry, and the total.
fn running(sizes: impl Iterator<Item = u8>) -> Vec<usize> {
    let mut start = vec![0];
    let mut total = 0;
    for size in sizes {
        total += usize::from(size);
        start.push(total);
    }
    start
}

/// Columns of the upper triangle in elimination order: every unknown of an earlier neighbour, and the group's own down to the diagonal.
fn upper_pattern(
    graph: &BlockGraph,
    order: &[u32],
    position: &[u32],
    start: &[usize],
) -> Result<(Vec<u32>, Vec<u32>), FactorError> {
    let (mut columns, mut rows) = (vec![0_u32], Vec::new());
    let mut earlier = Vec::new();
    for (g, &old) in order.iter().enumerate() {
        earlier.clear();
        earlier.extend(
            graph
                .neighbours(old as usize)
                .iter()
                .map(|&w| position[w as usize] as usize)
                .filter(|&h| h < g),
        );
        earlier.sort_unstable();
        for unknown in start[g]..start[g + 1] {
            for &h in &earlier {
                rows.extend((start[h]..start[h + 1]).map(|r| r as u32));
            }
            rows.extend((start[g]..=unknown).map(|r| r as u32));
            columns.push(u32::try_from(rows.len()).map_err(|_| FactorError::TooLarge)?);
        }
    }
    Ok((columns, rows))
}
