//! Variances of all rows of a list under an inverse, and their cross variances with a layout, brought up to date gauge by gauge.
//!
//! Rows are in blocks of [`WIDE`], one column after the other, so that products of all rows with a vector run in vector registers.

use super::relaxation_solution::Active;
use crate::linalg::spd;

/// Rows handled together.
const WIDE: usize = 16;

/// Rows of a list in blocks. Zeros fill the last block.
#[derive(Clone, Debug)]
pub(super) struct PackedRows {
    k: usize,
    /// Rows, a multiple of [`WIDE`].
    n: usize,
    blocks: Vec<f64>,
    arch: pulp::Arch,
}

impl PackedRows {
    pub fn from_active(active: &Active) -> Self {
        let k = active.k;
        let n = active.len().next_multiple_of(WIDE);
        let mut blocks = vec![0.0; n * k];
        for i in 0..active.len() {
            let at = i / WIDE * WIDE * k + i % WIDE;
            for (l, &v) in active.row(i).iter().enumerate() {
                blocks[at + l * WIDE] = v;
            }
        }
        Self {
            k,
            n,
            blocks,
            arch: pulp::Arch::new(),
        }
    }

    /// Returns the number of rows, including the rows of zeros.
    pub fn len(&self) -> usize {
        self.n
    }

    /// Computes `a_i' u` of every row.
    pub fn products(&self, u: &[f64], out: &mut [f64]) {
        self.arch.dispatch(|| {
            let blocks = self.blocks.chunks_exact(WIDE * self.k);
            for (block, out) in blocks.zip(out.chunks_exact_mut(WIDE)) {
                out.copy_from_slice(&product(block, u));
            }
        });
    }

    /// Computes `a_i' G a_i` of every row.
    pub fn variances(&self, g: &[f64], out: &mut [f64]) {
        self.arch.dispatch(|| {
            let blocks = self.blocks.chunks_exact(WIDE * self.k);
            for (block, out) in blocks.zip(out.chunks_exact_mut(WIDE)) {
                let mut sum = [0.0; WIDE];
                for (row, x) in g.chunks_exact(self.k).zip(block.chunks_exact(WIDE)) {
                    let y = product(block, row);
                    for ((s, a), b) in sum.iter_mut().zip(&y).zip(x) {
                        *s += a * b;
                    }
                }
                out.copy_from_slice(&sum);
            }
        });
    }
}

#[inline(always)]
fn product(block: &[f64], u: &[f64]) -> [f64; WIDE] {
    let mut sum = [0.0; WIDE];
    for (x, &c) in block.chunks_exact(WIDE).zip(u) {
        for (s, &v) in sum.iter_mut().zip(x) {
            *s += c * v;
        }
    }
    sum
}

/// An inverse, with the variances of all rows and their cross variances with the chosen rows (by slot).
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    pub inverse: Vec<f64>,
    pub d: Vec<f64>,
    cross: Vec<f64>,
    /// Products with the row that comes and the one that goes, between steps.
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Table {
    pub fn new(active: &Active, packed: &PackedRows, inverse: Vec<f64>, chosen: &[usize]) -> Self {
        let n = packed.len();
        let mut t = Self {
            d: vec![0.0; n],
            cross: vec![0.0; n * chosen.len()],
            x: vec![0.0; n],
            y: vec![0.0; n],
            inverse,
        };
        packed.variances(&t.inverse, &mut t.d);
        let mut u = vec![0.0; active.k];
        for (&j, column) in chosen.iter().zip(t.cross.chunks_exact_mut(n)) {
            spd::times(&t.inverse, active.row(j), &mut u);
            packed.products(&u, column);
        }
        t
    }

    /// Copies `other` into the existing memory.
    pub fn copy(&mut self, other: &Self) {
        self.inverse.copy_from_slice(&other.inverse);
        self.d.copy_from_slice(&other.d);
        self.cross.copy_from_slice(&other.cross);
    }

    /// Returns the cross variance of row `i` with the gauge in `slot`.
    pub fn cross_variance(&self, slot: usize, i: usize) -> f64 {
        self.cross[slot * self.d.len() + i]
    }

    /// Returns the factor on the determinant if row `i` replaces row `j` in `slot`.
    pub fn ratio(&self, slot: usize, i: usize, j: usize) -> f64 {
        let cross = self.cross_variance(slot, i);
        (1.0 + self.d[i]) * (1.0 - self.d[j]) + cross * cross
    }

    /// Returns the row whose exchange with row `j` in `slot` gives the largest factor above `least`, with this factor. `mask` is added to the
    /// factors.
    pub fn find_best_row(
        &self,
        packed: &PackedRows,
        slot: usize,
        j: usize,
        mask: &[f64],
        least: f64,
    ) -> Option<(f64, usize)> {
        let n = self.d.len();
        let left = 1.0 - self.d[j];
        let column = &self.cross[slot * n..(slot + 1) * n];
        packed.arch.dispatch(|| {
            let mut best = (least, usize::MAX);
            let wide = self.d.chunks_exact(WIDE);
            let wide = wide
                .zip(column.chunks_exact(WIDE))
                .zip(mask.chunks_exact(WIDE));
            for (b, ((d, c), m)) in wide.enumerate() {
                let ratio: [f64; WIDE] =
                    std::array::from_fn(|l| (1.0 + d[l]) * left + c[l] * c[l] + m[l]);
                let mut above = false;
                for r in ratio {
                    above |= r > best.0;
                }
                if above {
                    for (l, r) in ratio.into_iter().enumerate() {
                        if r > best.0 {
                            best = (r, b * WIDE + l);
                        }
                    }
                }
            }
            (best.1 != usize::MAX).then_some(best)
        })
    }

    /// Updates the table after row `i` has replaced the gauge in `slot` of `chosen`.
    pub fn swap(
        &mut self,
        active: &Active,
        packed: &PackedRows,
        chosen: &[usize],
        slot: usize,
        i: usize,
    ) {
        let (n, k) = (packed.len(), active.k);
        let j = chosen[slot];
        let mut ui = vec![0.0; k];
        spd::times(&self.inverse, active.row(i), &mut ui);
        packed.products(&ui, &mut self.x);
        let mut uj = vec![0.0; k];
        spd::times(&self.inverse, active.row(j), &mut uj);
        let add = 1.0 / (1.0 + self.d[i]);
        let xj = self.x[j];
        for (a, b) in uj.iter_mut().zip(&ui) {
            *a -= add * xj * b;
        }
        let (x, y, d, cross) = (&self.x, &mut self.y, &mut self.d, &mut self.cross);
        packed.arch.dispatch(|| {
            let column = &cross[slot * n..(slot + 1) * n];
            for ((v, &c), &a) in y.iter_mut().zip(column).zip(x) {
                *v = c - add * a * xj;
            }
        });
        let drop = 1.0 / (1.0 - y[j]);
        spd::add_outer(&mut self.inverse, &ui, -add);
        spd::add_outer(&mut self.inverse, &uj, drop);
        packed.arch.dispatch(|| {
            for ((v, &a), &b) in d.iter_mut().zip(x).zip(&*y) {
                *v += drop * b * b - add * a * a;
            }
            for (c, column) in cross.chunks_exact_mut(n).enumerate() {
                // The products with the new gauge replace the products with the old gauge, and are updated as well.
                let q = if c == slot { i } else { chosen[c] };
                let (p, r) = (add * x[q], drop * y[q]);
                if c == slot {
                    column.copy_from_slice(x);
                }
                for ((v, &a), &b) in column.iter_mut().zip(x).zip(&*y) {
                    *v += r * b - p * a;
                }
            }
        });
    }
}
