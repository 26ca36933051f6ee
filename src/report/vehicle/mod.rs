//! Tables and page of `identify`.

mod page;
mod plot;
mod tables;

pub use page::{Curve, identify_page};
pub use tables::{write_parameters, write_restoring_force, write_wheel_forces};
