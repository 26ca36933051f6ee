//! Common stages of the strain commands: the model with its unit-load strain, its gauges, and S from both or from a table.

mod alternative_rows;
pub(crate) mod built_in_solver;
pub(crate) mod combined_subcases;
mod covariance;
pub mod deck;
mod deck_loads;
mod deck_supports;
mod fields;
mod gauges;
mod given_sensitivity;
pub(crate) mod job_deck;
mod load_cases;
mod mesh;
pub(crate) mod named_results;
pub(crate) mod not_solved;
mod other_loads;
pub(crate) mod repeated_subcases;
mod solver_check;
mod specs;
mod stated_noise;
mod stated_points;
mod unit_loads;
mod units;

pub use alternative_rows::{alternative_rows, alternatives_of};
pub use covariance::{covariance_bytes, read_covariance};
pub use fields::{AdditionalUnitLoads, Fields, read_fields, read_fields_with_additional_loads};
pub use gauges::{lay_gauges, not_laid, without_strain};
pub use given_sensitivity::read_given;
pub use mesh::{
    GaugeMeshError, LoadMeshError, WantedAt, coarse_at_gauges, left_in_reading, left_squared,
    mesh_errors, refined_mesh, subtract_from_additional_loads,
};
pub use specs::corrected_spec_of;
pub use stated_noise::stated_noise;
pub use stated_points::point_findings;
pub use unit_loads::unit_loads;
pub use units::{LoadSigma, LoadUnits, load_units};

use crate::finding::{Finding, Severity};
use crate::gauge::Gauge;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::finite_or_none;
use crate::host::work::Work;
use crate::job::correct::{check_channels, report_corrections};
use crate::job::{Job, Measured};
use crate::recovery::ErrorModel;
use crate::sensitivity::{Sensitivity, from_cases};
use crate::strain_chain::named_results::{MissingResults, check_named};
use crate::units::MICROSTRAIN;
use serde::Serialize;

/// S of the job's gauges, with all data that belong to S.
pub struct JobSensitivity {
    /// S.
    pub sensitivity: Sensitivity,
    /// Model and strain fields. `None` if S is given.
    pub fields: Option<Fields>,
    /// Gauges on the model. Empty if S is given.
    pub gauges: Vec<Gauge>,
    /// Mesh error by gauge; empty if it was not computed. S does not contain the mesh error.
    pub mesh_error: Vec<GaugeMeshError>,
}

impl JobSensitivity {
    /// Keeps these rows of S with all data of their gauges, and removes all other rows.
    pub fn retain(&mut self, rows: &[usize]) {
        if rows.len() == self.sensitivity.gauges.len() {
            return;
        }
        self.sensitivity = self.sensitivity.of_gauges(rows);
        let names = &self.sensitivity.gauges;
        self.gauges.retain(|g| names.contains(&g.name));
        self.mesh_error.retain(|g| names.contains(&g.name));
    }
}

/// Returns S of the job's gauges: from the table of `[sensitivity]`, else from the model and its results.
///
/// # Errors
/// Every fault of these stages.
pub fn prepare(work: &mut Work, job: &Job) -> Result<JobSensitivity, Faults> {
    prepare_with_additional_loads(work, job, None)
}

/// Returns S like [`prepare`], and solves the model for the loads `additional` if the built-in solver computes S ([`Fields::additional`]).
///
/// # Errors
/// Every error of [`prepare`] and of `additional`.
pub fn prepare_with_additional_loads(
    work: &mut Work,
    job: &Job,
    additional: Option<AdditionalUnitLoads<'_>>,
) -> Result<JobSensitivity, Faults> {
    work.findings.extend(report_corrections(job));
    let mut prepared = if job.sensitivity.is_some() {
        let sensitivity = given_as_asked(work, job)?;
        // With a calibrated S, the fields of the model are still needed for responses and pictures.
        let (fields, gauges) = match &job.model {
            Some(_) if has_covariance(job) => {
                let fields =
                    read_fields_with_additional_loads(work, job, WantedAt::Gauges, additional)?;
                let mut gauges = lay_gauges(work, job, &fields)?;
                gauges.retain(|g| sensitivity.gauges.contains(&g.name));
                (Some(fields), gauges)
            }
            _ => {
                check_named(work, job, MissingResults::Refused)?;
                (None, Vec::new())
            }
        };
        JobSensitivity {
            sensitivity,
            fields,
            gauges,
            mesh_error: Vec::new(),
        }
    } else {
        let fields = read_fields_with_additional_loads(work, job, WantedAt::Gauges, additional)?;
        let gauges = lay_gauges(work, job, &fields)?;
        let mut sensitivity = from_cases(&gauges, &fields.load_cases(job))
            .map_err(|missing| without_strain(job, &missing))?;
        let errors = fields.mesh_cases(job);
        let measured = job.measured.as_ref();
        sensitivity.uncertainty = mesh::uncertainty(
            work,
            measured,
            &gauges,
            &sensitivity,
            (&errors, fields.mesh_left()),
        );
        let mesh_error = mesh_errors(&gauges, &sensitivity, &errors);
        work.findings
            .extend(coarse_at_gauges(&gauges, &mesh_error, fields.mesh_left()));
        JobSensitivity {
            sensitivity,
            fields: Some(fields),
            gauges,
            mesh_error,
        }
    };
    prepared.sensitivity.noise = stated_noise(job, &prepared.sensitivity.gauges)?;
    Ok(prepared)
}

/// Reads S from the table of `[sensitivity]`, and refuses corrections that rotate a gauge.
///
/// # Errors
/// The errors of [`read_given`]; gauges that the job rotates.
pub fn given_as_asked(work: &mut Work, job: &Job) -> Result<Sensitivity, Faults> {
    if let Some(c) = job.corrections.iter().find(|c| c.angle_deg.is_some()) {
        return Err(Faults::from(Fault::with_line(
            &*job.file,
            c.line,
            "correction.angle_deg",
            format!(
                "the job gives S, so the row of gauge `{}` cannot be turned",
                c.gauge
            ),
            "turn it in the table of [sensitivity], or give a [model]",
        )));
    }
    let given = read_given(work, job)?;
    check_channels(job, &given.gauges, "the table of [sensitivity]")?;
    Ok(given)
}

/// Returns the stated errors of `[measured]`. The model's error is 0 if the uncertainty of S contains it.
pub fn stated_errors(measured: &Measured, s: &Sensitivity, fields: Option<&Fields>) -> ErrorModel {
    let in_s = s.uncertainty.is_some() && fields.is_some_and(|f| f.mesh_error.is_some());
    ErrorModel {
        noise: measured.noise_microstrain * MICROSTRAIN,
        model_rel: if in_s {
            0.0
        } else {
            measured.model_uncertainty_rel
        },
    }
}

/// Returns whether the job's S is calibrated.
pub fn has_covariance(job: &Job) -> bool {
    let given = job.sensitivity.as_ref();
    given.is_some_and(|s| s.covariance.is_some())
}

/// Rank and condition numbers of S, as in `result.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Conditioning {
    /// Rank.
    pub rank: usize,
    /// Condition number of S in strain per job unit.
    pub condition_number: Option<f64>,
    /// Condition number of S with its columns multiplied by `expected`, or else normalised.
    pub condition_number_scaled: Option<f64>,
}

impl Conditioning {
    /// Returns rank and condition numbers of S.
    pub fn from_sensitivity(s: &Sensitivity) -> Self {
        Self {
            rank: s.rank(),
            condition_number: finite_or_none(s.condition_number()),
            condition_number_scaled: finite_or_none(s.condition_number_scaled()),
        }
    }
}

/// Returns the finding on the source of the strain.
pub fn source_finding(source: &str) -> Finding {
    Finding::new(
        Severity::Info,
        "strain-source",
        "model",
        format!("strain of the unit loads: {source}"),
        "",
    )
}
