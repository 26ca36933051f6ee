//! Correction of a shrunk scatter that is too small. Recovered loads are corrected by the readings outside the span of S. The factors of this
//! correction come from the few runs that gave the scatter.
//!
//! With an orthonormal basis `U` of the columns of S, loads in these coordinates are `u = H U' C^-1 eps`. `H = (U' C^-1 U)^-1` is their covariance,
//! and `C` is the scatter. As a regression of `U' eps` on the other directions this is a ridge. Shrinking keeps `1 - w` of the sample in these
//! directions and adds `w` times their mean variance. The residuals of the calibration runs are smaller than the residuals of other runs.

use crate::linalg::{Matrix, dense, spd};

/// Returns the addition to the scatter, `n x n` by rows, that widens the intervals of loads. They then include the scatter of runs outside the
/// calibration. Returns `None` if the intervals are wide enough.
///
/// The addition is `(k - 1) U H U'`. It changes no estimate, because it is in the span of S. The factor is `k = tr(H^-1 V) / rank`,
/// `V = H U' C^-1 A C^-1 U H / (1 - p / dof)^2` with the sample `A`. `V` is at most `U' A U`, the scatter of loads without any correction.
/// `p = sum (1 - w) d / ((1 - w) d + w mean(d))` over the variances `d` of the other directions.
///
/// # Reference
/// G. H. Golub, M. Heath, G. Wahba, Technometrics 21 (1979) 215: generalised cross-validation of a ridge.
pub(super) fn overfit_scatter(
    sample: &[f64],
    (shrunk, w): (&[f64], f64),
    columns: &Matrix,
    dof: f64,
) -> Option<Vec<f64>> {
    let n = columns.nrows();
    let basis = basis(columns)?;
    let k = basis.len();
    let inverse = spd::gram_of_lower(&spd::inverse_lower(&spd::cholesky(shrunk, n)?, n), n);
    let times = |of: &[f64], x: &[f64]| -> Vec<f64> {
        let mut out = vec![0.0; n];
        spd::times(of, x, &mut out);
        out
    };
    let white: Vec<Vec<f64>> = basis.iter().map(|u| times(&inverse, u)).collect();
    let between = |a: &[Vec<f64>], b: &[Vec<f64>]| -> Vec<f64> {
        let rows = a.iter().flat_map(|x| b.iter().map(move |y| spd::dot(x, y)));
        rows.collect()
    };
    let information = between(&basis, &white);
    let h = spd::inverse_lower(&spd::cholesky(&information, k)?, k);
    let h = spd::gram_of_lower(&h, k);
    let through = |of: &[Vec<f64>]| -> Vec<f64> {
        let sampled: Vec<Vec<f64>> = of.iter().map(|x| times(sample, x)).collect();
        between(of, &sampled)
    };
    let size = k as f64;
    let by_others = spd::trace_of_product(&h, &through(&white)) / size;
    let plain = spd::trace_of_product(&information, &through(&basis)) / size;
    let left = 1.0 - effective_factor_count(sample, &basis, w) / dof;
    let widened = match left > 0.0 {
        true => (by_others / (left * left)).min(plain),
        false => plain,
    };
    (widened > 1.0).then(|| {
        let mut out = vec![0.0; n * n];
        for (i, u) in basis.iter().enumerate() {
            for (j, v) in basis.iter().enumerate() {
                let amount = (widened - 1.0) * h[i * k + j];
                for (row, a) in out.chunks_exact_mut(n).zip(u) {
                    row.iter_mut()
                        .zip(v)
                        .for_each(|(o, b)| *o += amount * a * b);
                }
            }
        }
        out
    })
}

/// Returns the effective number of factors of the ridge, `p`.
fn effective_factor_count(sample: &[f64], basis: &[Vec<f64>], w: f64) -> f64 {
    let n = basis.first().map_or(0, Vec::len);
    let outside = |x: &mut [f64]| {
        for u in basis {
            let along = spd::dot(u, x);
            x.iter_mut().zip(u).for_each(|(x, u)| *x -= along * u);
        }
    };
    // The projection acts on the rows first, then on the columns.
    let mut rest = sample.to_vec();
    rest.chunks_exact_mut(n.max(1)).for_each(outside);
    let mut rest: Vec<f64> = (0..n * n).map(|i| rest[i % n * n + i / n]).collect();
    rest.chunks_exact_mut(n.max(1)).for_each(outside);
    // Eigenvalues ascend. The first ones belong to the basis and are zero except for rounding.
    let mut variances = spd::eigenvalues(&rest, n);
    variances.drain(..basis.len().min(n));
    let mean = variances.iter().sum::<f64>() / variances.len().max(1) as f64;
    let kept = |d: &f64| {
        let own = (1.0 - w) * d.max(0.0);
        own / (own + w * mean).max(f64::MIN_POSITIVE)
    };
    variances.iter().map(kept).sum()
}

/// Returns orthonormal patterns over the gauges that span the strain of loads. `None` if numbers are not finite.
pub(super) fn basis(columns: &Matrix) -> Option<Vec<Vec<f64>>> {
    let d = dense::svd(&dense::unit_columns(columns))?;
    let limit = d.s.first().copied().unwrap_or(0.0) * dense::RANK_TOLERANCE;
    let kept = (0..d.s.len()).filter(|&i| d.s[i] > limit);
    let of = |i: usize| d.u.column(i).iter().copied().collect();
    Some(kept.map(of).collect())
}
