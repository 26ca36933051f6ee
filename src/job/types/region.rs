//! Where something may be.

/// Box in plan, and in height if stated: lower and upper bound for each axis.
pub type Region = Vec<[f64; 2]>;
