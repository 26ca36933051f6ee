//! Where the loads of a record are written while they are recovered.

use super::tables::{LoadTables, LoadsFile};
use crate::host::fault::Fault;
use crate::host::output::Output;
use crate::workflow::recover::{Block, RecordHead, RecordSink, Samples};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Writes the loads of a record to `loads.csv` and `loads.bin` of a folder, under temporary names.
///
/// [`RecordFolder::into_output`] passes the folder to the caller, who adds the other files and renames all of them. Before a record begins, no file
/// is touched.
pub struct RecordFolder {
    // `tables` is dropped before `out`, which removes the files.
    tables: Option<LoadTables>,
    out: Option<Output>,
    folder: PathBuf,
}

impl RecordFolder {
    /// Creates the writer for this folder.
    pub fn new(folder: &Path) -> Self {
        Self {
            tables: None,
            out: None,
            folder: folder.to_owned(),
        }
    }

    /// Returns the folder with the files written so far.
    ///
    /// # Errors
    /// A fault if it cannot be created.
    pub fn into_output(self) -> Result<Output, Fault> {
        match self.out {
            Some(out) => Ok(out),
            None => Output::begin(&self.folder),
        }
    }
}

impl RecordSink for RecordFolder {
    fn begin(&mut self, head: &Arc<RecordHead>) -> Result<(), Fault> {
        let out = match self.out.take() {
            Some(out) => out,
            None => Output::begin(&self.folder)?,
        };
        let out = self.out.insert(out);
        self.tables = Some(LoadTables::begin(out, head)?);
        Ok(())
    }

    fn take(&mut self, blocks: Vec<Block>) -> Result<(), Fault> {
        match (&mut self.tables, &self.out) {
            (Some(tables), Some(out)) => tables.take(out, &blocks),
            _ => Ok(()),
        }
    }

    fn end(&mut self, samples: u64) -> Result<(), Fault> {
        match (self.tables.take(), &self.out) {
            (Some(tables), Some(out)) => tables.end(out, samples),
            _ => Ok(()),
        }
    }

    fn samples(&self) -> Result<Box<dyn Samples + '_>, Fault> {
        let nothing = || {
            let remedy = "report this as an error of the program";
            Fault::new("loads.bin", "samples", "no record was read", remedy)
        };
        let out = self.out.as_ref().ok_or_else(nothing)?;
        Ok(Box::new(LoadsFile::read_back(out)?))
    }
}
