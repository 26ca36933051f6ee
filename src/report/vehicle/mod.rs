//! Tables and page of `identify`.

mod curve;
mod page;
mod restoring_forces;
mod tables;

pub use curve::Curve;
pub use page::{Curves, identify_page};
pub use restoring_forces::{restoring_curves, restoring_section, restoring_unit};
pub use tables::{
    write_chassis_forces, write_parameters, write_restoring_force, write_wheel_forces,
};
