//! Strain fields of solved load cases.

use super::error::FeError;
use super::line_load::Between;
use super::load_case::LoadCase;
use super::options::{HeatedStrain, SolveOptions};
use super::prepared::Prepared;
use super::report::{SolveReport, Solved};
use super::shell_strain::shell_fields;
use super::temperature::Temperatures;
use super::{CaseResult, Solution};
use crate::model::Model;

/// Strain of all elements from the displacements of every case.
///
/// # Errors
/// Elements that can't be formed; temperature sets that the deck lacks.
pub(super) fn with_strain(
    prepared: &Prepared<'_>,
    cases: &[LoadCase],
    solved: Solved,
    options: &SolveOptions,
) -> Result<(Solution, SolveReport), FeError> {
    let u = solved.displacements;
    let temperatures = match options.heated {
        HeatedStrain::Mechanical => temperatures_of(prepared.model, cases)?,
        HeatedStrain::Total => vec![None; cases.len()],
    };
    let between: Vec<Between<'_>> = cases
        .iter()
        .zip(&temperatures)
        .map(|(case, t)| Between::new(prepared.model, case, t.as_ref()))
        .collect();
    let shells = shell_fields(prepared, &u, &temperatures, options.corners)?;
    let beams = super::beam_strain::beam_fields(prepared, &u, &between)?;
    let solids = super::solid_fields::solid_fields(prepared, &u, &temperatures)?;
    let results = cases.iter().zip(u).zip(shells).zip(beams).zip(solids);
    Ok((
        Solution {
            cases: results
                .map(
                    |((((case, displacement), shells), beams), solids)| CaseResult {
                        subcase: case.subcase,
                        label: case.label.clone(),
                        shells,
                        beams,
                        solids,
                        displacement,
                    },
                )
                .collect(),
            source: concat!("strainbridge ", env!("CARGO_PKG_VERSION")).to_owned(),
            findings: solved.findings,
        },
        solved.report,
    ))
}

/// The temperatures of every case; `None` for those without.
fn temperatures_of(
    model: &Model,
    cases: &[LoadCase],
) -> Result<Vec<Option<Temperatures>>, FeError> {
    cases.iter().map(|c| Temperatures::of(model, c)).collect()
}
