//! The numeric factor: independent subtrees of the elimination tree in parallel, then the fronts above them.

use super::block_matrix::BlockMatrix;
use super::front::{Update, eliminate};
use super::symbolic::Symbolic;
use faer::Par;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Pivots of the matrix scaled to a unit diagonal below this are lost to rounding: the unknown is held by nothing.
const TINY_PIVOT: f64 = 1e-13;
/// What a lost pivot is replaced by, so that its unknown stays at zero and the factorisation goes on.
const HUGE_PIVOT: f64 = 1e30;
/// Subtrees below this share of all operations are one task each.
const TASK_SHARE: f64 = 1.0 / 32.0;
/// Operations below which a front is not worth several threads.
const PARALLEL_FRONT_FLOPS: f64 = 2e7;

/// Why a factor could not be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FactorError {
    /// A pivot is not a number: an entry of the matrix is infinite or not a number.
    #[error("pivot of unknown {unknown} is not a number")]
    NotANumber {
        /// Caller's numbering.
        unknown: usize,
    },
}

/// L L' of the matrix scaled to a unit diagonal, in supernodes.
#[derive(Debug)]
pub struct Factor<'a> {
    pub(super) symbolic: &'a Symbolic,
    pub(super) panels: Vec<Vec<f64>>,
    /// Scale by unknown, elimination order.
    pub(super) scale: Vec<f64>,
    /// Unknowns (caller's numbering) whose pivot was lost: held by nothing, kept at zero.
    pub lost: Vec<usize>,
    /// Smallest pivot that was not lost, of the scaled matrix: how near the structure is to a mechanism.
    pub smallest_pivot: f64,
}

struct Shared<'a> {
    symbolic: &'a Symbolic,
    matrix: &'a BlockMatrix,
    scale: &'a [f64],
    panels: Vec<OnceLock<Vec<f64>>>,
    updates: Vec<Mutex<Option<Update>>>,
    pending: Vec<AtomicU32>,
    failed: Mutex<Option<usize>>,
}

impl Shared<'_> {
    fn one(&self, s: usize, children: Vec<Update>, par: Par) -> Option<Update> {
        match eliminate(
            self.symbolic,
            self.matrix,
            self.scale,
            s,
            children,
            (TINY_PIVOT, HUGE_PIVOT),
            par,
        ) {
            Ok((panel, update)) => {
                let _ = self.panels[s].set(panel);
                Some(update)
            }
            Err(unknown) => {
                *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(unknown);
                None
            }
        }
    }

    /// A whole subtree on this thread, children's updates on a stack.
    fn subtree(&self, root: usize) -> Option<Update> {
        let mut stack: Vec<Update> = Vec::new();
        for s in self.symbolic.supernodes[root].first_descendant as usize..=root {
            let children =
                stack.split_off(stack.len() - self.symbolic.supernodes[s].n_children as usize);
            stack.push(self.one(s, children, Par::Seq)?);
        }
        stack.pop()
    }

    /// Hands the update of `s` to its parent and goes on with the parent when this was its last child.
    fn climb(&self, mut s: usize, mut update: Update) {
        while let Some(parent) = self.symbolic.supernodes[s].parent {
            let p = parent as usize;
            *self.updates[s]
                .lock()
                .unwrap_or_else(PoisonError::into_inner) = Some(update);
            if self.pending[p].fetch_sub(1, Ordering::AcqRel) > 1 {
                return;
            }
            let node = &self.symbolic.supernodes[p];
            let mut children = Vec::with_capacity(node.n_children as usize);
            let mut c = p;
            for _ in 0..node.n_children {
                c -= 1;
                children.extend(
                    self.updates[c]
                        .lock()
                        .unwrap_or_else(PoisonError::into_inner)
                        .take(),
                );
                c = self.symbolic.supernodes[c].first_descendant as usize;
            }
            let (nc, nb) = (node.n_cols as f64, node.n_rows as f64);
            let par = if nc * (nc + nb) * (nc + nb) > PARALLEL_FRONT_FLOPS {
                Par::rayon(0)
            } else {
                Par::Seq
            };
            match self.one(p, children, par) {
                Some(next) => (s, update) = (p, next),
                None => return,
            }
        }
    }
}

impl<'a> Factor<'a> {
    /// The factor of a symmetric positive (semi)definite matrix.
    ///
    /// # Errors
    /// An entry that is not a number.
    pub fn new(symbolic: &'a Symbolic, matrix: &BlockMatrix) -> Result<Self, FactorError> {
        let scale: Vec<f64> = matrix
            .diagonal(symbolic)
            .iter()
            .map(|&d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 })
            .collect();
        let nodes = &symbolic.supernodes;
        let total: f64 = nodes
            .iter()
            .filter(|s| s.parent.is_none())
            .map(|s| s.subtree_flops)
            .sum();
        let task = total * TASK_SHARE;
        let shared = Shared {
            symbolic,
            matrix,
            scale: &scale,
            panels: nodes.iter().map(|_| OnceLock::new()).collect(),
            updates: nodes.iter().map(|_| Mutex::new(None)).collect(),
            pending: nodes.iter().map(|s| AtomicU32::new(s.n_children)).collect(),
            failed: Mutex::new(None),
        };
        let is_task = |s: usize| {
            let large_parent = nodes[s]
                .parent
                .is_none_or(|p| nodes[p as usize].subtree_flops > task);
            large_parent && (nodes[s].subtree_flops <= task || nodes[s].n_children == 0)
        };
        let mut tasks: Vec<usize> = (0..nodes.len()).filter(|&s| is_task(s)).collect();
        tasks.sort_by(|&a, &b| nodes[a].subtree_flops.total_cmp(&nodes[b].subtree_flops));
        rayon::scope(|scope| {
            for &root in &tasks {
                let shared = &shared;
                scope.spawn(move |_| {
                    if let Some(update) = shared.subtree(root) {
                        shared.climb(root, update);
                    }
                });
            }
        });
        let old = |new: usize| {
            let g = symbolic.start.partition_point(|&s| s <= new) - 1;
            symbolic.old_start[symbolic.order[g] as usize] + new - symbolic.start[g]
        };
        if let Some(unknown) = *shared.failed.lock().unwrap_or_else(PoisonError::into_inner) {
            return Err(FactorError::NotANumber {
                unknown: old(unknown),
            });
        }
        let panels: Vec<Vec<f64>> = shared
            .panels
            .into_iter()
            .map(|p| p.into_inner().unwrap_or_default())
            .collect();
        let (mut lost, mut smallest_pivot) = (Vec::new(), f64::INFINITY);
        for (s, panel) in nodes.iter().zip(&panels) {
            let n = s.n_cols + s.n_rows;
            for j in 0..s.n_cols {
                let pivot = panel[j * n + j] * panel[j * n + j];
                let unknown = symbolic.start[s.first as usize] + j;
                if pivot.is_nan() {
                    return Err(FactorError::NotANumber {
                        unknown: old(unknown),
                    });
                } else if pivot >= 0.5 * HUGE_PIVOT {
                    lost.push(old(unknown));
                } else {
                    smallest_pivot = smallest_pivot.min(pivot);
                }
            }
        }
        lost.sort_unstable();
        Ok(Self {
            symbolic,
            panels,
            scale,
            lost,
            smallest_pivot,
        })
    }
}
