//! Checks that deck and results belong together.
//!
//! - `ids` elements and grids that only one of them has;
//! - `coordinates` grids with other coordinates;
//! - `output` strain that was not requested, PARAM,OMID;
//! - `freedom` reactions in a job that should have none;
//! - `strain` strain that differs from the built-in solver.

mod coordinates;
mod freedom;
mod ids;
mod output;
mod strain;

pub use coordinates::check_coordinates;
pub use freedom::{Supports, check_free};
pub use ids::check_ids;
pub use output::check_output;
pub use strain::StrainDifference;

use crate::finding::Finding;
use crate::model::Model;
use nastran::results::ResultsFile;

/// Runs every check that needs only the tables of one result file. [`check_coordinates`] also needs the geometry of this file.
pub fn check_consistency(
    model: &Model,
    name: &str,
    file: &ResultsFile,
    supports: Supports,
) -> Vec<Finding> {
    let mut findings = check_ids(model, name, file);
    findings.extend(check_output(model, name, file));
    findings.extend(check_free(model, name, file, supports));
    findings
}

#[cfg(test)]
mod tests;
