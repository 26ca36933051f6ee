//! Factors on sigma that give 95 % intervals.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Factor on sigma of a 95 % interval where sigma is known.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Factor on sigma of a 95 % interval where sigma is estimated with `dof` degrees of freedom.
pub fn student_95(dof: f64) -> f64 {
    if dof.is_infinite() {
        return NORMAL_95;
    }
    student(0.975, dof)
}

/// Value of Student's t with finite `dof` degrees of freedom that lies under the share `p`, 0.5 to 1.
pub fn student(p: f64, dof: f64) -> f64 {
    StudentsT::new(0.0, 1.0, dof.max(1.0)).map_or(f64::INFINITY, |t| t.inverse_cdf(p))
}
