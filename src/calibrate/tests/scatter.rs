//! Degrees of freedom of shrunk scatter.

use crate::calibrate::scatter::dof_of_shrunk;

/// Checks the degrees of freedom of a weighted sum of independent variances of equal size, `v` degrees of freedom each. The relative variance of the
/// sum is `2 / v` times the sum of the squared weights: `1 - w + w / n` for its own variance, `w / n` for each other variance.
#[test]
fn a_shrunk_variance_has_the_degrees_of_freedom_of_its_weights() {
    for (n, w) in [(1_u32, 0.3), (5, 0.0), (5, 0.4), (37, 0.9), (37, 1.0)] {
        let share = w / f64::from(n);
        let squares = (1.0 - w + share).powi(2) + f64::from(n - 1) * share * share;
        let v = dof_of_shrunk(3.0, w, f64::from(n));
        assert!((v - 3.0 / squares).abs() < 1e-9 * v, "{n} {w}: {v}");
    }
}
