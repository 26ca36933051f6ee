//! Independent branches of the elimination tree, and the top of the tree above them. The branches can be factored and substituted in parallel.

use super::graph::NONE;
use super::supernodes::Supernodes;
use std::ops::Range;

/// Branches are divided until none holds more than this share of the work, or of the unknowns: enough of them to share out evenly.
const SHARE: f64 = 1.0 / 24.0;

/// Tasks that branches are shared out into.
const TASKS: usize = 16;

/// A supernode with all its descendants.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Branch {
    /// Supernodes of the branch.
    pub(super) supernodes: Range<usize>,
    /// Groups of these supernodes.
    pub(super) groups: Range<usize>,
    /// Unknowns of these supernodes, in elimination order.
    pub(super) unknowns: Range<usize>,
    /// Number of multiplications to factor the branch.
    pub(super) weight: f64,
}

/// Tree in two parts: branches, and the top above them.
#[derive(Debug, Default)]
pub(super) struct Branches {
    /// Branches, ascending.
    pub(super) list: Vec<Branch>,
    /// Supernodes above the branches, ascending.
    pub(super) top: Vec<usize>,
    /// First position of each group among the unknowns of the top. `OUTSIDE` for other groups.
    pub(super) in_top: Vec<u32>,
    /// Number of unknowns of the top.
    pub(super) n_top: usize,
}

pub(super) const OUTSIDE: u32 = u32::MAX;

impl Branches {
    /// Divides the tree of supernodes. `start` is the first unknown of each group.
    pub(super) fn from_supernodes(nodes: &Supernodes, start: &[usize]) -> Self {
        let n = nodes.len();
        let groups = |s: &Range<usize>| nodes.first[s.start] as usize..nodes.first[s.end] as usize;
        let unknowns = |s: &Range<usize>| start[groups(s).start]..start[groups(s).end];
        // For each supernode: the work of its subtree, and the first supernode of its subtree.
        let (mut below, mut first) = (vec![0.0; n], (0..n).collect::<Vec<usize>>());
        let mut total = 0.0;
        for s in 0..n {
            let work = work(unknowns(&(s..s + 1)).len(), nodes.n_below(s));
            below[s] += work;
            total += work;
            if nodes.parent[s] != NONE {
                let parent = nodes.parent[s] as usize;
                below[parent] += below[s];
                first[parent] = first[parent].min(first[s]);
            }
        }
        let n_unknowns = start.last().copied().unwrap_or(0) as f64;
        let divided = |s: usize| {
            let share = unknowns(&(first[s]..s + 1)).len() as f64 / n_unknowns;
            share > SHARE || below[s] > SHARE * total
        };
        let (mut list, mut top) = (Vec::new(), Vec::new());
        for s in 0..n {
            if divided(s) {
                top.push(s);
            } else if nodes.parent[s] == NONE || divided(nodes.parent[s] as usize) {
                let supernodes = first[s]..s + 1;
                list.push(Branch {
                    groups: groups(&supernodes),
                    unknowns: unknowns(&supernodes),
                    supernodes,
                    weight: below[s],
                });
            }
        }
        let mut in_top = vec![OUTSIDE; start.len() - 1];
        let mut n_top = 0;
        for &s in &top {
            for g in nodes.groups(s) {
                in_top[g] = n_top as u32;
                n_top += start[g + 1] - start[g];
            }
        }
        Self {
            list,
            top,
            in_top,
            n_top,
        }
    }

    /// Returns indices into `top` of supernodes whose children are complete, level by level. `parent` contains the parent of each supernode.
    pub(super) fn levels(&self, parent: &[u32]) -> Vec<Vec<usize>> {
        let mut level = vec![0_usize; self.top.len()];
        let mut levels: Vec<Vec<usize>> = Vec::new();
        for (i, s) in self.top.iter().enumerate() {
            if levels.len() <= level[i] {
                levels.resize(level[i] + 1, Vec::new());
            }
            levels[level[i]].push(i);
            if let Ok(above) = self.top.binary_search(&(parent[*s] as usize)) {
                level[above] = level[above].max(level[i] + 1);
            }
        }
        levels
    }

    /// Returns the branches in tasks of similar work, as indices into `list`. The number of tasks does not depend on the number of threads, so that
    /// sums over tasks round identically.
    pub(super) fn shared_out(&self) -> Vec<Vec<usize>> {
        let mut bins = vec![(0.0_f64, Vec::new()); TASKS];
        for i in self.heaviest_first() {
            if let Some(least) = bins.iter_mut().min_by(|a, b| a.0.total_cmp(&b.0)) {
                least.0 += self.list[i].weight;
                least.1.push(i);
            }
        }
        bins.into_iter().map(|b| b.1).collect()
    }

    /// Returns the indices into `list`.
    pub(super) fn heaviest_first(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.list.len()).collect();
        order.sort_by(|&a, &b| self.list[b].weight.total_cmp(&self.list[a].weight));
        order
    }
}

/// Returns the number of multiplications to eliminate the given number of unknowns from a matrix with the given number of rows below them.
pub(super) fn work(own: usize, below: usize) -> f64 {
    let (w, m) = (own as f64, below as f64);
    w * w * w / 6.0 + w * w * m / 2.0 + w * m * m / 2.0
}
