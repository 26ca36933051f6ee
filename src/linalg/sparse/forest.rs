//! The elimination tree of an order, its subtrees contiguous, and the size of the factor.

use super::graph::{BlockGraph, NONE, inverse};

/// An order in postorder, with its elimination tree.
#[derive(Debug)]
pub(super) struct EliminationForest {
    /// Old group of each new group.
    pub(super) order: Vec<u32>,
    /// Parent of each new group.
    pub(super) parent: Vec<u32>,
    /// Number of unknowns in the rows of the factor below each new group.
    pub(super) below: Vec<u32>,
    /// Number of entries of the factor, counted in unknowns, without merged supernodes.
    pub(super) nonzeros: usize,
}

impl EliminationForest {
    /// Returns the elimination tree (Liu 1990) of an order, its postorder, and the number of entries of the factor.
    pub(super) fn new(graph: &BlockGraph, order: &[u32], sizes: &[u8]) -> Self {
        let position = inverse(order);
        let n = order.len();
        let (mut parent, mut visited) = (vec![NONE; n], vec![NONE; n]);
        let mut below = vec![0_u32; n];
        let size = |j: usize| u32::from(sizes[order[j] as usize]);
        for (j, &old) in order.iter().enumerate() {
            visited[j] = j as u32;
            for &w in graph.neighbours(old as usize) {
                let mut i = position[w as usize] as usize;
                while i < j && visited[i] != j as u32 {
                    if parent[i] == NONE {
                        parent[i] = j as u32;
                    }
                    below[i] += size(j);
                    visited[i] = j as u32;
                    i = parent[i] as usize;
                }
            }
        }
        let entries = |j: usize| {
            let (own, below) = (size(j) as usize, below[j] as usize);
            own * (own + 1) / 2 + own * below
        };
        let nonzeros = (0..n).map(entries).sum();
        let sorted = postorder(&parent);
        let place = inverse(&sorted);
        let of = |v: &u32| *v as usize;
        Self {
            order: sorted.iter().map(|v| order[of(v)]).collect(),
            parent: sorted
                .iter()
                .map(|v| match parent[of(v)] {
                    NONE => NONE,
                    p => place[p as usize],
                })
                .collect(),
            below: sorted.iter().map(|v| below[of(v)]).collect(),
            nonzeros,
        }
    }
}

/// Vertices of a forest, children before parents, subtrees contiguous.
fn postorder(parent: &[u32]) -> Vec<u32> {
    let n = parent.len();
    let (mut first, mut next) = (vec![NONE; n], vec![NONE; n]);
    let mut stack = Vec::new();
    for v in (0..n).rev() {
        match parent[v] {
            NONE => stack.push(v as u32),
            p => next[v] = std::mem::replace(&mut first[p as usize], v as u32),
        }
    }
    let mut order = Vec::with_capacity(n);
    while let Some(&v) = stack.last() {
        match first[v as usize] {
            NONE => {
                order.push(v);
                stack.pop();
            }
            child => {
                first[v as usize] = next[child as usize];
                stack.push(child);
            }
        }
    }
    order
}
