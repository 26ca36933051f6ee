//! Elimination tree, postorder, column structure and supernodes of a graph in a given elimination order.

use super::graph::BlockGraph;

const NONE: u32 = u32::MAX;

/// Columns eliminated together and the rows below them, in the labels of the postordered elimination.
#[derive(Clone, Debug, Default)]
pub(super) struct Columns {
    pub(super) cols: Vec<u32>,
    pub(super) rows: Vec<u32>,
}

/// Parent of every vertex in the elimination tree (Liu 1990, path compression), `NONE` for roots; labels are positions in `order`.
fn elimination_tree(graph: &BlockGraph, order: &[u32], position: &[u32]) -> Vec<u32> {
    let mut parent = vec![NONE; order.len()];
    let mut ancestor = vec![NONE; order.len()];
    for (j, &old) in order.iter().enumerate() {
        for &w in graph.neighbours(old as usize) {
            let mut i = position[w as usize] as usize;
            while i < j {
                let next = std::mem::replace(&mut ancestor[i], j as u32);
                if next == NONE {
                    parent[i] = j as u32;
                    break;
                }
                i = next as usize;
            }
        }
    }
    parent
}

/// Vertices of a forest, children before parents, subtrees contiguous.
pub(super) fn postorder(parent: &[u32]) -> Vec<u32> {
    let n = parent.len();
    let (mut first, mut next) = (vec![NONE; n], vec![NONE; n]);
    let mut roots = Vec::new();
    for v in (0..n).rev() {
        match parent[v] {
            NONE => roots.push(v as u32),
            p => next[v] = std::mem::replace(&mut first[p as usize], v as u32),
        }
    }
    let mut order = Vec::with_capacity(n);
    let mut stack = Vec::new();
    for root in roots.into_iter().rev() {
        stack.push(root);
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
    }
    order
}

/// Inverse of a permutation.
pub(super) fn inverse(order: &[u32]) -> Vec<u32> {
    let mut position = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        position[old as usize] = new as u32;
    }
    position
}

/// The postordered order and the supernodes of its factor without any amalgamation, columns ascending.
pub(super) fn supernodes(graph: &BlockGraph, order: &[u32]) -> (Vec<u32>, Vec<Columns>) {
    let n = order.len();
    let parent = elimination_tree(graph, order, &inverse(order));
    let post = postorder(&parent);
    let relabel = inverse(&post);
    let order: Vec<u32> = post.iter().map(|&v| order[v as usize]).collect();
    let position = inverse(&order);
    let (mut first_child, mut sibling) = (vec![NONE; n], vec![NONE; n]);
    for (v, &p) in parent.iter().enumerate() {
        if p != NONE {
            let (v, p) = (relabel[v], relabel[p as usize] as usize);
            sibling[v as usize] = std::mem::replace(&mut first_child[p], v);
        }
    }
    let mut all: Vec<Columns> = Vec::new();
    let mut of = vec![NONE; n];
    let mut mark = vec![NONE; n];
    let mut rows = Vec::new();
    for j in 0..n as u32 {
        rows.clear();
        mark[j as usize] = j;
        let mut push = |r: u32, rows: &mut Vec<u32>| {
            if r > j && mark[r as usize] != j {
                mark[r as usize] = j;
                rows.push(r);
            }
        };
        for &w in graph.neighbours(order[j as usize] as usize) {
            push(position[w as usize], &mut rows);
        }
        let mut continues = NONE;
        let mut child = first_child[j as usize];
        while child != NONE {
            let s = of[child as usize];
            for &r in &all[s as usize].rows {
                push(r, &mut rows);
            }
            if child + 1 == j {
                continues = s;
            }
            child = sibling[child as usize];
        }
        if continues != NONE && all[continues as usize].rows.len() == rows.len() + 1 {
            let s = &mut all[continues as usize];
            s.cols.push(j);
            s.rows.clear();
            s.rows.extend_from_slice(&rows);
            of[j as usize] = continues;
        } else {
            of[j as usize] = all.len() as u32;
            all.push(Columns {
                cols: vec![j],
                rows: rows.clone(),
            });
        }
    }
    (order, all)
}
