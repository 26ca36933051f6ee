//! Estimates the work of factoring on many threads from the elimination tree, without factoring.

use super::branches::work;
use super::eliminate::longest_chain;
use super::graph::NONE;
use super::symbolic::Symbolic;

/// Multiplications of a factorisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeWork {
    /// Multiplications of the whole factorisation.
    pub total: f64,
    /// Multiplications of the longest sequential chain. One thread computes a branch. The fronts above this branch follow up to the root, one column
    /// block after another. No number of threads can be faster than this chain.
    pub longest: f64,
}

impl Symbolic {
    /// Returns total work and longest chain.
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
            all.total += self.work_of(s);
            let longest = chain[s] + self.chain_of(s);
            ends(s, longest, &mut chain);
        }
        all
    }

    /// Returns an upper bound for the multiplications in sequence with this number of threads.
    ///
    /// A free thread takes the heaviest remaining branch. The fronts above follow level by level. A level takes at most its work shared by all
    /// threads plus its longest chain (R. L. Graham, Bell System Tech. J. 45 (1966) 1563).
    pub fn work_with(&self, threads: usize) -> f64 {
        let p = threads.max(1);
        let mut busy = vec![0.0_f64; p];
        for i in self.branches.heaviest_first() {
            if let Some(free) = busy.iter_mut().min_by(|a, b| a.total_cmp(b)) {
                *free += self.branches.list[i].weight;
            }
        }
        let share = 1.0 / p as f64;
        let of_level = |level: &Vec<usize>| -> f64 {
            let (mut sum, mut longest) = (0.0, 0.0_f64);
            for &i in level {
                let s = self.branches.top[i];
                sum += self.work_of(s);
                longest = longest.max(self.chain_of(s));
            }
            share * sum + (1.0 - share) * longest
        };
        let levels = self.branches.levels(&self.nodes.parent);
        busy.iter().copied().fold(0.0, f64::max) + levels.iter().map(of_level).sum::<f64>()
    }

    /// Multiplications of a front.
    fn work_of(&self, s: usize) -> f64 {
        work(self.unknowns(s).len(), self.nodes.n_below(s))
    }

    /// The longest chain of a front that threads share.
    fn chain_of(&self, s: usize) -> f64 {
        longest_chain(self.unknowns(s).len(), self.nodes.n_below(s)).min(self.work_of(s))
    }
}
