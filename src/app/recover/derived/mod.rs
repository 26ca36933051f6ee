//! What else is made of recovered loads: RPC III, Parquet, Nastran cards, rainflow counts, arrows. A history is read back from `loads.bin`, a
//! piece at a time.

mod damage;
mod nastran;
mod parquet;
mod rpc;
mod vtu;

pub(super) use nastran::write_runs as write_nastran_runs;
pub(super) use vtu::write_arrows;

use super::Task;
use crate::app::fault::Faults;
use crate::app::files::FileBytes;
use crate::app::job::LoadFile;
use crate::app::strain::LoadUnits;
use crate::app::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::recovery::Sums;
use crate::recovery::history::Filter;
use crate::series::binary::{self, Header};

/// Samples of a history up to which every file is written without being asked for.
const MOST_SAMPLES: usize = 200_000;
/// The same for tables of Nastran, which hold a pair of numbers a sample as text.
const MOST_ROWS: usize = 20_000;
/// Samples read at a time.
const PIECE: usize = 16_384;

/// Files that are written for a history of about so many samples.
pub(super) fn wanted(task: &Task, samples: usize) -> Vec<LoadFile> {
    match &task.job.recover.files {
        Some(files) => files.clone(),
        None => LoadFile::ALL
            .iter()
            .map(|f| f.1)
            .filter(|f| {
                let most = match f {
                    LoadFile::Nastran => MOST_ROWS,
                    LoadFile::Rpc | LoadFile::Rainflow | LoadFile::Parquet => MOST_SAMPLES,
                };
                samples <= most && f.is_built()
            })
            .collect(),
    }
}

/// A history as written.
pub(super) struct History<'a> {
    /// `loads.bin`, report units.
    pub bytes: FileBytes,
    pub header: Header,
    /// Names of the loads.
    pub names: &'a [String],
    pub units: &'a [LoadUnits],
    pub filter: &'a Filter,
    pub sums: &'a Sums,
}

impl History<'_> {
    /// Appends samples `from .. to` of the columns, report units.
    fn samples(&self, from: usize, to: usize, columns: &[Option<usize>], out: &mut Vec<f64>) {
        binary::read_samples(&self.header, &self.bytes, from, to, columns, out);
    }

    /// All columns.
    fn all(&self) -> Vec<Option<usize>> {
        (0..self.names.len()).map(Some).collect()
    }

    /// Smallest and largest sample of load `l`, report unit; zeros where there is no sample.
    fn extremes(&self, l: usize) -> [f64; 2] {
        [self.sums.min[l], self.sums.max[l]].map(|v| {
            let v = v * self.units[l].factor;
            if v.is_finite() { v } else { 0.0 }
        })
    }
}

/// Writes the wanted files of a history.
///
/// # Errors
/// A file that can't be written.
pub(super) fn write_history(
    session: &mut Session,
    arguments: &JobArguments,
    task: &Task,
    history: &History,
    wanted: &[LoadFile],
) -> Result<(), Faults> {
    if wanted.contains(&LoadFile::Rainflow) {
        damage::write(session, arguments, task, history)?;
    }
    if wanted.contains(&LoadFile::Rpc) {
        rpc::write(session, arguments, history)?;
    }
    if wanted.contains(&LoadFile::Parquet) {
        parquet::write(session, arguments, task, history)?;
    }
    if wanted.contains(&LoadFile::Nastran) {
        nastran::write_history(session, arguments, task, history)?;
    }
    Ok(())
}

/// Notes which files were not written because the record is long.
pub(super) fn note_left_out(session: &mut Session, task: &Task, samples: u64, wanted: &[LoadFile]) {
    let left: Vec<&str> = LoadFile::ALL
        .iter()
        .filter(|f| !wanted.contains(&f.1) && f.1.is_built())
        .map(|f| f.0)
        .collect();
    if task.job.recover.files.is_none() && !left.is_empty() {
        session.findings.push(
            Finding::new(
                Severity::Info,
                "files-not-written",
                left.join(", "),
                "the record is long: these files are written only where they are asked for",
                "name them in [recover] files",
            )
            .with_numbers(samples as f64, MOST_ROWS as f64),
        );
    }
}
