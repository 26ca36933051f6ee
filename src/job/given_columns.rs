//! Which columns of a given S are loads.

use super::same_name::{is_same_name, is_same_word};
use super::types::{GivenSensitivity, Job, JobLoad};

/// Returns load and column of a given S whose table has this header, without the column of gauge names. The key `columns` states them. Without this
/// key, they are the columns that stated loads name, or all columns if the job states no load.
pub fn columns_of_given(
    job: &Job,
    given: &GivenSensitivity,
    header: impl IntoIterator<Item = String>,
) -> Vec<(String, String)> {
    if !given.columns.is_empty() {
        return given.columns.clone();
    }
    let header: Vec<String> = header.into_iter().collect();
    if job.loads.is_empty() {
        let own = header.into_iter().filter(|name| !name.is_empty());
        return own.map(|name| (name.clone(), name)).collect();
    }
    let is_load = |name: &str| job.loads.iter().any(|l| l.name == name);
    // A column belongs to a load if exactly one load and one column have this name apart from case and separators.
    let meant = |column: &String| {
        let like = |l: &&JobLoad| is_same_word(&l.name, column) && !header.contains(&l.name);
        let mut loads = job.loads.iter().filter(like);
        let mut columns = header.iter().filter(|h| is_same_name(h, column));
        let only = (loads.next(), loads.next(), columns.next(), columns.next());
        match only {
            (Some(load), None, Some(_), None) => Some((load.name.clone(), column.clone())),
            _ => None,
        }
    };
    let of = |column: &String| match is_load(column) {
        true => Some((column.clone(), column.clone())),
        false => meant(column),
    };
    header.iter().filter_map(of).collect()
}
