//! Estimates with their uncertainty, for strain and for motion.
//!
//! - [`LinearGaussian`]: parameters of a linear model with correlated errors and priors
//! - [`columns`]: the same model with many rows, by columns
//! - [`LoadEstimate`]: recovered loads of a run with their covariance
//! - [`student_95`] and the tails: quantiles and chances of the normal, Student, chi-square and F distributions
//! - [`Deviations`]: whether differences exceed the intervals that are stated for them
//! - [`median`], [`weighted_median`], [`rms`]: statistics of samples

pub mod columns;
mod deviations;
mod intervals;
mod linear;
mod loads;
mod statistics;
mod tails;

pub use deviations::Deviations;
pub use intervals::{NORMAL_95, student, student_95};
pub use linear::{LinearEstimate, LinearGaussian, ReadingErrors};
pub use loads::LoadEstimate;
pub use statistics::{effective_rows, independent_share, median, rms, weighted_median};
pub use tails::{COVERAGE, TOO_FEW, chance_of_so_few, chi_square_tail, f_tail, student_tail};
