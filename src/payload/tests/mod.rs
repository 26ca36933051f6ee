//! Tests of this layer.

mod ballast;
mod by_calibration;
mod near_zero;
mod robust;
mod weigh;
