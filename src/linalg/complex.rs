//! Complex least squares of small systems.

use nalgebra::{Complex, DMatrix};

/// A dense complex matrix.
pub type ComplexMatrix = DMatrix<Complex<f64>>;

/// A pivot of the scaled normal equations below this is rounding of the subtraction, not information.
const PIVOT: f64 = 1e-14;

/// `(H* H + diag(ridge))^-1 H*` of `h`, `n x k`: the gain of least squares with `ridge` as prior information, `k x n`. `None` where
/// columns can't be told apart, or numbers are not finite.
pub fn least_squares_gain(h: &ComplexMatrix, ridge: &[f64]) -> Option<ComplexMatrix> {
    let k = h.ncols();
    let mut gain = h.adjoint();
    let mut normal = &gain * h;
    for (l, r) in ridge.iter().enumerate().take(k) {
        normal[(l, l)] += r;
    }
    let scale: Vec<f64> = (0..k).map(|l| 1.0 / normal[(l, l)].re.sqrt()).collect();
    if scale.iter().any(|s| !s.is_finite()) {
        return None;
    }
    for a in 0..k {
        for b in 0..k {
            normal[(a, b)] *= scale[a] * scale[b];
        }
        gain.row_mut(a).iter_mut().for_each(|v| *v *= scale[a]);
    }
    let factor = normal.cholesky()?;
    let pivots = factor.l_dirty().diagonal();
    if pivots.iter().any(|p| !(p.re * p.re > PIVOT)) {
        return None;
    }
    factor.solve_mut(&mut gain);
    for (a, s) in scale.iter().enumerate() {
        gain.row_mut(a).iter_mut().for_each(|v| *v *= *s);
    }
    Some(gain)
}
