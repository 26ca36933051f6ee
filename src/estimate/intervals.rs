//! Factors on sigma that give 95 % intervals.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Factor on sigma of a 95 % interval if sigma is known.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Returns the factor on sigma of a 95 % interval if sigma is estimated with `dof` degrees of freedom. Infinite `dof` gives the normal factor.
///
/// # Example
/// ```
/// use strainbridge::estimate::{NORMAL_95, student_95};
///
/// // Abramowitz and Stegun, table 26.10: 12.706, 2.228 and 1.960.
/// assert!((student_95(1.0) - 12.706).abs() < 5e-4);
/// assert!((student_95(10.0) - 2.228).abs() < 5e-4);
/// assert_eq!(student_95(f64::INFINITY), NORMAL_95);
/// ```
pub fn student_95(dof: f64) -> f64 {
    if dof.is_infinite() {
        return NORMAL_95;
    }
    student(0.975, dof)
}

/// Returns the quantile of Student's t with finite `dof` degrees of freedom at the share `p`, 0.5 to 1.
pub fn student(p: f64, dof: f64) -> f64 {
    StudentsT::new(0.0, 1.0, dof.max(1.0)).map_or(f64::INFINITY, |t| t.inverse_cdf(p))
}
