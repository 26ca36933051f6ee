//! Supernodes: groups next to each other in elimination order whose columns have the same rows below them.
//!
//! Found on the graph of groups, so that their rows are lists of groups. Small ones are merged with their parents: a few explicit zeros cost
//! less than many small dense matrices.
//!
//! # Reference
//! C. Ashcraft, R. Grimes, The influence of relaxed supernode partitions on the multifrontal method, ACM Trans. Math. Softw. 15 (1989) 291.

use super::forest::EliminationForest;
use super::graph::NONE;
use super::graph::{BlockGraph, inverse};
use std::ops::Range;

/// Largest share of explicit zeros in a merged supernode of up to so many columns.
const ZEROS: [(usize, f64); 4] = [(24, 0.6), (48, 0.3), (96, 0.12), (usize::MAX, 0.04)];

/// Supernodes in elimination order: children before parents, subtrees contiguous.
#[derive(Debug, Default)]
pub(super) struct Supernodes {
    /// First group of each supernode, and the total.
    pub(super) first: Vec<u32>,
    /// Parent of each supernode.
    pub(super) parent: Vec<u32>,
    /// First of the rows of each, and the total.
    row_start: Vec<usize>,
    /// Groups below a supernode's own, ascending.
    rows: Vec<u32>,
    /// Unknowns of the rows below.
    below: Vec<u32>,
    /// First value of each in the factor, and the total: columns of the supernode's rows and the rows below, one after the other.
    value_start: Vec<usize>,
}

impl Supernodes {
    /// Returns the supernodes of a forest, and the order (new to old group) in which merged supernodes are contiguous.
    pub(super) fn new(
        graph: &BlockGraph,
        forest: &EliminationForest,
        sizes: &[u8],
    ) -> (Self, Vec<u32>) {
        let mut merged = MergedSupernodes::from_forest(forest, sizes);
        merged.merge();
        let (mut nodes, order) = merged.number_supernodes(&forest.order);
        nodes.find_rows(graph, &order, sizes);
        (nodes, order)
    }

    pub(super) fn len(&self) -> usize {
        self.parent.len()
    }

    /// Returns the groups of supernode `s`.
    pub(super) fn groups(&self, s: usize) -> Range<usize> {
        self.first[s] as usize..self.first[s + 1] as usize
    }

    /// Returns the groups below the groups of supernode `s`.
    pub(super) fn rows(&self, s: usize) -> &[u32] {
        &self.rows[self.row_start[s]..self.row_start[s + 1]]
    }

    /// Returns the unknowns of the rows below.
    pub(super) fn n_below(&self, s: usize) -> usize {
        self.below[s] as usize
    }

    /// Returns the values in the factor.
    pub(super) fn values(&self, s: Range<usize>) -> Range<usize> {
        self.value_start[s.start]..self.value_start[s.end]
    }

    /// Returns the values of the factor, explicit zeros of merged supernodes included.
    pub(super) fn n_values(&self) -> usize {
        self.value_start.last().copied().unwrap_or(0)
    }

    fn find_rows(&mut self, graph: &BlockGraph, order: &[u32], sizes: &[u8]) {
        let n = self.len();
        let position = inverse(order);
        let mut seen = vec![NONE; order.len()];
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); n];
        (self.row_start, self.value_start) = (vec![0], vec![0]);
        let mut values = 0;
        for s in 0..n {
            let groups = self.groups(s);
            let mut rows = Vec::new();
            let mut add = |g: u32| {
                if g as usize >= groups.end && seen[g as usize] != s as u32 {
                    seen[g as usize] = s as u32;
                    rows.push(g);
                }
            };
            for &old in &order[groups.clone()] {
                let near = graph.neighbours(old as usize).iter();
                near.for_each(|w| add(position[*w as usize]));
            }
            for &c in &children[s] {
                self.rows(c as usize).iter().for_each(|g| add(*g));
            }
            rows.sort_unstable();
            let unknowns = |g: usize| usize::from(sizes[order[g] as usize]);
            let own: usize = groups.map(unknowns).sum();
            let below: usize = rows.iter().map(|g| unknowns(*g as usize)).sum();
            values += own * (own + 1) / 2 + own * below;
            self.rows.extend(rows);
            self.row_start.push(self.rows.len());
            self.below.push(below as u32);
            self.value_start.push(values);
            if self.parent[s] != NONE {
                children[self.parent[s] as usize].push(s as u32);
            }
        }
        self.rows.shrink_to_fit();
    }
}

/// Supernodes being merged. A supernode that is merged into another is no longer a child.
struct MergedSupernodes {
    /// Groups of each at first, numbered as in the forest.
    groups: Vec<Range<u32>>,
    /// First ones that each consists of.
    members: Vec<Vec<u32>>,
    children: Vec<Vec<u32>>,
    roots: Vec<u32>,
    /// Unknowns of each supernode, and below it.
    own: Vec<usize>,
    below: Vec<usize>,
    zeros: Vec<usize>,
}

impl MergedSupernodes {
    /// Groups joined to the next where that has the same rows below.
    fn from_forest(forest: &EliminationForest, sizes: &[u8]) -> Self {
        let n = forest.order.len();
        let size = |g: usize| u32::from(sizes[forest.order[g] as usize]);
        let mut all = Self {
            groups: Vec::new(),
            members: Vec::new(),
            children: Vec::new(),
            roots: Vec::new(),
            own: Vec::new(),
            below: Vec::new(),
            zeros: Vec::new(),
        };
        let mut of = vec![0_u32; n];
        let mut first = 0;
        for g in 0..n {
            of[g] = all.groups.len() as u32;
            let joined = forest.parent[g] as usize == g + 1
                && forest.below[g] == forest.below[g + 1] + size(g + 1);
            if !joined {
                all.members.push(vec![all.groups.len() as u32]);
                all.groups.push(first as u32..g as u32 + 1);
                all.own.push((first..=g).map(|g| size(g) as usize).sum());
                all.below.push(forest.below[g] as usize);
                first = g + 1;
            }
        }
        all.zeros = vec![0; all.groups.len()];
        all.children = vec![Vec::new(); all.groups.len()];
        for s in 0..all.groups.len() {
            match forest.parent[all.groups[s].end as usize - 1] {
                NONE => all.roots.push(s as u32),
                p => all.children[of[p as usize] as usize].push(s as u32),
            }
        }
        all
    }

    /// Merges children into parents, lowest first, those that add the fewest zeros first.
    fn merge(&mut self) {
        for p in 0..self.groups.len() {
            let mut children = std::mem::take(&mut self.children[p]);
            let missing = |c: &u32| {
                let c = *c as usize;
                self.own[c] * (self.own[p] + self.below[p] - self.below[c])
            };
            children.sort_by_cached_key(|c| (missing(c), *c));
            let mut kept = Vec::with_capacity(children.len());
            for c in children {
                let i = c as usize;
                let own = self.own[p] + self.own[i];
                let zeros = self.zeros[p]
                    + self.zeros[i]
                    + self.own[i] * (self.own[p] + self.below[p] - self.below[i]);
                let entries = own * (own + 1) / 2 + own * self.below[p];
                let most = ZEROS.iter().find(|z| own <= z.0).map_or(0.0, |z| z.1);
                if zeros as f64 <= most * entries as f64 {
                    (self.own[p], self.zeros[p]) = (own, zeros);
                    let members = std::mem::take(&mut self.members[i]);
                    self.members[p].extend(members);
                    kept.append(&mut self.children[i]);
                } else {
                    kept.push(c);
                }
            }
            self.children[p] = kept;
        }
    }

    /// Returns the supernodes in postorder without rows, and the order of groups. Children that need much memory and leave little come first.
    fn number_supernodes(mut self, order: &[u32]) -> (Supernodes, Vec<u32>) {
        let n = self.groups.len();
        let mut peak = vec![0_usize; n];
        for p in 0..n {
            let left = |c: u32| self.below[c as usize].pow(2);
            let mut children = std::mem::take(&mut self.children[p]);
            children.sort_by_key(|c| {
                let keep = left(*c);
                (
                    std::cmp::Reverse(peak[*c as usize].saturating_sub(keep)),
                    *c,
                )
            });
            let mut kept = 0;
            for &c in &children {
                peak[p] = peak[p].max(kept + peak[c as usize]);
                kept += left(c);
            }
            peak[p] = peak[p].max(kept + left(p as u32));
            self.children[p] = children;
        }
        let mut nodes = Supernodes {
            first: vec![0],
            ..Supernodes::default()
        };
        let (mut number, mut heads) = (vec![NONE; n], Vec::with_capacity(n));
        let mut new_order = Vec::with_capacity(order.len());
        let mut open: Vec<(u32, usize)> = self.roots.iter().rev().map(|r| (*r, 0)).collect();
        while let Some((s, next)) = open.last_mut() {
            let s = *s as usize;
            if let Some(child) = self.children[s].get(*next) {
                *next += 1;
                open.push((*child, 0));
                continue;
            }
            open.pop();
            self.members[s].sort_unstable();
            for &f in &self.members[s] {
                let groups = self.groups[f as usize].clone();
                new_order.extend(groups.map(|g| order[g as usize]));
            }
            number[s] = heads.len() as u32;
            heads.push(s);
            nodes.first.push(new_order.len() as u32);
        }
        nodes.parent = vec![NONE; heads.len()];
        for (p, &s) in heads.iter().enumerate() {
            for &c in &self.children[s] {
                nodes.parent[number[c as usize] as usize] = p as u32;
            }
        }
        (nodes, new_order)
    }
}
