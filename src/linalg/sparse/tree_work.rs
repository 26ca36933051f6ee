//! What the elimination tree says of factoring on many threads, without doing it.

use super::branches::work;
use super::eliminate::longest_chain;
use super::forest::NONE;
use super::symbolic::Symbolic;
use std::collections::BTreeMap;

/// Multiplications of a factorisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeWork {
    /// All of them.
    pub total: f64,
    /// Those of the longest chain that must be done one after the other: a branch by one thread, then every front above it up to the root, column
    /// block after column block. No number of threads is faster.
    pub longest: f64,
}

impl Symbolic {
    /// Work and longest chain.
    pub fn tree_work(&self) -> TreeWork {
        let (branches, parent) = (&self.branches, &self.nodes.parent);
        let mut chain = vec![0.0_f64; self.nodes.len()];
        let mut all = TreeWork {
            total: 0.0,
            longest: 0.0,
        };
        let mut ends = |node: usize, longest: f64, chain: &mut [f64]| {
            all.longest = all.longest.max(longest);
            if parent[node] != NONE {
                let above = &mut chain[parent[node] as usize];
                *above = above.max(longest);
            }
        };
        for branch in &branches.list {
            all.total += branch.weight;
            ends(branch.supernodes.end - 1, branch.weight, &mut chain);
        }
        for &s in &branches.top {
            let (own, below) = (self.unknowns(s).len(), self.nodes.n_below(s));
            all.total += work(own, below);
            let longest = chain[s] + self.chain_of(s);
            ends(s, longest, &mut chain);
        }
        all
    }

    /// Multiplications after which so many threads are done at the latest: branches one by one to the thread that is free, heaviest first; then level
    /// by level the fronts above them, each level no later than its work shared out and its longest chain (R. L. Graham, Bell System Tech. J. 45
    /// (1966) 1563).
    pub fn work_with(&self, threads: usize) -> f64 {
        let p = threads.max(1);
        let mut busy = vec![0.0_f64; p];
        for i in self.branches.heaviest_first() {
            if let Some(free) = busy.iter_mut().min_by(|a, b| a.total_cmp(b)) {
                *free += self.branches.list[i].weight;
            }
        }
        let mut levels: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
        let mut level = vec![0_usize; self.nodes.len()];
        for &s in &self.branches.top {
            let (own, below) = (self.unknowns(s).len(), self.nodes.n_below(s));
            let (sum, longest) = levels.entry(level[s]).or_insert((0.0, 0.0));
            *sum += work(own, below);
            *longest = longest.max(self.chain_of(s));
            if self.nodes.parent[s] != NONE {
                let above = self.nodes.parent[s] as usize;
                level[above] = level[above].max(level[s] + 1);
            }
        }
        let share = 1.0 / p as f64;
        let of_level = |(sum, longest): &(f64, f64)| share * sum + (1.0 - share) * longest;
        busy.iter().copied().fold(0.0, f64::max) + levels.values().map(of_level).sum::<f64>()
    }

    /// The longest chain of a front that threads share.
    fn chain_of(&self, s: usize) -> f64 {
        let (own, below) = (self.unknowns(s).len(), self.nodes.n_below(s));
        longest_chain(own, below).min(work(own, below))
    }
}
