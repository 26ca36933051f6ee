//! What the strain commands share: the model with its unit-load strain, gauges laid onto it, S from there or from a table.

mod fields;
mod gauges;
mod given;
mod units;

pub use fields::{Fields, read_fields, unit_loads};
pub use gauges::{lay_gauges, side, spec_of, without_strain};
pub use given::read_given;
pub use units::{LoadUnits, load_units};

use super::Session;
use super::fault::Faults;
use super::job::Job;
use crate::finding::{Finding, Severity};
use crate::gauge::Gauge;
use crate::sensitivity::{Sensitivity, check_separability, from_cases};

/// S of the job's gauges with all there is to know of them.
pub struct Prepared {
    /// S.
    pub sensitivity: Sensitivity,
    /// Model and strain fields; `None` where S is given.
    pub fields: Option<Fields>,
    /// Gauges on the model; empty where S is given.
    pub gauges: Vec<Gauge>,
}

/// S of the job's gauges: from the table of `[sensitivity]`, else from the model and its results.
///
/// # Errors
/// Every fault on the way.
pub fn prepare(session: &mut Session, job: &Job) -> Result<Prepared, Faults> {
    let prepared = if job.sensitivity.is_some() {
        let sensitivity = read_given(session, job)?;
        Prepared {
            sensitivity,
            fields: None,
            gauges: Vec::new(),
        }
    } else {
        let fields = read_fields(session, job)?;
        let gauges = lay_gauges(session, job, &fields)?;
        let sensitivity = from_cases(&gauges, &fields.load_cases(job))
            .map_err(|missing| without_strain(job, &missing))?;
        Prepared {
            sensitivity,
            fields: Some(fields),
            gauges,
        }
    };
    Ok(prepared)
}

/// Rank, condition numbers and findings on separability, put into the result.
///
/// # Errors
/// Mistakes of the program only.
pub fn put_conditioning(session: &mut Session, s: &Sensitivity) -> Result<(), Faults> {
    session.put("rank", s.rank())?;
    session.put("condition_number", micro(s.condition_number()))?;
    session.put(
        "condition_number_scaled",
        micro(s.condition_number_scaled()),
    )?;
    session.findings.extend(check_separability(s));
    Ok(())
}

/// A condition number for JSON: infinite has no form there and becomes null.
fn micro(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// A finding that says where the strain comes from.
pub fn source_finding(source: &str) -> Finding {
    Finding::new(
        Severity::Info,
        "strain-source",
        "model",
        format!("strain of the unit loads: {source}"),
        "",
    )
}
