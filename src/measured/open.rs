//! A strain file: runs, or a record.

use super::conditioning;
use super::faults::{no_runs, record_fault};
use super::record::{Record, section_channels};
use super::strain_file::{read_strain, wanted_columns};
use super::strain_table::{StrainRows, StrainTable};
use crate::host::fault::Faults;
use crate::host::files::{FileBytes, Inputs};
use crate::job::{Job, Measured, NamedFile};
use crate::series::record::csv::{Layout, has_bare_returns};
use crate::series::record::is_format;

/// Runs or record of a strain file.
pub(crate) enum MeasuredStrain {
    /// Static states, a row each.
    Runs(StrainTable),
    /// Samples of one record.
    Record(Box<Record>),
}

impl MeasuredStrain {
    /// Returns the runs.
    ///
    /// # Errors
    /// A fault if the strain file is a record, not a table of runs.
    pub fn into_runs(self) -> Result<StrainTable, Faults> {
        match self {
            Self::Runs(table) => Ok(table),
            Self::Record(record) => Err(no_runs(record.file()).into()),
        }
    }

    /// Returns the name of each column: the gauge as the job names it.
    pub fn gauges(&self) -> &[String] {
        match self {
            Self::Runs(table) => &table.gauges,
            Self::Record(record) => &record.names,
        }
    }
}

/// Returns whether a strain file is a record, with a row for each sample, and not a table of runs.
pub(super) fn is_record(bytes: &FileBytes) -> bool {
    is_format(bytes) || Layout::detect(bytes).is_ok_and(|l| l.is_record())
}

/// Opens a strain file of a job: reads the runs, or opens the record, whose pieces are read later.
///
/// # Errors
/// Every fault of the file.
pub(crate) fn open(
    inputs: &mut Inputs,
    job: &Job,
    measured: &Measured,
    named: &NamedFile,
) -> Result<MeasuredStrain, Faults> {
    open_first_sheet(inputs, job, measured, named)
        .map_err(|faults| inputs.with_sheet_read(job, named, faults))
}

/// Opens a strain file, of a spreadsheet the first sheet.
fn open_first_sheet(
    inputs: &mut Inputs,
    job: &Job,
    measured: &Measured,
    named: &NamedFile,
) -> Result<MeasuredStrain, Faults> {
    let bytes = inputs.read_named(job, named)?;
    let wanted = wanted_columns(inputs, job);
    if is_record(&bytes) {
        let of_file = (named.given.as_str(), measured.time_unit_s);
        // Rules of sections select samples of the measured record only.
        let rules = match named.given == measured.strain.given {
            true => section_channels(job).collect(),
            false => Vec::new(),
        };
        let record = Record::open(job, of_file, bytes, (&wanted, &rules))?;
        let record = conditioning::condition(job, record, &wanted)?;
        return Ok(MeasuredStrain::Record(Box::new(record)));
    }
    let table = read_strain(inputs, job, named, &wanted);
    let looks_like_record = match &table {
        Ok(t) => matches!(t.rows, StrainRows::Times(_)),
        Err(_) => has_bare_returns(&bytes),
    };
    if looks_like_record {
        // The layout is the reason why the file is not a record.
        let wrong = Layout::detect(&bytes).err();
        let wrong = wrong.map_or_else(|| no_runs(&named.given), |e| record_fault(&named.given, &e));
        return Err(wrong.into());
    }
    table.map(MeasuredStrain::Runs)
}
