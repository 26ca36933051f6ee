//! The files of a plan: which texts are saved where.

use super::seen_files::changed_files_fault;
use super::session::{PlanTexts, Session};
use crate::host::context::{Disk, Files};
use crate::host::fault::{Fault, Faults};
use crate::host::output::Output;
use crate::job::{Job, Keep};
use crate::report::strain::GAUGES_HEAD;
use std::path::{Path, PathBuf};

/// Result of saving.
pub struct SavedPlan {
    /// Names of the files that were written.
    pub files: Vec<String>,
    /// Lines to write into the job, so that the command reads these files.
    pub advice: Vec<String>,
    /// Faults of the job with these files.
    pub faults: Option<Faults>,
}

impl Session {
    /// Writes the two texts of a plan into the folder of the job.
    ///
    /// # Errors
    /// Faults of the texts, files that changed on disk, files that `open` must not replace.
    pub fn save(&self, texts: &PlanTexts) -> Result<SavedPlan, Faults> {
        let job = self.job();
        job.with_plan_files(&texts.picks, texts.gauges.as_deref())?;
        let changed = self.seen.list_changed();
        if !changed.is_empty() {
            return Err(changed_files_fault(&changed).into());
        }
        let folder = match job.folder.as_os_str().is_empty() {
            true => PathBuf::from("."),
            false => job.folder.clone(),
        };
        let mut out = Output::begin(&folder)?;
        let (picked, gauges) = (job.picked_file().to_owned(), job.gauges_file().to_owned());
        let is_picked_named = job.candidates.file.as_ref().is_some_and(|f| f.is_toml());
        let mut files = Vec::new();
        if is_picked_named || !texts.picks.trim().is_empty() {
            self.check_picked(&job, is_picked_named)?;
            let text = match texts.picks.trim() {
                "" => "[candidates]\n",
                _ => &texts.picks,
            };
            out.write_bytes(&picked, text.as_bytes())?;
            files.push(picked);
        }
        if let Some(text) = &texts.gauges {
            self.check_gauges(&job)?;
            out.write_bytes(&gauges, text.as_bytes())?;
            files.push(gauges);
        }
        out.rename_all()?;
        for file in &files {
            self.seen.note_written(job.folder.join(file));
        }
        self.reread_job();
        Ok(SavedPlan {
            advice: advice(&job, texts),
            faults: Job::read(&self.path, &Disk).err(),
            files,
        })
    }

    fn check_picked(&self, job: &Job, is_named: bool) -> Result<(), Fault> {
        let name = job.picked_file();
        check_name(name, "candidates.file")?;
        let path = job.folder.join(name);
        if job.candidates.spots.is_some() {
            return Err(Fault::new(
                name,
                "candidates.file",
                "the job chooses from a table of named spots, and reads no picked lists",
                "state the number of gauges in the job",
            ));
        }
        if !is_named && path.exists() && !self.seen.has_written(&path) {
            return Err(Fault::new(
                name,
                "file",
                "the file exists, and the job does not name it",
                format!("name it in the job: [candidates] file = \"{name}\", or move it away"),
            ));
        }
        Ok(())
    }

    fn check_gauges(&self, job: &Job) -> Result<(), Fault> {
        let name = job.gauges_file();
        check_name(name, "gauges.file")?;
        if job.placement.keep != Keep::None && job.gauge_file.is_some() {
            return Err(Fault::new(
                name,
                "placement.keep",
                "the job itself keeps gauges of this table, so that it must not be replaced",
                "delete `keep` from the job: the picked file states it",
            ));
        }
        let path = job.folder.join(name);
        let Ok(bytes) = Disk.load(&path) else {
            return Ok(());
        };
        if self.seen.has_written(&path) || bytes.starts_with(GAUGES_HEAD.as_bytes()) {
            return Ok(());
        }
        Err(Fault::new(
            name,
            "file",
            "the file exists and is not a table of `place`: it may describe gauges that are installed",
            "name another file in the job: [gauges] file = \"plan.csv\", or move this one away",
        ))
    }
}

/// Refuses names that lead out of the folder of the job.
fn check_name(name: &str, key: &str) -> Result<(), Fault> {
    let is_plain = Path::new(name).file_name().is_some_and(|n| n == name) && !name.contains('\\');
    let is_text = name.ends_with(".toml") || name.ends_with(".csv");
    if is_plain && is_text {
        return Ok(());
    }
    Err(Fault::new(
        name,
        key,
        "`open` writes only text files in the folder of the job",
        "name a .toml or .csv file without a folder",
    ))
}

/// Returns the lines to write into a job that does not name the files of its plan.
fn advice(job: &Job, texts: &PlanTexts) -> Vec<String> {
    let mut out = Vec::new();
    if !texts.picks.trim().is_empty() && job.candidates.file.is_none() {
        out.push(format!(
            "The job does not read {0}: write file = \"{0}\" into [candidates] and delete the lists there that {0} states.",
            job.picked_file()
        ));
    }
    if texts.gauges.is_some() && job.gauge_file.is_none() {
        out.push(format!(
            "The job does not read {0}: to keep gauges of it, write [gauges] with file = \"{0}\".",
            job.gauges_file()
        ));
    }
    out
}
