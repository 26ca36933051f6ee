//! Small symmetric positive definite matrices, `k x k` by rows in a slice: Cholesky, inverse, rank-one changes.
//!
//! Used where a placement changes its information matrix thousands of times; `k` is the number of loads (6 to 60).

/// Returns the lower Cholesky factor `L` with `L L' = a`, or `None` if `a` is not positive definite to working precision.
#[inline(always)]
pub fn cholesky(a: &[f64], k: usize) -> Option<Vec<f64>> {
    let mut l = vec![0.0; k * k];
    for i in 0..k {
        for j in 0..=i {
            let sum = a[i * k + j] - dot(&l[i * k..i * k + j], &l[j * k..j * k + j]);
            if i == j {
                // A pivot this far below its diagonal entry is rounding error of the subtraction, not information.
                if sum.is_nan() || sum <= PIVOT_FLOOR * a[i * k + i].abs() {
                    return None;
                }
                l[i * k + i] = sum.sqrt();
            } else {
                l[i * k + j] = sum / l[j * k + j];
            }
        }
    }
    Some(l)
}

/// Relative size under which a Cholesky pivot counts as zero.
const PIVOT_FLOOR: f64 = 1e-14;

/// Returns `ln det(L L')`.
pub fn log_det(l: &[f64], k: usize) -> f64 {
    2.0 * (0..k).map(|i| l[i * k + i].ln()).sum::<f64>()
}

/// Returns the inverse of a lower triangular matrix.
pub fn inverse_lower(l: &[f64], k: usize) -> Vec<f64> {
    let mut inv = vec![0.0; k * k];
    for j in 0..k {
        inv[j * k + j] = 1.0 / l[j * k + j];
        for i in j + 1..k {
            let sum: f64 = (j..i).map(|p| l[i * k + p] * inv[p * k + j]).sum();
            inv[i * k + j] = -sum / l[i * k + i];
        }
    }
    inv
}

/// Returns `inv' inv` for a lower triangular `inv`. It is the inverse of `L L'` from the inverse of `L`.
pub fn gram_of_lower(inv: &[f64], k: usize) -> Vec<f64> {
    let mut g = vec![0.0; k * k];
    for p in 0..k {
        for i in 0..=p {
            let x = inv[p * k + i];
            for j in 0..=i {
                g[i * k + j] += x * inv[p * k + j];
            }
        }
    }
    for i in 0..k {
        for j in 0..i {
            g[j * k + i] = g[i * k + j];
        }
    }
    g
}

/// Returns a lower triangular `w` with `w' w = g` for a symmetric positive semidefinite `g`. Rows of directions in which `g` is zero are zero.
pub fn lower_root(g: &[f64], k: usize) -> Vec<f64> {
    let mut rest = g.to_vec();
    let mut w = vec![0.0; k * k];
    for p in (0..k).rev() {
        let pivot = rest[p * k + p];
        // As in `cholesky`, a pivot this far below its diagonal entry is rounding error.
        if !(pivot > ROOT_FLOOR * g[p * k + p]) {
            continue;
        }
        let root = pivot.sqrt();
        for j in 0..=p {
            w[p * k + j] = rest[p * k + j] / root;
        }
        for i in 0..p {
            for j in 0..p {
                rest[i * k + j] -= w[p * k + i] * w[p * k + j];
            }
        }
    }
    w
}

/// Relative size under which a pivot of a product of matrices counts as zero; products carry more rounding than sums.
const ROOT_FLOOR: f64 = 1e-12;

/// Returns the eigenvalues of a symmetric matrix, ascending.
pub fn eigenvalues(a: &[f64], k: usize) -> Vec<f64> {
    let matrix = nalgebra::DMatrix::from_row_slice(k, k, a);
    let mut e: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    e.sort_by(f64::total_cmp);
    e
}

/// Returns `a b`, all `k x k`.
pub fn product(a: &[f64], b: &[f64], k: usize) -> Vec<f64> {
    let mut c = vec![0.0; k * k];
    for i in 0..k {
        for p in 0..k {
            let x = a[i * k + p];
            for j in 0..k {
                c[i * k + j] += x * b[p * k + j];
            }
        }
    }
    c
}

/// Adds an outer product: `a += weight x x'`.
pub fn add_outer(a: &mut [f64], x: &[f64], weight: f64) {
    let k = x.len();
    for (row, &xi) in a.chunks_exact_mut(k).zip(x) {
        let w = weight * xi;
        for (v, &xj) in row.iter_mut().zip(x) {
            *v += w * xj;
        }
    }
}

/// Computes `y = a x`.
pub fn times(a: &[f64], x: &[f64], y: &mut [f64]) {
    for (row, v) in a.chunks_exact(x.len()).zip(y) {
        *v = dot(row, x);
    }
}

/// Returns the scalar product, computed in four parallel sums, because a single sum would wait for each addition.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len());
    let (a, b) = (&a[..n], &b[..n]);
    let mut sums = [0.0; 4];
    let (x4, y4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = x4
        .remainder()
        .iter()
        .zip(y4.remainder())
        .map(|(x, y)| x * y)
        .sum();
    for (x, y) in x4.zip(y4) {
        for (s, (u, v)) in sums.iter_mut().zip(x.iter().zip(y)) {
            *s += u * v;
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Returns `trace(a b)` of symmetric matrices.
pub fn trace_of_product(a: &[f64], b: &[f64]) -> f64 {
    dot(a, b)
}

/// Computes `L^-1 x` in place, with `L` lower triangular by rows.
pub fn solve_lower(l: &[f64], x: &mut [f64]) {
    let k = x.len();
    for i in 0..k {
        let (before, rest) = x.split_at_mut(i);
        let row = &l[i * k..i * k + i];
        if let Some(v) = rest.first_mut() {
            *v = (*v - dot(row, before)) / l[i * k + i];
        }
    }
}
