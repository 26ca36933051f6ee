//! The shape of the factor: order, supernodes, sizes.

use super::graph::BlockGraph;
use super::order::{OrderingMethod, candidates};
use super::supernode::{Columns, inverse, postorder, supernodes};

/// A child is merged into its parent when the merged columns (unknowns) and the share of zeros stored for it stay below one of these pairs.
const RELAX: [(usize, f64); 4] = [(24, 0.7), (48, 0.4), (144, 0.12), (usize::MAX, 0.04)];

/// Columns (groups `first .. end` of the new order) eliminated together, and the groups below.
#[derive(Clone, Debug, Default)]
pub(super) struct Supernode {
    pub(super) first: u32,
    pub(super) end: u32,
    pub(super) rows: Vec<u32>,
    /// Unknowns in the columns and in the rows below.
    pub(super) n_cols: usize,
    pub(super) n_rows: usize,
    /// Index of the parent supernode.
    pub(super) parent: Option<u32>,
    pub(super) n_children: u32,
    /// First supernode of its subtree.
    pub(super) first_descendant: u32,
    /// Floating point operations of its subtree.
    pub(super) subtree_flops: f64,
}

/// The symbolic factor.
#[derive(Clone, Debug)]
pub struct Symbolic {
    /// New to old group.
    pub(super) order: Vec<u32>,
    /// Old to new group.
    pub(super) position: Vec<u32>,
    /// First unknown by new group, and the total.
    pub(super) start: Vec<usize>,
    /// First unknown by old group, and the total.
    pub(super) old_start: Vec<usize>,
    pub(super) supernodes: Vec<Supernode>,
    method: OrderingMethod,
    nonzeros: usize,
}

impl Symbolic {
    /// The smaller factor of the orders compared; `sizes` are the unknowns in each group.
    pub fn analyse(graph: &BlockGraph, sizes: &[u8]) -> Self {
        use rayon::prelude::*;
        let mut all: Vec<Symbolic> = candidates(graph)
            .into_par_iter()
            .map(|(method, order)| Self::with_order(graph, sizes, method, &order))
            .collect();
        all.sort_by_key(|s| s.nonzeros);
        all.swap_remove(0)
    }

    fn with_order(graph: &BlockGraph, sizes: &[u8], method: OrderingMethod, order: &[u32]) -> Self {
        let (order, all) = supernodes(graph, order);
        let weight: Vec<usize> = order
            .iter()
            .map(|&v| usize::from(sizes[v as usize]))
            .collect();
        let (order, supernodes) = number(&order, amalgamate(all, &weight), sizes);
        let running = |sizes: &mut dyn Iterator<Item = usize>| {
            let mut start = vec![0];
            let mut total = 0;
            for s in sizes {
                total += s;
                start.push(total);
            }
            start
        };
        let start = running(&mut order.iter().map(|&v| usize::from(sizes[v as usize])));
        let old_start = running(&mut sizes.iter().map(|&s| usize::from(s)));
        let nonzeros = supernodes
            .iter()
            .map(|s| s.n_cols * (s.n_cols + 1) / 2 + s.n_cols * s.n_rows)
            .sum();
        Self {
            position: inverse(&order),
            order,
            start,
            old_start,
            supernodes,
            method,
            nonzeros,
        }
    }

    /// Which ordering was kept.
    pub fn method(&self) -> OrderingMethod {
        self.method
    }

    /// Entries of the factor, explicit zeros of merged supernodes included.
    pub fn factor_nonzeros(&self) -> usize {
        self.nonzeros
    }

    /// Number of unknowns.
    pub fn n_unknowns(&self) -> usize {
        self.old_start.last().copied().unwrap_or(0)
    }

    /// First unknown of each group in the caller's numbering, and the total.
    pub fn unknown_start(&self) -> &[usize] {
        &self.old_start
    }
}

/// Supernodes after merging children into parents; `None` where a supernode was merged away. With parents.
fn amalgamate(mut all: Vec<Columns>, weight: &[usize]) -> Vec<(Columns, Option<u32>)> {
    let n = all.len();
    let mut of = vec![0_u32; weight.len()];
    for (s, c) in all.iter().enumerate() {
        for &j in &c.cols {
            of[j as usize] = s as u32;
        }
    }
    let sum = |list: &[u32]| list.iter().map(|&v| weight[v as usize]).sum::<usize>();
    let mut cols: Vec<usize> = all.iter().map(|c| sum(&c.cols)).collect();
    let rows: Vec<usize> = all.iter().map(|c| sum(&c.rows)).collect();
    let mut zeros = vec![0_usize; n];
    let mut parent: Vec<Option<u32>> = all
        .iter()
        .map(|c| c.rows.iter().min().map(|&r| of[r as usize]))
        .collect();
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); n];
    for (s, p) in parent.iter().enumerate() {
        if let Some(p) = p {
            children[*p as usize].push(s as u32);
        }
    }
    let mut merged_into: Vec<Option<u32>> = vec![None; n];
    for p in 0..n {
        let mut list = std::mem::take(&mut children[p]);
        list.sort_by_key(|&c| {
            (cols[p] + rows[p]).saturating_sub(rows[c as usize]) * cols[c as usize]
        });
        for c in list {
            let c = c as usize;
            let new_zeros =
                zeros[p] + zeros[c] + cols[c] * (cols[p] + rows[p]).saturating_sub(rows[c]);
            let width = cols[p] + cols[c];
            let entries = width * (width + 1) / 2 + width * rows[p];
            let share = new_zeros as f64 / entries.max(1) as f64;
            if RELAX.iter().any(|&(w, z)| width <= w && share < z) {
                let moved = std::mem::take(&mut all[c].cols);
                all[p].cols.extend(moved);
                all[c].rows = Vec::new();
                cols[p] = width;
                zeros[p] = new_zeros;
                merged_into[c] = Some(p as u32);
            }
        }
    }
    for s in 0..n {
        while let Some(p) = parent[s] {
            match merged_into[p as usize] {
                Some(q) => parent[s] = Some(q),
                None => break,
            }
        }
    }
    let mut new_index = vec![0_u32; n];
    let mut count = 0;
    for s in 0..n {
        new_index[s] = count;
        count += u32::from(merged_into[s].is_none());
    }
    all.into_iter()
        .zip(parent)
        .zip(merged_into)
        .filter(|(_, merged)| merged.is_none())
        .map(|((c, p), _)| (c, p.map(|p| new_index[p as usize])))
        .collect()
}

/// Renumbers groups so that each supernode's columns are contiguous and children come before parents.
fn number(
    order: &[u32],
    all: Vec<(Columns, Option<u32>)>,
    sizes: &[u8],
) -> (Vec<u32>, Vec<Supernode>) {
    let parents: Vec<u32> = all.iter().map(|(_, p)| p.unwrap_or(u32::MAX)).collect();
    let post = postorder(&parents);
    let place = inverse(&post);
    let mut label = vec![0_u32; order.len()];
    let mut new_order = Vec::with_capacity(order.len());
    let mut result: Vec<Supernode> = Vec::with_capacity(all.len());
    let mut all: Vec<Option<(Columns, Option<u32>)>> = all.into_iter().map(Some).collect();
    let mut rows_of = Vec::with_capacity(all.len());
    for &s in &post {
        let Some((mut columns, parent)) = all[s as usize].take() else {
            continue;
        };
        columns.cols.sort_unstable();
        let first = new_order.len() as u32;
        for &c in &columns.cols {
            label[c as usize] = new_order.len() as u32;
            new_order.push(order[c as usize]);
        }
        result.push(Supernode {
            first,
            end: new_order.len() as u32,
            parent: parent.map(|p| place[p as usize]),
            ..Supernode::default()
        });
        rows_of.push(columns.rows);
    }
    let weight = |v: u32| usize::from(sizes[new_order[v as usize] as usize]);
    for (s, (node, mut rows)) in result.iter_mut().zip(rows_of).enumerate() {
        rows.iter_mut().for_each(|r| *r = label[*r as usize]);
        rows.sort_unstable();
        node.n_cols = (node.first..node.end).map(weight).sum();
        node.n_rows = rows.iter().map(|&r| weight(r)).sum();
        node.rows = rows;
        node.first_descendant = s as u32;
        let (c, r) = (node.n_cols as f64, node.n_rows as f64);
        node.subtree_flops = c * c * c / 3.0 + c * c * r + c * r * r;
    }
    for s in 0..result.len() {
        if let Some(p) = result[s].parent {
            let (first, flops) = (result[s].first_descendant, result[s].subtree_flops);
            let p = &mut result[p as usize];
            p.n_children += 1;
            p.first_descendant = p.first_descendant.min(first);
            p.subtree_flops += flops;
        }
    }
    (new_order, result)
}
