//! `loads.parquet`.

use super::History;
use crate::app::fault::{Fault, Faults};
use crate::app::recover::Task;
use crate::app::{JobArguments, Session};

/// Writes the history in Parquet: `time` in s, then a column a load, report units; unit and 95 % half width in the metadata.
///
/// # Errors
/// A build without the feature, a file that can't be written.
#[cfg(feature = "parquet")]
pub(super) fn write(
    session: &mut Session,
    arguments: &JobArguments,
    _: &Task,
    history: &History,
) -> Result<(), Faults> {
    let sigma = history.filter.sigma(&vec![0.0; history.names.len()]);
    let mut notes = Vec::new();
    for (l, (name, unit)) in history.names.iter().zip(history.units).enumerate() {
        let half = history.filter.coverage_factor() * sigma[l] * unit.factor;
        notes.push((format!("unit of {name}"), unit.name.clone()));
        notes.push((format!("95 % half width of {name}"), half.to_string()));
    }
    let h = &history.header;
    let columns = history.all();
    let bytes = crate::series::parquet::parquet_bytes(
        history.names,
        &notes,
        [h.t0, h.dt],
        h.samples,
        |from, to, out| history.samples(from, to, &columns, out),
    )
    .map_err(|e| {
        let remedy = "report this as an error of the program";
        Faults::from(Fault::of("loads.parquet", "output", e.to_string(), remedy))
    })?;
    session
        .output_for(&arguments.job)?
        .write_bytes("loads.parquet", &bytes)
        .map_err(Faults::from)
}

/// Says that this build can't.
///
/// # Errors
/// Always.
#[cfg(not(feature = "parquet"))]
pub(super) fn write(
    _: &mut Session,
    _: &JobArguments,
    task: &Task,
    _: &History,
) -> Result<(), Faults> {
    Err(Faults::from(Fault::of(
        &*task.job.file,
        "recover.files",
        "this build of strainbridge does not write Parquet",
        "take a released binary, build with `--features parquet`, or leave `parquet` out",
    )))
}
