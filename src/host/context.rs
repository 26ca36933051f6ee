//! What a question is asked in: where files come from, where solutions are kept, who hears of progress and may stop the work.

use crate::host::store::SolutionStore;
use crate::host::whole_file::{FileBytes, Opened, Stamp, load, open};
use crate::stop::Stop;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where files come from.
pub trait Files: Sync {
    /// The bytes of a file.
    ///
    /// # Errors
    /// Those of the system; [`std::io::ErrorKind::NotFound`] where there is none.
    fn load(&self, path: &Path) -> std::io::Result<FileBytes>;

    /// A file opened.
    ///
    /// # Errors
    /// As [`Files::load`].
    fn open(&self, path: &Path) -> std::io::Result<Opened> {
        self.load(path).map(Opened::Whole)
    }

    /// The state of a file.
    ///
    /// # Errors
    /// As [`Files::load`].
    fn stamp(&self, path: &Path) -> std::io::Result<Stamp> {
        let size = self.load(path)?.len() as u64;
        Ok(Stamp {
            size,
            written_ns: None,
        })
    }
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn load(&self, path: &Path) -> std::io::Result<FileBytes> {
        load(path)
    }

    fn open(&self, path: &Path) -> std::io::Result<Opened> {
        open(path)
    }

    fn stamp(&self, path: &Path) -> std::io::Result<Stamp> {
        Ok(Stamp::from(&std::fs::metadata(path)?))
    }
}

/// Files held in memory, by path.
#[derive(Clone, Debug, Default)]
pub struct InMemory {
    files: BTreeMap<PathBuf, Vec<u8>>,
}

impl InMemory {
    /// Adds a file.
    #[must_use]
    pub fn with(mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.insert(path.into(), bytes.into());
        self
    }
}

impl Files for InMemory {
    fn load(&self, path: &Path) -> std::io::Result<FileBytes> {
        match self.files.get(path) {
            Some(bytes) => Ok(FileBytes::from(bytes.clone())),
            None => Err(std::io::ErrorKind::NotFound.into()),
        }
    }
}

/// Who hears of progress, and may stop the work.
pub trait Progress: Sync {
    /// A stage begins.
    fn begin(&self, stage: &str) {
        let _ = stage;
    }

    /// The stage begun last ends.
    fn end(&self) {}

    /// The present stage has so many parts; 0: it is not known.
    fn parts(&self, total: usize) {
        let _ = total;
    }

    /// So many parts more are done.
    fn advance(&self, parts: usize) {
        let _ = parts;
    }

    /// The wish to stop, for those below who look at it between the parts of a long computation.
    fn stop(&self) -> Stop {
        Stop::default()
    }

    /// Whether the work is to stop; asked between stages, and between the cases, runs, files and trials of one.
    fn is_cancelled(&self) -> bool {
        self.stop().is_asked()
    }
}

/// Hears nothing and stops nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {}

/// What a question is asked in.
#[derive(Clone)]
pub struct Context<'a> {
    /// Where files come from.
    pub files: &'a dyn Files,
    /// Where solutions of the built-in solver are kept; `None`: nowhere.
    pub store: Option<Arc<dyn SolutionStore + 'a>>,
    /// Who hears of progress.
    pub progress: &'a dyn Progress,
}

impl<'a> Context<'a> {
    /// Files from here; no solution is kept, nobody hears.
    pub fn new(files: &'a dyn Files) -> Self {
        Self {
            files,
            store: None,
            progress: &Silent,
        }
    }

    /// The same with a place for solutions. It is a handle and is cloned, so that one made in the call itself will do.
    #[must_use]
    pub fn store(self, store: &(impl SolutionStore + Clone + 'a)) -> Self {
        Self {
            store: Some(Arc::new(store.clone())),
            ..self
        }
    }

    /// The same with somebody who hears.
    #[must_use]
    pub fn progress(self, progress: &'a dyn Progress) -> Self {
        Self { progress, ..self }
    }
}
