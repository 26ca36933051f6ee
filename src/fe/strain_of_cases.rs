//! Strain fields of solved load cases.

use super::error::FeError;
use super::line_load::BeamLoads;
use super::load_case::LoadCase;
use super::load_checks::check_finite;
use super::options::{HeatedStrain, SolveOptions};
use super::prepared_model::PreparedModel;
use super::report::{DisplacementSolution, SolveReport};
use super::shell_strain::shell_fields;
use super::temperature::Temperatures;
use super::{BeamField, CaseResult, ShellField, SolidField, Solution};
use crate::model::Model;

/// Returns the strain of all elements from the displacements of every case.
///
/// # Errors
/// Elements that can't be formed; temperature sets that the deck lacks.
pub(super) fn with_strain(
    prepared: &PreparedModel<'_>,
    cases: &[LoadCase],
    solved: DisplacementSolution,
    options: &SolveOptions,
) -> Result<(Solution, SolveReport), FeError> {
    let u = solved.displacements;
    let temperatures = match options.heated {
        HeatedStrain::Mechanical => temperatures_of(prepared.model, cases)?,
        HeatedStrain::Total => vec![None; cases.len()],
    };
    let report = &solved.report;
    let relief = |case: &LoadCase| {
        let mut balance = report.balance.iter();
        let balance = balance.find(|b| b.subcase == case.subcase)?;
        Some((balance.acceleration, report.mass.as_ref()?.cg))
    };
    let between: Vec<BeamLoads<'_>> = cases
        .iter()
        .zip(&temperatures)
        .map(|(case, t)| BeamLoads::new(prepared.model, case, t.as_ref(), relief(case)))
        .collect();
    let shells = shell_fields(prepared, &u, &temperatures, options.corners)?;
    let beams = super::beam_strain::beam_fields(prepared, &u, &between)?;
    let solids = super::solid_fields::solid_fields(prepared, &u, &temperatures)?;
    for (i, case) in cases.iter().enumerate() {
        check_finite(
            case.subcase,
            "strains",
            strains(&shells[i], &beams[i], &solids[i]),
        )?;
    }
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
    cases
        .iter()
        .map(|c| Temperatures::from_case(model, c))
        .collect()
}

/// Every strain of a case that is a number or should be one: what an element lacks (a triangle's fourth corner) is left out.
fn strains<'a>(
    shells: &'a ShellField,
    beams: &'a BeamField,
    solids: &'a SolidField,
) -> impl Iterator<Item = f64> + 'a {
    let of_shells = shells.centre.iter().flatten().flatten();
    let of_beams = beams.stations.iter().flatten().flat_map(|s| &s.1);
    let of_solids = solids.centre.iter().flatten();
    of_shells.chain(of_beams).chain(of_solids).copied()
}
