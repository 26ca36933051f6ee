//! Which columns of a given S are loads.

use super::types::{GivenSensitivity, Job};

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
