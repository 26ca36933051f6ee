//! Response of a vehicle with known parameters to wheel forces, to a road, or to the recorded accelerations of some bodies.
//!
//! Between samples, every input is a cubic curve with continuous slope. For this input a linear vehicle is integrated exactly, by the matrix
//! exponential. Other vehicles are integrated by the Runge-Kutta method of order 4, with steps that are halved until the result settles.
//!
//! - `types`: inputs, response, limits, errors; `cubic`: inputs between samples
//! - `system`: the equations of motion; `integrate`: their states at all samples
//! - `compute`: the response, and the load of wheels at rest

mod compute;
mod cubic;
mod integrate;
mod system;
#[cfg(test)]
mod tests;
mod types;

pub use compute::{compute_response, static_wheel_loads};
pub use types::{Inputs, PrescribedMotion, Response, ResponseError, ResponseRules};
