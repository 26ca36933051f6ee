//! The numeric factor: multifrontal Cholesky of the matrix scaled to a diagonal near 1, branches of the tree side by side.

use super::block_matrix::BlockMatrix;
use super::branches::Branch;
use super::eliminate::Tiles;
use super::error::FactorError;
use super::front::{EliminatedSupernode, Front, MOST_LOST, Spare, Update};
use super::graph::NONE;
use super::symbolic::Symbolic;
use rayon::prelude::*;

/// Factor of a sparse symmetric positive definite matrix. [`Factor::solve`] replaces right-hand sides by solutions.
///
/// # Example
/// Three springs `k` in a row, one end held and a force `F` at the other: point `i` moves by `(i + 1) F / k`.
/// ```
/// use strainbridge::linalg::sparse::{BlockGraph, BlockMatrix, DenseTerm, Factor, Symbolic};
///
/// let pairs: [&[u32]; 3] = [&[0], &[0, 1], &[1, 2]];
/// let graph = BlockGraph::from_cliques(3, || pairs.into_iter());
/// let symbolic = Symbolic::analyse(&graph, &[1, 1, 1])?; // one unknown for each point
/// let groups = pairs.map(<[u32]>::to_vec);
/// let k = 50.0;
/// let matrix = BlockMatrix::assemble_terms(&symbolic, &graph, &groups, |i| {
///     Ok::<_, ()>(DenseTerm {
///         groups: groups[i].clone(),
///         offsets: (0..=groups[i].len()).collect(),
///         matrix: if i == 0 { vec![k] } else { vec![k, -k, -k, k] },
///     })
/// }).unwrap();
/// let factor = Factor::new(&symbolic, matrix)?;
/// let mut x = vec![0.0, 0.0, 10.0];
/// factor.solve(&mut x);
/// assert!(x.iter().zip([0.2, 0.4, 0.6]).all(|(x, exact)| (x - exact).abs() < 1e-12));
/// # Ok::<(), strainbridge::linalg::sparse::FactorError>(())
/// ```
#[derive(Debug)]
pub struct Factor<'a> {
    pub(super) symbolic: &'a Symbolic,
    pub(super) values: Vec<f64>,
    /// Scale by unknown, elimination order.
    pub(super) scale: Vec<f64>,
    /// Unknowns (caller's numbering) with a lost pivot. No stiffness holds them, and their values stay zero.
    pub lost: Vec<usize>,
    /// Smallest pivot of the scaled matrix that was not lost. It shows how near the structure is to a mechanism.
    pub smallest_pivot: f64,
    /// Scaled matrix, from which the residual of a solution is computed.
    pub(super) matrix: BlockMatrix,
}

impl<'a> Factor<'a> {
    /// Returns the factor of a symmetric positive (semi)definite matrix, which is scaled in place and kept.
    ///
    /// # Errors
    /// An entry that is not a number, or a factor that memory doesn't hold.
    pub fn new(symbolic: &'a Symbolic, mut matrix: BlockMatrix) -> Result<Self, FactorError> {
        let diagonal = matrix.diagonal(symbolic);
        if let Some(new) = diagonal.iter().position(|d| !d.is_finite()) {
            return Err(FactorError::NotANumber {
                unknown: symbolic.old_unknown(new),
            });
        }
        let scale: Vec<f64> = diagonal.iter().map(|d| scale_of(*d)).collect();
        matrix.scale(symbolic, &scale);
        let mut values = zeros(symbolic.nodes.n_values())?;
        let found = Pass {
            symbolic,
            matrix: &matrix,
        }
        .factor(&mut values)?;
        let mut lost = found.lost;
        lost.sort_unstable();
        // The factor contains springs at these unknowns. The matrix that computes the residuals needs the same springs.
        for &unknown in &lost {
            matrix.add_to_place(symbolic, unknown, 1.0);
        }
        lost.truncate(MOST_LOST);
        let mut lost: Vec<usize> = lost.iter().map(|u| symbolic.old_unknown(*u)).collect();
        lost.sort_unstable();
        Ok(Self {
            symbolic,
            values,
            scale,
            lost,
            smallest_pivot: found.smallest_pivot,
            matrix,
        })
    }
}

/// Lost pivots and smallest pivot of a factorisation.
struct FactorPivots {
    /// Lost pivots, numbered in elimination order.
    lost: Vec<usize>,
    smallest_pivot: f64,
}

impl FactorPivots {
    fn new() -> Self {
        Self {
            lost: Vec::new(),
            smallest_pivot: f64::INFINITY,
        }
    }

    fn note(&mut self, lost: Vec<usize>, smallest_pivot: f64) {
        self.lost.extend(lost);
        self.smallest_pivot = self.smallest_pivot.min(smallest_pivot);
    }
}

/// One factorisation.
struct Pass<'a> {
    symbolic: &'a Symbolic,
    matrix: &'a BlockMatrix,
}

impl Pass<'_> {
    /// # Errors
    /// The first pivot, in elimination order of what was reached, that is not a number.
    fn factor(&self, values: &mut [f64]) -> Result<FactorPivots, FactorError> {
        let branches = &self.symbolic.branches;
        let (of_branch, of_top) = self.shared_out(values);
        let mut all = FactorPivots::new();
        let mut left: Vec<Option<Update>> = Vec::new();
        left.resize_with(self.symbolic.nodes.len(), || None);
        // The heaviest branches start first; results are taken in elimination order.
        let mut of_branch: Vec<Option<&mut [f64]>> = of_branch.into_iter().map(Some).collect();
        let heaviest = branches.heaviest_first().into_iter();
        let work: Vec<(usize, &mut [f64])> = heaviest
            .filter_map(|i| Some((i, of_branch[i].take()?)))
            .collect();
        let mut done: Vec<(usize, Result<(Update, FactorPivots), FactorError>)> = work
            .into_par_iter()
            .with_max_len(1)
            .map(|(i, values)| (i, self.branch(&branches.list[i], values)))
            .collect();
        done.sort_by_key(|d| d.0);
        for (_, result) in done {
            let (update, found) = result?;
            all.note(found.lost, found.smallest_pivot);
            let node = update.node;
            left[node] = Some(update);
        }
        let mut panels: Vec<Option<&mut [f64]>> = of_top.into_iter().map(Some).collect();
        for level in branches.levels(&self.symbolic.nodes.parent) {
            let mut tasks = Vec::with_capacity(level.len());
            for i in level {
                let children = self.children(branches.top[i], &mut left);
                tasks.push((
                    branches.top[i],
                    children,
                    panels[i].take().unwrap_or_default(),
                ));
            }
            let done: Vec<Result<EliminatedSupernode, FactorError>> = tasks
                .into_par_iter()
                .with_max_len(1)
                .map(|(s, children, panel)| {
                    let front = Front::new(self.symbolic, self.matrix, s);
                    front.eliminate_supernode(
                        panel,
                        &children,
                        &mut Spare::default(),
                        Tiles::Shared,
                    )
                })
                .collect();
            for result in done {
                let e = result?;
                all.note(e.lost, e.smallest_pivot);
                let node = e.update.node;
                left[node] = Some(e.update);
            }
        }
        Ok(all)
    }

    /// A branch from its leaves to its root, whose update is left.
    fn branch(
        &self,
        branch: &Branch,
        mut values: &mut [f64],
    ) -> Result<(Update, FactorPivots), FactorError> {
        let nodes = &self.symbolic.nodes;
        let (mut waiting, mut spare, mut found) =
            (Vec::<Update>::new(), Spare::default(), FactorPivots::new());
        for s in branch.supernodes.clone() {
            let (panel, rest) = values.split_at_mut(nodes.values(s..s + 1).len());
            values = rest;
            // In postorder, the children of a supernode are the last updates in `waiting`.
            let child = |u: &Update| nodes.parent[u.node] as usize == s;
            let first = waiting.len() - waiting.iter().rev().take_while(|u| child(u)).count();
            let front = Front::new(self.symbolic, self.matrix, s);
            let e = front.eliminate_supernode(panel, &waiting[first..], &mut spare, Tiles::Own)?;
            waiting.drain(first..).for_each(|u| spare.take_back(u));
            waiting.push(e.update);
            found.note(e.lost, e.smallest_pivot);
        }
        let update = waiting.pop().ok_or(FactorError::TooLarge)?;
        Ok((update, found))
    }

    /// Updates of the children of a supernode of the top.
    fn children(&self, s: usize, left: &mut [Option<Update>]) -> Vec<Update> {
        let branches = &self.symbolic.branches;
        let roots = branches.list.iter().map(|b| b.supernodes.end - 1);
        let all = roots.chain(branches.top.iter().copied());
        let parent = &self.symbolic.nodes.parent;
        let mut of: Vec<usize> = all
            .filter(|&c| parent[c] != NONE && parent[c] as usize == s)
            .collect();
        of.sort_unstable();
        of.into_iter().filter_map(|c| left[c].take()).collect()
    }

    /// The values of each branch and of each supernode of the top.
    fn shared_out<'v>(&self, values: &'v mut [f64]) -> (Vec<&'v mut [f64]>, Vec<&'v mut [f64]>) {
        let (nodes, branches) = (&self.symbolic.nodes, &self.symbolic.branches);
        let (mut of_branch, mut of_top) = (Vec::new(), Vec::new());
        let mut rest = values;
        let (mut s, mut b) = (0, 0);
        while s < nodes.len() {
            let branch = branches.list.get(b).filter(|b| b.supernodes.start == s);
            let end = branch.map_or(s + 1, |b| b.supernodes.end);
            let (own, tail) = rest.split_at_mut(nodes.values(s..end).len());
            rest = tail;
            s = end;
            if branch.is_some() {
                of_branch.push(own);
                b += 1;
            } else {
                of_top.push(own);
            }
        }
        (of_branch, of_top)
    }
}

/// Zeros, whose pages the system hands out to the threads that first write there.
fn zeros(n: usize) -> Result<Vec<f64>, FactorError> {
    let mut probe: Vec<f64> = Vec::new();
    probe
        .try_reserve_exact(n)
        .map_err(|_| FactorError::TooLarge)?;
    drop(probe);
    Ok(vec![0.0; n])
}

/// The power of two next to the inverse root of a diagonal entry: scaled with it, no entry is rounded. Stiff parts on soft springs need that: a
/// rounded stiffness resists their rigid motion.
fn scale_of(diagonal: f64) -> f64 {
    match diagonal > 0.0 {
        true => 2.0_f64.powi((-0.5 * diagonal.log2()).round() as i32),
        false => 1.0,
    }
}
