//! Effect of errors of readings and of gauge installation on recovered loads: recovery repeated under stated errors.

mod error;
mod trials;

pub use error::{ErrorKind, StudyError};
pub use trials::{PoolGauge, StudyRow, StudySpec, TrueLoad, study_layout};

#[cfg(test)]
mod tests;
