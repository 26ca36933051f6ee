//! The strain of the reference state, which makes totals of changes.

use crate::fe::floor::solve_standing;
use crate::gauge::gauge_reading;
use crate::host::fault::{Fault, Faults};
use crate::job::{Job, Measured, Reference};
use crate::measured::wheels::{floor_fault, wheels_of};
use crate::model::Model;
use crate::strain_chain::JobSensitivity;
use crate::strain_chain::built_in_solver::stands_on_wheels;

/// Returns the strain of the reference state by gauge. It is added to the readings, so that loads are totals.
pub(crate) fn reference_strain(
    job: &Job,
    measured: &Measured,
    prepared: &JobSensitivity,
) -> Result<Vec<f64>, Faults> {
    let n = prepared.sensitivity.gauges.len();
    let fault = |wrong: String, remedy: &str| {
        Faults::from(Fault::with_line(
            &*job.file,
            measured.line,
            "measured.reference",
            wrong,
            remedy,
        ))
    };
    match (measured.reference, &prepared.fields) {
        (Reference::None, _) => Ok(vec![0.0; n]),
        (Reference::Subcase(id), Some(fields)) => {
            let case = fields.subcase(id).ok_or_else(|| match fields.is_solved_here() {
                true => fault(
                    format!(
                        "the deck has no static subcase {id} with a load, and there are no results"
                    ),
                    "name a SUBCASE of the deck: the state in which the gauges read zero",
                ),
                false => fault(
                    format!("the results have no subcase {id}"),
                    "name the subcase of the reference state",
                ),
            })?;
            prepared
                .gauges
                .iter()
                .map(|g| {
                    gauge_reading(g, case).ok_or_else(|| {
                        fault(
                            format!("gauge `{}` has no strain in subcase {id}", g.name),
                            "ask for STRAIN of its element there",
                        )
                    })
                })
                .collect()
        }
        (Reference::Gravity, Some(fields)) => Ok(standing_strain(job, fields.model(), prepared)?),
        (_, None) => Err(fault(
            "a given S has no subcases and no weight".to_owned(),
            "write reference = \"none\", or give a [model] instead of [sensitivity]",
        )),
    }
}

/// Computes the strain by gauge of the model on its wheels under its own weight: `S R`. `R` are the reactions at the job's wheels on a flat floor.
/// Gravity and the reactions balance a free structure, so that the reactions with their inertia relief cause all of its strain.
fn standing_strain(
    job: &Job,
    model: &Model,
    prepared: &JobSensitivity,
) -> Result<Vec<f64>, Faults> {
    stands_on_wheels(job, model, "the reference \"gravity\"")?;
    let wheels = wheels_of(job, model)?;
    let standing = solve_standing(model, wheels.axis, &wheels.grids, &[], None)
        .map_err(|e| floor_fault(job, &e))?;
    let reactions = standing.under_weight(model, job.gravity());
    let s = &prepared.sensitivity;
    Ok((0..s.gauges.len())
        .map(|g| {
            let by_wheel = wheels.loads.iter().zip(&reactions);
            by_wheel
                .filter_map(|(l, r)| {
                    let name = &job.loads.get(*l)?.name;
                    let column = s.loads.iter().position(|c| c.name == *name)?;
                    Some(s.values[(g, column)] * r)
                })
                .sum()
        })
        .collect())
}
