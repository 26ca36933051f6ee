//! Where something may be.

/// A box in plan, and in height where stated: low and high by axis.
pub type Region = Vec<[f64; 2]>;
