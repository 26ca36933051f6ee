//! A job with other contents of the two files of a plan: picked lists, and the table of gauges.

use super::candidate_lists::{lists, merge_candidates};
use super::gauge_table::GaugeColumns;
use super::gauges::gauges_from_table;
use super::table::read_table;
use super::types::{Job, JobGauge, NamedFile};
use super::{check_job, read_job_text, resolve};
use crate::host::context::Files;
use crate::host::fault::{FaultList, Faults};
use crate::host::files::Inputs;
use std::path::Path;

/// Name of the file of picked lists if the job names none.
const PICKED: &str = "picked.toml";
/// Name of the table of gauges if the job names none.
const GAUGES: &str = "gauges.csv";

impl Job {
    /// Reads and checks a job file without the picked lists of `[candidates] file`, which may be missing.
    ///
    /// # Errors
    /// Returns the faults of [`Job::read`], other than faults of the picked lists.
    pub fn read_without_picks(path: impl AsRef<Path>, files: &dyn Files) -> Result<Self, Faults> {
        let mut inputs = Inputs::new(files);
        let (job, faults) = read_job_text(&mut inputs, path.as_ref())?;
        let mut job = check_job(&mut inputs, job, faults)?;
        job.read = inputs.files_read();
        Ok(job)
    }

    /// Returns the name of the file of picked lists as the job states it, else `picked.toml`.
    pub fn picked_file(&self) -> &str {
        let named = self.candidates.file.as_ref().filter(|f| f.is_toml());
        named.map_or(PICKED, |f| &f.given)
    }

    /// Returns the name of the table of gauges as the job states it, else `gauges.csv`.
    pub fn gauges_file(&self) -> &str {
        self.gauge_file.as_ref().map_or(GAUGES, |f| &f.given)
    }

    /// Returns the job as if its file of picked lists had the text `picks`, and its table of gauges the text `gauges`. If the job names no file of
    /// picked lists, lists of the text replace the lists of the job. A blank text of picks changes nothing. Without `gauges`, the job keeps its
    /// table.
    ///
    /// # Errors
    /// Faults of the two texts, each with the name of the file.
    pub fn with_plan_files(&self, picks: &str, gauges: Option<&str>) -> Result<Self, Faults> {
        let (mut job, mut faults) = (self.clone(), FaultList::new());
        if !picks.trim().is_empty() {
            if job.candidates.file.is_none() && states_lists(picks) {
                for (_, list) in lists(&mut job.candidates) {
                    list.clear();
                }
            }
            let named = NamedFile {
                given: self.picked_file().to_owned(),
                key: "candidates.file".to_owned(),
                line: self.candidates.line,
            };
            merge_candidates(&mut job, &named, picks, &mut faults);
        }
        if let Some(text) = gauges {
            // Gauges of [[gauge]] stay, the table is replaced.
            job.gauges.retain(|g| g.file == self.file);
            match read_gauges_text(&job, text, &mut faults) {
                Ok(read) => job.gauges.extend(read),
                Err(wrong) => faults.extend(wrong.into_list()),
            }
        }
        resolve::check_names(&job, &mut faults);
        Faults::check(faults)?;
        Ok(job)
    }
}

/// Returns whether a text of picks has a section of lists.
fn states_lists(picks: &str) -> bool {
    let table: toml::Table = picks.parse().unwrap_or_default();
    table.contains_key("candidates")
}

/// Returns the gauges of the text of a table; faults of its rows are added to the list.
fn read_gauges_text(
    job: &Job,
    text: &str,
    faults: &mut FaultList,
) -> Result<Vec<JobGauge>, Faults> {
    let table = read_table(job.gauges_file(), text)?;
    table.check_rows()?;
    let columns = GaugeColumns::from_table(&table, job.units.length_m(), faults);
    Ok(gauges_from_table(&table, &columns, faults))
}
