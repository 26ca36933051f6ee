//! Sums a matrix from dense terms, with the branches of the elimination tree in parallel.
//!
//! A term belongs to one branch and the top, because groups of two branches are never connected. So a branch forms its terms and adds the entries in
//! its own columns independently of other branches. The other entries are added at the end. Every entry is summed in the order of the terms, whatever
//! the number of threads.

use super::block_matrix::{BlockMatrix, DenseTerm};
use super::branches::OUTSIDE;
use super::graph::BlockGraph;
use super::symbolic::Symbolic;
use rayon::prelude::*;
use std::ops::Range;

/// Terms and errors of a branch that remain for the top.
struct RemainingTerms<E> {
    /// Terms with rows in the top, with their numbers.
    terms: Vec<(usize, DenseTerm)>,
    errors: Vec<(usize, E)>,
}

impl BlockMatrix {
    /// Returns the sum of all terms as a block matrix. `term(i)` computes term `i`, and `groups[i]` lists its groups of unknowns. `graph` must
    /// connect all groups of a term.
    ///
    /// # Errors
    /// Every error of `term`, in the order of the terms.
    pub fn assemble_terms<E: Send>(
        symbolic: &Symbolic,
        graph: &BlockGraph,
        groups: &[Vec<u32>],
        term: impl Fn(usize) -> Result<DenseTerm, E> + Sync,
    ) -> Result<Self, Vec<E>> {
        let mut matrix = Self::zeros(symbolic, graph);
        let branches = &symbolic.branches;
        let in_top = |g: u32| branches.in_top[symbolic.position[g as usize] as usize] != OUTSIDE;
        // Terms by branch. Terms in the top alone and terms without an unknown come last.
        let mut of_branch: Vec<Vec<usize>> = vec![Vec::new(); branches.list.len() + 1];
        for (i, groups) in groups.iter().enumerate() {
            let below = groups.iter().find(|g| !in_top(**g));
            let branch = below.map_or(branches.list.len(), |g| {
                let place = symbolic.position[*g as usize] as usize;
                branches.list.partition_point(|b| b.groups.end <= place)
            });
            of_branch[branch].push(i);
        }
        let mut tasks = Vec::with_capacity(of_branch.len());
        let mut rest = matrix.values.as_mut_slice();
        let mut taken = 0;
        for (branch, terms) in branches.list.iter().zip(&of_branch) {
            let (from, to) = (
                matrix.value_start[matrix.column[branch.groups.start]],
                matrix.value_start[matrix.column[branch.groups.end]],
            );
            let (_, tail) = rest.split_at_mut(from - taken);
            let (own, tail) = tail.split_at_mut(to - from);
            tasks.push((branch.groups.clone(), terms, own, from));
            (rest, taken) = (tail, to);
        }
        let shape = Shape {
            symbolic,
            column: &matrix.column,
            row: &matrix.row,
            value_start: &matrix.value_start,
        };
        let mut left: Vec<RemainingTerms<E>> = tasks
            .into_par_iter()
            .with_max_len(1)
            .map(|(columns, terms, values, base)| {
                let mut left = RemainingTerms {
                    terms: Vec::new(),
                    errors: Vec::new(),
                };
                for &i in terms {
                    match term(i) {
                        Ok(t) => {
                            shape.add(values, base, &columns, &t);
                            if t.groups.iter().any(|g| in_top(*g)) {
                                left.terms.push((i, t));
                            }
                        }
                        Err(e) => left.errors.push((i, e)),
                    }
                }
                left
            })
            .collect();
        let alone = of_branch.pop().unwrap_or_default();
        let (mut terms, mut errors) = (Vec::new(), Vec::new());
        let in_top_alone: Vec<_> = alone.into_par_iter().map(|i| (i, term(i))).collect();
        for (i, t) in in_top_alone {
            match t {
                Ok(t) => terms.push((i, t)),
                Err(e) => errors.push((i, e)),
            }
        }
        for left in &mut left {
            terms.append(&mut left.terms);
            errors.append(&mut left.errors);
        }
        if !errors.is_empty() {
            errors.sort_by_key(|e| e.0);
            return Err(errors.into_iter().map(|e| e.1).collect());
        }
        terms.sort_unstable_by_key(|t| t.0);
        for (_, t) in &terms {
            shape.add_to_top(&mut matrix.values, t);
        }
        Ok(matrix)
    }
}

/// Places of the blocks of a matrix.
struct Shape<'a> {
    symbolic: &'a Symbolic,
    column: &'a [usize],
    row: &'a [u32],
    value_start: &'a [usize],
}

impl Shape<'_> {
    /// Adds the part of a term in these block columns, whose values begin at `base`.
    fn add(&self, values: &mut [f64], base: usize, columns: &Range<usize>, term: &DenseTerm) {
        self.add_where(values, base, term, |g| columns.contains(&(g as usize)));
    }

    /// Adds the part of a term in the columns of the top.
    fn add_to_top(&self, values: &mut [f64], term: &DenseTerm) {
        let in_top = &self.symbolic.branches.in_top;
        self.add_where(values, 0, term, |g| in_top[g as usize] != OUTSIDE);
    }

    fn add_where(
        &self,
        values: &mut [f64],
        base: usize,
        term: &DenseTerm,
        wanted: impl Fn(u32) -> bool,
    ) {
        let n = term.offsets.last().copied().unwrap_or(0);
        let position = |g: &u32| self.symbolic.position[*g as usize];
        for (g, offsets) in term.groups.iter().zip(term.offsets.windows(2)) {
            let own = position(g);
            if !wanted(own) {
                continue;
            }
            let (from, to) = (self.column[own as usize], self.column[own as usize + 1]);
            for (h, rows) in term.groups.iter().zip(term.offsets.windows(2)) {
                let below = position(h);
                if below < own {
                    continue;
                }
                let Ok(at) = self.row[from..to].binary_search(&below) else {
                    continue;
                };
                let (m, first) = (rows[1] - rows[0], self.value_start[from + at] - base);
                let block = &mut values[first..][..m * (offsets[1] - offsets[0])];
                for (column, j) in block.chunks_exact_mut(m.max(1)).zip(offsets[0]..) {
                    let source = &term.matrix[j * n + rows[0]..][..m];
                    column.iter_mut().zip(source).for_each(|(v, s)| *v += s);
                }
            }
        }
    }
}
