//! Linear algebra: the only module that uses external linear-algebra crates.
//!
//! - [`sparse`]: large symmetric positive definite systems
//! - [`tall`]: least squares with many rows and few columns
//! - [`levenberg`]: nonlinear least squares
//! - [`cholesky`]: the factor of a dense covariance
//! - [`complex`]: complex least squares of small systems
//! - [`precision`]: the inverse of a dense covariance
//! - [`exponential`]: the matrix exponential

pub mod cholesky;
pub mod complex;
pub mod dense;
pub mod exponential;
pub mod levenberg;
pub mod precision;
pub mod sparse;
pub mod spd;
pub mod tall;

pub use dense::{Matrix, Vector};
pub use nalgebra::{
    Complex, DMatrix, DVector, Matrix2, Matrix3, Matrix4, Matrix6, SMatrix, SVector,
    SymmetricEigen, Vector2, Vector3, Vector4, Vector6,
};
