//! The graph of groups of unknowns: who shares an entry of the matrix with whom.

/// Mark for no vertex: a root has no parent, and a vertex that no search has reached has no component.
pub(super) const NONE: u32 = u32::MAX;

/// An undirected graph, both directions stored, no loops, neighbours ascending.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BlockGraph {
    pub(super) start: Vec<usize>,
    pub(super) neighbours: Vec<u32>,
}

impl BlockGraph {
    /// Returns the graph in which the members of each clique are joined, over `n` vertices.
    ///
    /// `cliques` is walked twice: first to count, then to fill.
    pub fn from_cliques<'a, I>(n: usize, cliques: impl Fn() -> I) -> Self
    where
        I: Iterator<Item = &'a [u32]>,
    {
        let mut start = vec![0_usize; n + 1];
        for clique in cliques() {
            for &v in clique {
                start[v as usize + 1] += clique.len().saturating_sub(1);
            }
        }
        for v in 0..n {
            start[v + 1] += start[v];
        }
        let mut fill = start.clone();
        let mut neighbours = vec![0_u32; start[n]];
        for clique in cliques() {
            for (i, &v) in clique.iter().enumerate() {
                for (j, &w) in clique.iter().enumerate() {
                    if i != j {
                        neighbours[fill[v as usize]] = w;
                        fill[v as usize] += 1;
                    }
                }
            }
        }
        let mut kept = 0;
        let mut packed_start = vec![0_usize; n + 1];
        for v in 0..n {
            let (from, to) = (start[v], start[v + 1]);
            neighbours[from..to].sort_unstable();
            let first = kept;
            for i in from..to {
                let w = neighbours[i];
                if w as usize != v && (kept == first || neighbours[kept - 1] != w) {
                    neighbours[kept] = w;
                    kept += 1;
                }
            }
            packed_start[v + 1] = kept;
        }
        neighbours.truncate(kept);
        neighbours.shrink_to_fit();
        Self {
            start: packed_start,
            neighbours,
        }
    }

    /// Returns the number of vertices.
    pub fn n(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// Returns the neighbours of a vertex, ascending.
    pub fn neighbours(&self, v: usize) -> &[u32] {
        &self.neighbours[self.start[v]..self.start[v + 1]]
    }

    /// Returns the component number of every vertex, and how many components there are.
    pub fn components(&self) -> (Vec<u32>, usize) {
        let mut of = vec![NONE; self.n()];
        let mut count = 0;
        let mut stack = Vec::new();
        for seed in 0..self.n() {
            if of[seed] != NONE {
                continue;
            }
            of[seed] = count;
            stack.push(seed);
            while let Some(v) = stack.pop() {
                for &w in self.neighbours(v) {
                    if of[w as usize] == NONE {
                        of[w as usize] = count;
                        stack.push(w as usize);
                    }
                }
            }
            count += 1;
        }
        (of, count as usize)
    }
}

/// Returns the inverse of a permutation.
pub(super) fn inverse(order: &[u32]) -> Vec<u32> {
    let mut position = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        position[old as usize] = new as u32;
    }
    position
}
