//! job.toml and the tables that it names. `parse` turns text into `raw_job` structs with the place of every value. `resolve` turns these structs into
//! the plain structs of `types`. [`gauges`], [`given_columns`] and [`table`] read the tables of a job. [`schema`] describes a job to editors.

pub mod calibrated_range;
mod candidate_lists;
pub mod correct;
mod faults;
mod gauge_table;
pub mod gauges;
pub mod given_columns;
pub(crate) mod host;
mod not_a_job;
mod parse;
pub mod payload_loads;
pub mod payload_signature;
mod plan_files;
mod property_names;
pub mod quantity;
mod raw_job;
mod raw_record;
pub mod readings;
mod resolve;
mod roles;
pub(crate) mod same_name;
pub mod schema;
mod shapes;
mod spanned_value;
mod spots;
pub mod suggest;
pub mod table;
mod types;
pub mod unread_columns;

#[cfg(test)]
pub(crate) mod tests;

pub use resolve::{SAME_SIDE, SAME_SIDE_REMEDY};
pub use types::*;

use crate::host::context::Files;
use crate::host::fault::{FaultList, Faults};
use crate::host::files::Inputs;
use crate::units::STANDARD_GRAVITY_M_S2;
use std::path::Path;

impl Job {
    /// Reads and checks a job file with the table of gauges that it names. Commands read strain and runs later.
    ///
    /// # Errors
    /// Returns every fault with file and line: syntax, unknown keys, wrong types, contradictions, missing files.
    pub fn read(path: impl AsRef<Path>, files: &dyn Files) -> Result<Self, Faults> {
        let mut inputs = Inputs::new(files);
        let mut job = read_job(&mut inputs, path.as_ref())?;
        job.read = inputs.files_read();
        Ok(job)
    }

    /// Returns gravity in m/s^2, from `[payload]` or else standard gravity. The unit system of the job does not matter.
    pub fn gravity_m_s2(&self) -> f64 {
        let payload = self.payload.as_ref();
        payload.map_or(STANDARD_GRAVITY_M_S2, |p| p.gravity_m_s2)
    }

    /// Returns the job with the spots of `[candidates] file` as its gauges; `None` without a table of spots.
    pub fn with_spots_as_gauges(&self) -> Option<Self> {
        let spots = self.candidates.spots.as_ref()?;
        Some(Self {
            gauges: spots.iter().map(|s| s.gauge.clone()).collect(),
            ..self.clone()
        })
    }

    /// Returns gravity in the units of the job.
    pub fn gravity(&self) -> f64 {
        self.gravity_m_s2() / self.units.length_m()
    }

    /// Returns the grid where the payload acts: the grid in `[payload]`, or else the only grid with moments among the wanted loads.
    pub fn payload_grid(&self) -> Option<u32> {
        let payload = self.payload.as_ref()?;
        let mut with_moment = self.loads.iter().filter_map(|l| match l.acts {
            LoadActs::AtGrid {
                grid, component, ..
            } if !component.is_force() && l.role == LoadRole::Wanted => Some(grid),
            _ => None,
        });
        payload.grid.or_else(|| {
            let first = with_moment.next()?;
            with_moment.all(|g| g == first).then_some(first)
        })
    }
}

impl AsRef<Path> for Job {
    fn as_ref(&self) -> &Path {
        Path::new(&self.file)
    }
}

/// Reads and checks a job file with its table of gauges. Commands read strain and runs later.
///
/// # Errors
/// Returns every fault: syntax, unknown keys, wrong types, contradictions, missing files.
pub fn read_job(inputs: &mut Inputs, path: &Path) -> Result<Job, Faults> {
    let (mut job, mut faults) = read_job_text(inputs, path)?;
    candidate_lists::read_picked(inputs, &mut job, &mut faults);
    check_job(inputs, job, faults)
}

/// Reads the text of a job and its table of gauges. Returns the job without the files of its candidates, and the faults found so far.
///
/// # Errors
/// A file that is not a job.
fn read_job_text(inputs: &mut Inputs, path: &Path) -> Result<(Job, FaultList), Faults> {
    let given = path.display().to_string();
    not_a_job::check_name(&given)?;
    let folder = Path::new("");
    let bytes = inputs.read(folder, &given).map_err(Faults::from)?;
    if let Ok(text) = std::str::from_utf8(&bytes) {
        not_a_job::check_text(&given, text)?;
    }
    let text = inputs.read_text(folder, &given).map_err(Faults::from)?;
    let (raw, mut faults) = parse::parse_job(&given, &text);
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut job = resolve::resolve_job(&given, &text, &folder, raw, &mut faults);
    job.gauges
        .extend(gauges::read_gauge_file(inputs, &job, &mut faults));
    Ok((job, faults))
}

/// Reads the named spots of a job and checks the job.
///
/// # Errors
/// Every fault.
fn check_job(inputs: &mut Inputs, mut job: Job, mut faults: FaultList) -> Result<Job, Faults> {
    spots::read_spots(inputs, &mut job, &mut faults);
    resolve::check_names(&job, &mut faults);
    resolve::check_named(&job, &mut faults);
    correct::correct_legs(&mut job, &mut faults);
    let given = &job.file;
    faults.sort_by(|a, b| {
        (a.file != *given, &a.file, a.line).cmp(&(b.file != *given, &b.file, b.line))
    });
    faults.dedup();
    Faults::check(faults)?;
    Ok(job)
}
