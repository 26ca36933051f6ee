//! Branches of the elimination tree that have nothing to do with each other, and the top of the tree above them: what can be substituted
//! side by side.

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymbolicCholeskyRaw};
use std::ops::Range;

/// Branches are divided until none holds more than this share of the factor: enough of them to share out evenly.
const SHARE: f64 = 1.0 / 24.0;

/// Tasks that branches are shared out into.
const TASKS: usize = 16;

/// A supernode with all that is below it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Branch {
    /// Its supernodes.
    pub(super) supernodes: Range<usize>,
    /// Their unknowns, elimination order.
    pub(super) unknowns: Range<usize>,
    /// Entries of the factor in it.
    pub(super) weight: usize,
}

/// The tree in two parts.
#[derive(Debug, Default)]
pub(super) struct Branches {
    /// Ascending.
    pub(super) list: Vec<Branch>,
    /// Supernodes above them, ascending.
    pub(super) top: Vec<usize>,
    /// Place of each unknown among those of the top; `OUTSIDE` elsewhere.
    pub(super) in_top: Vec<u32>,
    /// Unknowns of the top.
    pub(super) n_top: usize,
}

const OUTSIDE: u32 = u32::MAX;

impl Branches {
    pub(super) fn of(cholesky: &SymbolicCholesky<u32>) -> Self {
        let SymbolicCholeskyRaw::Supernodal(nodes) = cholesky.raw() else {
            return Self::default();
        };
        let tree = Tree::of(nodes);
        let total: usize = tree.weight_of_roots();
        let most = (total as f64 * SHARE) as usize;
        let (mut list, mut top) = (Vec::new(), Vec::new());
        let mut open = tree.roots.clone();
        while let Some(s) = open.pop() {
            if tree.below[s] > most || tree.scattered {
                top.push(s);
                open.extend(&tree.children[s]);
            } else {
                list.push(Branch {
                    supernodes: tree.first[s]..s + 1,
                    unknowns: tree.columns(nodes, tree.first[s]).start..tree.columns(nodes, s).end,
                    weight: tree.below[s],
                });
            }
        }
        list.sort_by_key(|b| b.supernodes.start);
        top.sort_unstable();
        let mut in_top = vec![OUTSIDE; nodes.nrows()];
        let mut n_top = 0;
        for &s in &top {
            for place in &mut in_top[tree.columns(nodes, s)] {
                *place = n_top as u32;
                n_top += 1;
            }
        }
        Self {
            list,
            top,
            in_top,
            n_top,
        }
    }

    /// Branches in tasks about as heavy as each other: indices into `list`. As many whatever the number of threads, so that sums over them
    /// round alike.
    pub(super) fn shared_out(&self) -> Vec<Vec<usize>> {
        let mut order: Vec<usize> = (0..self.list.len()).collect();
        order.sort_by_key(|&i| std::cmp::Reverse(self.list[i].weight));
        let mut bins = vec![(0_usize, Vec::new()); TASKS];
        for i in order {
            if let Some(least) = bins.iter_mut().min_by_key(|b| b.0) {
                least.0 += self.list[i].weight;
                least.1.push(i);
            }
        }
        bins.into_iter().map(|b| b.1).collect()
    }
}

/// The elimination tree of supernodes.
struct Tree {
    children: Vec<Vec<usize>>,
    roots: Vec<usize>,
    /// The lowest supernode below each.
    first: Vec<usize>,
    /// Entries of the factor in each and below it.
    below: Vec<usize>,
    /// Some supernode's descendants are not numbered one after the other: no branch is a range.
    scattered: bool,
}

impl Tree {
    fn of(nodes: &SymbolicSupernodalCholesky<u32>) -> Self {
        let n = nodes.n_supernodes();
        let mut owner = vec![0_u32; nodes.nrows()];
        let mut tree = Self {
            children: vec![Vec::new(); n],
            roots: Vec::new(),
            first: (0..n).collect(),
            below: vec![0; n],
            scattered: false,
        };
        for s in 0..n {
            owner[tree.columns(nodes, s)].fill(s as u32);
        }
        let mut count = vec![1_usize; n];
        // Children come before their parents.
        for s in 0..n {
            let pattern = nodes.supernode(s).pattern();
            let columns = tree.columns(nodes, s).len();
            tree.below[s] += columns * (columns + pattern.len());
            tree.scattered |= count[s] != s + 1 - tree.first[s];
            match pattern.iter().min() {
                Some(&row) => {
                    let parent = owner[row as usize] as usize;
                    tree.children[parent].push(s);
                    tree.below[parent] += tree.below[s];
                    tree.first[parent] = tree.first[parent].min(tree.first[s]);
                    count[parent] += count[s];
                }
                None => tree.roots.push(s),
            }
        }
        tree
    }

    fn columns(&self, nodes: &SymbolicSupernodalCholesky<u32>, s: usize) -> Range<usize> {
        nodes.supernode_begin()[s] as usize..nodes.supernode_end()[s] as usize
    }

    fn weight_of_roots(&self) -> usize {
        self.roots.iter().map(|&s| self.below[s]).sum()
    }
}
