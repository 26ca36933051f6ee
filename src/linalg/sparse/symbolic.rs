//! The shape of the factor: elimination order, place of every unknown, supernodes.

use super::branches::Branches;
use super::error::FactorError;
use super::forest::EliminationForest;
use super::graph::{BlockGraph, inverse};
use super::order::{OrderingMethod, candidates};
use super::supernodes::Supernodes;

/// The symbolic factor.
#[derive(Debug)]
pub struct Symbolic {
    /// Old group of each new group.
    pub(super) order: Vec<u32>,
    /// New group of each old group.
    pub(super) position: Vec<u32>,
    /// First unknown by new group, and the total.
    pub(super) start: Vec<usize>,
    /// First unknown by old group, and the total.
    pub(super) old_start: Vec<usize>,
    /// Supernodes of the factor, in elimination order.
    pub(super) nodes: Supernodes,
    pub(super) branches: Branches,
    method: OrderingMethod,
}

impl Symbolic {
    /// Returns the smallest factor of the compared orders. `sizes` contains the number of unknowns of each group.
    ///
    /// # Errors
    /// More unknowns than 32-bit indices count.
    pub fn analyse(graph: &BlockGraph, sizes: &[u8]) -> Result<Self, FactorError> {
        use rayon::prelude::*;
        let best = candidates(graph)
            .into_par_iter()
            .map(|(method, order)| (method, EliminationForest::new(graph, &order, sizes)))
            .min_by_key(|(_, forest)| forest.nonzeros);
        let (method, forest) = best.ok_or(FactorError::TooLarge)?;
        let (nodes, order) = Supernodes::new(graph, &forest, sizes);
        drop(forest);
        let start = running_sums(order.iter().map(|&v| sizes[v as usize]));
        let old_start = running_sums(sizes.iter().copied());
        u32::try_from(old_start.last().copied().unwrap_or(0)).map_err(|_| FactorError::TooLarge)?;
        Ok(Self {
            position: inverse(&order),
            branches: Branches::from_supernodes(&nodes, &start),
            order,
            start,
            old_start,
            nodes,
            method,
        })
    }

    /// Returns the ordering that was kept.
    pub fn method(&self) -> OrderingMethod {
        self.method
    }

    /// Returns the entries of the factor, explicit zeros of merged supernodes included.
    pub fn factor_nonzeros(&self) -> usize {
        self.nodes.n_values()
    }

    /// Returns the number of unknowns.
    pub fn n_unknowns(&self) -> usize {
        self.old_start.last().copied().unwrap_or(0)
    }

    /// Returns the first unknown of each group in the caller's numbering, and the total.
    pub fn unknown_start(&self) -> &[usize] {
        &self.old_start
    }

    /// Returns the unknowns of a supernode's own, elimination order.
    pub(super) fn unknowns(&self, s: usize) -> std::ops::Range<usize> {
        let groups = self.nodes.groups(s);
        self.start[groups.start]..self.start[groups.end]
    }

    /// Returns the unknowns of a group, elimination order.
    pub(super) fn of_group(&self, g: u32) -> std::ops::Range<usize> {
        self.start[g as usize]..self.start[g as usize + 1]
    }

    /// Returns the unknown, caller's numbering, at a place of the elimination order.
    pub(super) fn old_unknown(&self, new: usize) -> usize {
        let g = self.start.partition_point(|&s| s <= new) - 1;
        self.old_start[self.order[g] as usize] + new - self.start[g]
    }
}

/// Sums before each entry, and the total.
fn running_sums(sizes: impl Iterator<Item = u8>) -> Vec<usize> {
    let mut start = vec![0];
    let mut total = 0;
    for size in sizes {
        total += usize::from(size);
        start.push(total);
    }
    start
}
