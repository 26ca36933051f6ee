//! Spreadsheets into the output folder, with the job's units and the findings so far.

use super::Session;
use super::fault::{Fault, Faults};
use super::job::Job;
use crate::report::spreadsheet::{About, Sheet, UnitOf, spreadsheet};
use crate::units::Quantity;
use std::path::Path;

/// Writes workbook `name`.
///
/// # Errors
/// A file that can't be written; what the writing library refuses, which is a mistake of the program.
pub fn write_spreadsheet(
    session: &mut Session,
    job: &Job,
    main_input: &Path,
    name: &str,
    sheets: &[Sheet],
) -> Result<(), Faults> {
    let reported = [
        ("force", job.report_units.force),
        ("moment", job.report_units.moment),
        ("mass", job.report_units.mass),
    ];
    let mut units: Vec<UnitOf> = reported
        .map(|(quantity, unit)| UnitOf {
            quantity,
            unit: unit.name.to_owned(),
        })
        .to_vec();
    let own = [
        ("position", Quantity::Length),
        ("load unit of `Sensitivity`, force", Quantity::Force),
        ("load unit of `Sensitivity`, moment", Quantity::Moment),
    ];
    units.extend(own.map(|(quantity, q)| UnitOf {
        quantity,
        unit: job.units.unit(q).name.to_owned(),
    }));
    units.push(UnitOf {
        quantity: "strain",
        unit: "microstrain".to_owned(),
    });
    let bytes = spreadsheet(
        sheets,
        &About {
            title: &job.title,
            units: &units,
            findings: &session.findings,
        },
    )
    .map_err(|e| {
        Faults::from(Fault::of(
            name,
            "spreadsheet",
            e.to_string(),
            "report this as an error of the program",
        ))
    })?;
    session
        .output_for(main_input)?
        .write_bytes(name, &bytes)
        .map_err(Faults::from)
}
