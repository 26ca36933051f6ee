//! Quantity of a load, from its name.

use crate::units::Quantity;

/// Parts of a name that identify a moment.
const MOMENTS: [&str; 3] = ["MX", "MY", "MZ"];

/// Returns force or moment according to the parts of a load's name: `LF.MX`, `MX_LF` and `M_LF` are moments. Other names mean a force.
pub fn quantity_of_name(name: &str) -> Quantity {
    let is_moment = name
        .split(['.', '_', ' '])
        .any(|part| part == "M" || MOMENTS.iter().any(|m| m.eq_ignore_ascii_case(part)));
    if is_moment {
        Quantity::Moment
    } else {
        Quantity::Force
    }
}
