//! job.toml: [`parse`] turns text into [`raw`] structs with the place of every value, [`resolve`] turns those into the plain
//! structs of [`types`]; [`gauges`], [`strain`] and [`runs`] read the tables a job names; [`schema`] describes
//! a job to editors.

mod faults;
pub mod gauges;
mod parse;
mod raw;
mod resolve;
pub mod runs;
pub mod schema;
mod shapes;
mod spanned;
pub mod strain;
pub mod suggest;
pub mod table;
mod types;

#[cfg(test)]
mod tests;

pub use types::*;

use super::fault::Faults;
use super::files::Inputs;
use std::path::Path;

/// The job in a file, with its gauge file read; strain and runs are read when a command asks for them.
///
/// # Errors
/// Every fault found: syntax, unknown keys, wrong types, contradictions, missing files.
pub fn read_job(inputs: &mut Inputs, path: &Path) -> Result<Job, Faults> {
    let given = path.display().to_string();
    let text = inputs
        .read_text(Path::new(""), &given)
        .map_err(|f| vec![f])?;
    let (raw, mut faults) = parse::parse_job(&given, &text);
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut job = resolve::resolve_job(&given, &text, &folder, raw, &mut faults);
    job.gauges
        .extend(gauges::read_gauge_file(inputs, &job, &mut faults));
    resolve::check_names(&job, &mut faults);
    if faults.is_empty() {
        Ok(job)
    } else {
        faults.sort_by(|a, b| {
            (a.file != given, &a.file, a.line).cmp(&(b.file != given, &b.file, b.line))
        });
        faults.dedup();
        Err(faults)
    }
}
