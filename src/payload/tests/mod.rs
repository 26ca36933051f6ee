//! Tests of payload and ballast.

mod ballast;
mod near_zero;
mod robust;
mod weigh;
