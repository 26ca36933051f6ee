//! Complex least squares of small systems.

use nalgebra::{Complex, DMatrix};

/// A dense complex matrix.
pub type ComplexMatrix = DMatrix<Complex<f64>>;

/// A pivot of columns of unit length below this leaves the gain, whose rounding is 1e-16 over it, with less than nine digits.
const PIVOT: f64 = 1e-7;

/// Returns `(H* H + diag(ridge))^-1 H*` of `h`, `n x k`: the gain of least squares with `ridge` as prior information, `k x n`. It uses the QR factors
/// of `H` above `diag(sqrt(ridge))`, columns of unit length. `None` if columns are linearly dependent, or numbers are not finite.
pub fn least_squares_gain(h: &ComplexMatrix, ridge: &[f64]) -> Option<ComplexMatrix> {
    let (n, k) = h.shape();
    let mut rows = DMatrix::zeros(n + k, k);
    rows.rows_mut(0, n).copy_from(h);
    for (l, r) in ridge.iter().enumerate().take(k) {
        rows[(n + l, l)] = Complex::new(r.sqrt(), 0.0);
    }
    let scale: Vec<f64> = rows.column_iter().map(|c| 1.0 / c.norm()).collect();
    if scale.iter().any(|s| !s.is_finite()) || rows.iter().any(|v| !v.norm_sqr().is_finite()) {
        return None;
    }
    for (mut column, s) in rows.column_iter_mut().zip(&scale) {
        column.iter_mut().for_each(|v| *v *= *s);
    }
    let factors = rows.qr();
    let r = factors.r();
    if r.diagonal().iter().any(|p| !(p.norm() > PIVOT)) {
        return None;
    }
    let mut gain = factors.q().rows(0, n).adjoint();
    if !r.solve_upper_triangular_mut(&mut gain) {
        return None;
    }
    for (mut row, s) in gain.row_iter_mut().zip(&scale) {
        row.iter_mut().for_each(|v| *v *= *s);
    }
    Some(gain)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns that differ by a millionth. A gain of full rank has `G H = 1` within the rounding of numbers that are a million times as large.
    #[test]
    fn columns_that_are_nearly_alike_are_distinguished_to_rounding() {
        let unit = |i: usize| Complex::from_polar(1.0, i as f64);
        let h = ComplexMatrix::from_fn(6, 2, |i, l| unit(i * i) + unit(7 * i) * (1e-6 * l as f64));
        let gain = least_squares_gain(&h, &[0.0, 0.0]).unwrap();
        let off = (gain * h - ComplexMatrix::identity(2, 2)).norm();
        assert!(off < 1e-8, "{off}");
    }

    #[test]
    fn a_ridge_is_information_of_its_own_and_columns_alike_have_none() {
        let h = ComplexMatrix::from_element(3, 2, Complex::new(0.0, 1.0));
        assert!(least_squares_gain(&h, &[0.0, 0.0]).is_none());
        // The matrix has 3 + r on the diagonal and 3 elsewhere. Each load therefore takes 3 / (6 + r) of a unit load of either.
        let gain = least_squares_gain(&h, &[2.0, 2.0]).unwrap();
        let passed = gain * h;
        assert!(
            passed
                .iter()
                .all(|v| (v - Complex::new(3.0 / 8.0, 0.0)).norm() < 1e-12)
        );
    }
}
