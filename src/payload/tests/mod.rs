//! Tests of this layer.

mod ballast;
mod near_zero;
mod robust;
mod weigh;
