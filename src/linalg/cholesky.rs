//! The Cholesky factor of a dense covariance: solutions, chi-squares, log-determinant, inverse.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{
    LltParams, LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::cholesky::llt::inverse::{inverse, inverse_scratch};
use faer::{Auto, MatMut, MatRef, Par, Spec};

/// Order from which blocks pay: below it the setting up of blocks takes longer than a plain loop.
const BLOCKED: usize = 64;

/// Lower Cholesky factor `L` of a covariance `C = L L'`, with `ln det C`. It gives `C^-1 x` and `x' C^-1 x` without an inverse.
///
/// # Example
/// ```
/// use strainbridge::linalg::cholesky::Cholesky;
///
/// let covariance = [4.0, 2.0, 2.0, 3.0]; // det = 8
/// let factor = Cholesky::from_covariance(&covariance, 2).unwrap();
/// assert!((factor.log_det() - 8.0_f64.ln()).abs() < 1e-12);
/// let x = factor.solve(&[8.0, 8.0]); // C x = b
/// assert!((4.0 * x[0] + 2.0 * x[1] - 8.0).abs() < 1e-12);
/// assert!((2.0 * x[0] + 3.0 * x[1] - 8.0).abs() < 1e-12);
/// // Correlations above 1 are impossible.
/// assert!(Cholesky::from_covariance(&[1.0, 2.0, 2.0, 1.0], 2).is_none());
/// ```
#[derive(Clone, Debug)]
pub struct Cholesky {
    n: usize,
    /// `L` by columns, zero above the diagonal.
    columns: Vec<f64>,
    log_det: f64,
}

impl Cholesky {
    /// Returns the factor of `covariance` (`n x n` by rows, lower triangle read). `None` if it is not positive definite.
    pub fn from_covariance(covariance: &[f64], n: usize) -> Option<Self> {
        if covariance.len() != n * n {
            return None;
        }
        let mut columns = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                columns[j * n + i] = covariance[i * n + j];
            }
        }
        match workspace(
            n,
            cholesky_in_place_scratch::<f64>(n, Par::Seq, parameters()),
        ) {
            Some(mut memory) => factor_by_blocks(&mut columns, n, &mut memory)?,
            None => factor_by_columns(&mut columns, n),
        }
        let pivots = || (0..n).map(|i| columns[i * n + i]);
        if !pivots().all(|p| p > 0.0 && p.is_finite()) {
            return None;
        }
        let log_det = 2.0 * pivots().map(f64::ln).sum::<f64>();
        Some(Self {
            n,
            columns,
            log_det,
        })
    }

    /// Returns the order of the matrix.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Returns `ln det C`.
    pub fn log_det(&self) -> f64 {
        self.log_det
    }

    /// Returns `C^-1 x`.
    pub fn solve(&self, x: &[f64]) -> Vec<f64> {
        let mut out = self.whiten_vector(x);
        for j in (0..self.n).rev() {
            let (own, column) = self.column(j);
            let (head, tail) = out.split_at_mut(j + 1);
            head[j] = (head[j] - dot(column, tail)) / own;
        }
        out
    }

    /// Returns `x' C^-1 x`.
    pub fn chi2(&self, x: &[f64]) -> f64 {
        self.whiten_vector(x).iter().map(|v| v * v).sum()
    }

    /// `L^-1 x`; what `x` lacks is zero.
    fn whiten_vector(&self, x: &[f64]) -> Vec<f64> {
        let mut out = x.to_vec();
        out.resize(self.n, 0.0);
        for j in 0..self.n {
            let (own, column) = self.column(j);
            let (head, tail) = out.split_at_mut(j + 1);
            head[j] /= own;
            let v = head[j];
            if v == 0.0 {
                continue;
            }
            tail.iter_mut().zip(column).for_each(|(t, l)| *t -= v * l);
        }
        out
    }

    /// Pivot `j`, and the column below it.
    fn column(&self, j: usize) -> (f64, &[f64]) {
        let below = &self.columns[j * self.n + j..(j + 1) * self.n];
        (below[0], &below[1..])
    }

    /// Returns `C^-1`, `n x n`.
    pub fn inverse(&self) -> Vec<f64> {
        let n = self.n;
        match workspace(n, inverse_scratch::<f64>(n, Par::Seq)) {
            Some(mut memory) => self.inverse_by_blocks(&mut memory),
            None => self.inverse_by_columns(),
        }
    }

    fn inverse_by_columns(&self) -> Vec<f64> {
        let n = self.n;
        let mut out = Vec::with_capacity(n * n);
        let mut unit = vec![0.0; n];
        for j in 0..n {
            unit[j] = 1.0;
            out.extend(self.solve(&unit));
            unit[j] = 0.0;
        }
        out
    }

    fn inverse_by_blocks(&self, memory: &mut MemBuffer) -> Vec<f64> {
        let n = self.n;
        let mut out = vec![0.0; n * n];
        inverse(
            MatMut::from_column_major_slice_mut(&mut out, n, n),
            MatRef::from_column_major_slice(&self.columns, n, n),
            Par::Seq,
            MemStack::new(memory),
        );
        // Only one triangle is filled; copy it to the other.
        for j in 0..n {
            for i in j + 1..n {
                out[i * n + j] = out[j * n + i];
            }
        }
        out
    }
}

/// Returns memory for blocks; `None` if blocks are slower, or without room for it: a plain loop needs none.
fn workspace(n: usize, size: StackReq) -> Option<MemBuffer> {
    (n >= BLOCKED)
        .then(|| MemBuffer::try_new(size).ok())
        .flatten()
}

fn parameters() -> Spec<LltParams, f64> {
    Spec::new(<LltParams as Auto<f64>>::auto())
}

/// Replaces the lower triangle of `a`, by columns, by its factor; a matrix that is not positive definite gives pivots that are NaN.
fn factor_by_columns(a: &mut [f64], n: usize) {
    for j in 0..n {
        let (before, rest) = a.split_at_mut(j * n);
        let own = &mut rest[j..n];
        for k in 0..j {
            let other = &before[k * n + j..(k + 1) * n];
            let v = other[0];
            own.iter_mut().zip(other).for_each(|(o, l)| *o -= v * l);
        }
        let pivot = own[0].sqrt();
        own.iter_mut().for_each(|v| *v /= pivot);
        own[0] = pivot;
    }
}

/// Replaces the lower triangle of `a` by its factor, by blocks; `None` if the matrix is not positive definite.
fn factor_by_blocks(a: &mut [f64], n: usize, memory: &mut MemBuffer) -> Option<()> {
    cholesky_in_place(
        MatMut::from_column_major_slice_mut(a, n, n),
        LltRegularization::default(),
        Par::Seq,
        MemStack::new(memory),
        parameters(),
    )
    .ok()?;
    // Values that the blocks leave above the diagonal are not part of the factor.
    for j in 1..n {
        a[j * n..j * n + j].fill(0.0);
    }
    Some(())
}

/// Sum of products of long vectors, in eight partial sums that the processor runs side by side: twice as many as [`super::spd::dot`].
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (whole_a, whole_b) = (a.chunks_exact(8), b.chunks_exact(8));
    let (rest_a, rest_b) = (whole_a.remainder(), whole_b.remainder());
    for (x, y) in whole_a.zip(whole_b) {
        for (lane, (u, v)) in lanes.iter_mut().zip(x.iter().zip(y)) {
            *lane += u * v;
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(x, y)| x * y).sum();
    lanes.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests;
