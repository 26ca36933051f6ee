//! What a load's name says of it, and which columns of a given S are loads.

use super::types::{GivenSensitivity, Job};
use crate::units::Quantity;

/// Parts of a name that say that a load is a moment.
const MOMENTS: [&str; 3] = ["MX", "MY", "MZ"];

/// Force or moment by the parts of a load's name (`LF.MX`, `MX_LF` and `M_LF` are moments); a force where the name does not tell.
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

/// Load and column of a given S whose table has this header (the column of gauge names left out): as `columns` says; where it is left out,
/// every column that a stated load names, or every column where no load is stated.
pub fn columns_of_given(
    job: &Job,
    given: &GivenSensitivity,
    header: impl IntoIterator<Item = String>,
) -> Vec<(String, String)> {
    if !given.columns.is_empty() {
        return given.columns.clone();
    }
    let is_load = |name: &String| job.loads.is_empty() || job.loads.iter().any(|l| l.name == *name);
    let loads = header.into_iter().filter(is_load);
    loads.map(|name| (name.clone(), name)).collect()
}
