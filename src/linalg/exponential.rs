//! The matrix exponential.

use super::Matrix;

/// Returns exp(a) of a square matrix by a Pade approximation with scaling and squaring; `None` if an entry of `a` or of the result is not finite.
///
/// # Reference
/// N. J. Higham, SIAM J. Matrix Anal. Appl. 26 (2005) 1179.
///
/// # Example
/// A rotation by one radian:
/// ```
/// use strainbridge::linalg::{Matrix, exponential::exponential};
///
/// let turn = exponential(&Matrix::from_row_slice(2, 2, &[0.0, -1.0, 1.0, 0.0])).unwrap();
/// assert!((turn[(0, 0)] - 1f64.cos()).abs() < 1e-14);
/// assert!((turn[(1, 0)] - 1f64.sin()).abs() < 1e-14);
/// ```
pub fn exponential(a: &Matrix) -> Option<Matrix> {
    let finite = |m: &Matrix| m.iter().all(|v| v.is_finite());
    if !finite(a) || a.nrows() != a.ncols() {
        return None;
    }
    Some(a.exp()).filter(finite)
}
