//! Tests of this layer.

mod ballast;
mod robust;
mod weigh;
