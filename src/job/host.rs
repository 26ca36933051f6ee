//! Files of a job, read with the line that names them, and its folder of kept solutions.

use super::{Job, NamedFile};
use crate::finding::list_few;
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::files::{FileBytes, Inputs, as_table, no_text, unreadable_file_fault};
use crate::host::sheet::sheet_names;
use crate::host::store::Folder;
use crate::host::work::Work;
use crate::series::record::csv::table_text;
use std::path::Path;

impl Inputs<'_> {
    /// Returns the bytes of a file that a job names. For a spreadsheet, the bytes are the CSV text of its first sheet. For Parquet and Feather with a
    /// column `run`, they are the CSV text of the table.
    ///
    /// # Errors
    /// A fault at the line of the job that names it.
    pub fn read_named(&mut self, job: &Job, named: &NamedFile) -> Result<FileBytes, Fault> {
        let read = self.read(&job.folder, &named.given);
        // Results and covariances have their own formats.
        let is_table = !["model.", "load.result", "sensitivity.covariance"]
            .iter()
            .any(|key| named.key.starts_with(key));
        let read = match is_table {
            true => read.and_then(|bytes| as_table(&named.given, bytes)),
            false => read,
        };
        self.note_end(&named.given, read.as_ref().ok());
        read.map_err(|f| at_job_line(job, named, f))
    }

    /// Returns the faults of a table that a job names. If its spreadsheet has several sheets, the faults state which sheet was read and which were
    /// not.
    pub(crate) fn with_sheet_read(&self, job: &Job, named: &NamedFile, faults: Faults) -> Faults {
        let bytes = self.load(&job.folder.join(&named.given));
        let names = bytes.map_or_else(|_| Vec::new(), |b| sheet_names(&b));
        let [read, others @ ..] = &names[..] else {
            return faults;
        };
        if others.is_empty() {
            return faults;
        }
        let others: Vec<String> = others.iter().map(|n| format!("`{n}`")).collect();
        let others = list_few(&others);
        let mut list = faults.into_list();
        for fault in list.iter_mut().filter(|f| f.file == named.given) {
            fault.wrong +=
                &format!("; this is the first sheet, `{read}`, the file also has {others}");
            fault.remedy +=
                "; only the first sheet is read: move the table there if it is in another";
        }
        match Faults::check(list) {
            Err(faults) => faults,
            Ok(()) => Fault::new(&*named.given, "sheet", "no table", "write a table").into(),
        }
    }

    /// Returns the text of a table that a job names: UTF-8, UTF-16, or the eight-bit code of Windows that spreadsheets write.
    ///
    /// # Errors
    /// A fault at the line of the job that names it, or at the line that isn't text.
    pub fn read_named_text(&mut self, job: &Job, named: &NamedFile) -> Result<String, Fault> {
        let text = self.table_bytes(&job.folder, &named.given);
        let text =
            text.and_then(|bytes| table_text(&bytes).ok_or_else(|| no_text(&named.given, &bytes)));
        self.note_end(&named.given, text.as_ref().ok());
        text.map_err(|f| at_job_line(job, named, f))
    }
}

impl<'a> Work<'a> {
    /// Starts the work of a command on a job. The files of the job count as read.
    pub fn of_job(cx: &Context<'a>, job: &Job) -> Self {
        let mut work = Self::new(cx);
        work.inputs = Inputs::resume(cx.files, &job.read);
        work
    }
}

impl Folder {
    /// Returns the folder `<job name>.cache` for solutions, next to the job like `<job name>.out`, which contains the output of a command.
    pub fn from_job(job: &Job) -> Self {
        let mut name = match Path::new(&job.file).file_stem() {
            Some(stem) => stem.to_owned(),
            None => "strainbridge".into(),
        };
        name.push(".cache");
        Self::new(job.folder.join(name))
    }
}

fn at_job_line(job: &Job, named: &NamedFile, f: Fault) -> Fault {
    match f.line {
        Some(_) => f,
        None => Fault::with_line(
            &*job.file,
            named.line,
            &*named.key,
            format!("`{}`: {}", named.given, f.wrong),
            f.remedy,
        ),
    }
}

/// Returns the fault of a file that can't be read, at the line of the job that names the file.
pub(crate) fn unreadable_at(job: &Job, named: &NamedFile, e: &std::io::Error) -> Fault {
    at_job_line(job, named, unreadable_file_fault(&named.given, e))
}
