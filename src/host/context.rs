//! Surroundings of a command: source of files, store of solutions, receiver of progress.

use crate::host::store::SolutionStore;
use crate::host::whole_file::{FileBytes, OpenedFile, Stamp, load, open};
use crate::stop::Stop;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Source of the files that a command reads. [`Disk`] reads the file system, [`InMemory`] a map.
pub trait Files: Sync {
    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// Returns the error of the system; [`std::io::ErrorKind::NotFound`] if the file does not exist.
    fn load(&self, path: &Path) -> std::io::Result<FileBytes>;

    /// Opens a file for reading in parts.
    ///
    /// # Errors
    /// Returns the errors of [`Files::load`].
    fn open(&self, path: &Path) -> std::io::Result<OpenedFile> {
        self.load(path).map(OpenedFile::Whole)
    }

    /// Returns size and time of the last change of a file.
    ///
    /// # Errors
    /// Returns the errors of [`Files::load`].
    fn stamp(&self, path: &Path) -> std::io::Result<Stamp> {
        let size = self.load(path)?.len() as u64;
        Ok(Stamp {
            size,
            written_ns: None,
        })
    }
}

/// Files of the file system. Relative paths start at the working directory of the process.
///
/// # Example
/// ```
/// use std::io::ErrorKind;
/// use std::path::Path;
/// use strainbridge::Disk;
/// use strainbridge::host::context::Files;
///
/// let runs = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/frame/runs.csv"));
/// let bytes = Disk.load(runs)?;
/// assert!(bytes.starts_with(b"run,"));
/// assert_eq!(Disk.stamp(runs)?.size, bytes.len() as u64);
///
/// let missing = Disk.load(Path::new("no-such-file.csv")).err();
/// assert_eq!(missing.map(|e| e.kind()), Some(ErrorKind::NotFound));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn load(&self, path: &Path) -> std::io::Result<FileBytes> {
        load(path)
    }

    fn open(&self, path: &Path) -> std::io::Result<OpenedFile> {
        open(path)
    }

    fn stamp(&self, path: &Path) -> std::io::Result<Stamp> {
        Ok(Stamp::from(&std::fs::metadata(path)?))
    }
}

/// Files in memory, by path. Tests and other programs give their files to a command with it.
///
/// # Example
/// ```
/// use std::path::Path;
/// use strainbridge::host::context::{Files, InMemory};
///
/// let files = InMemory::default().with_file("runs.csv", "run,left\n").with_file("runs.csv", "run,right\n");
/// // A later file replaces an earlier one of the same path.
/// assert_eq!(&files.load(Path::new("runs.csv"))?[..], b"run,right\n");
/// assert!(files.load(Path::new("other.csv")).is_err());
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct InMemory {
    files: BTreeMap<PathBuf, Vec<u8>>,
}

impl InMemory {
    /// Adds a file.
    #[must_use]
    pub fn with_file(mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) -> Self {
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

/// Receiver of progress, which can also stop the work.
pub trait Progress: Sync {
    /// Reports that a stage begins.
    fn begin(&self, stage: &str) {
        let _ = stage;
    }

    /// Reports that the latest stage ends.
    fn end(&self) {}

    /// Reports the number of parts of the present stage; 0 if it is unknown.
    fn parts(&self, total: usize) {
        let _ = total;
    }

    /// Reports that a number of further parts is complete.
    fn advance(&self, parts: usize) {
        let _ = parts;
    }

    /// Returns the signal to stop, which long computations test between their parts.
    fn stop(&self) -> Stop {
        Stop::default()
    }

    /// Returns whether the work must stop. Commands test it between stages, and between the cases, runs, files and trials of a stage.
    fn is_cancelled(&self) -> bool {
        self.stop().is_asked()
    }
}

/// Receiver that ignores progress and never stops the work.
#[derive(Clone, Copy, Debug, Default)]
pub struct SilentProgress;

impl Progress for SilentProgress {}

/// Surroundings of a command: files, store of solutions, and progress. Every command takes one.
///
/// # Example
/// A program that has its deck in memory, stores the solution and lists the stages:
/// ```
/// use std::path::Path;
/// use std::sync::Mutex;
/// use strainbridge::host::context::{InMemory, Progress};
/// use strainbridge::host::store::Memory;
/// use strainbridge::{Context, solve_deck};
///
/// struct Stages(Mutex<Vec<String>>);
/// impl Progress for Stages {
///     fn begin(&self, stage: &str) {
///         self.0.lock().unwrap().push(stage.to_owned());
///     }
/// }
///
/// # const ROD: &str = "SOL 101\nCEND\nSPC = 1\nLOAD = 2\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1000.,0.,0.,,23456\nCROD,1,1,1,2
/// # PROD,1,1,100.\nMAT1,1,210000.,,.3\nSPC1,1,123456,1\nFORCE,2,2,,2100.,1.,0.,0.\nENDDATA\n";
/// let files = InMemory::default().with_file("rod.bdf", ROD);
/// let stages = Stages(Mutex::default());
/// let cx = Context::new(&files).store(&Memory::default()).progress(&stages);
/// let rod = solve_deck(Path::new("rod.bdf"), Default::default(), &cx)?;
/// assert_eq!(rod.inputs[0].path, "rod.bdf");
/// assert!(stages.0.lock().unwrap().contains(&"solve".to_owned()));
/// # Ok::<(), strainbridge::Faults>(())
/// ```
#[derive(Clone)]
pub struct Context<'a> {
    /// Source of files.
    pub files: &'a dyn Files,
    /// Store for solutions of the built-in solver; `None` if they are not stored.
    pub store: Option<Arc<dyn SolutionStore + 'a>>,
    /// Receiver of progress.
    pub progress: &'a dyn Progress,
}

impl<'a> Context<'a> {
    /// Creates a context that reads `files`, stores no solutions and reports no progress.
    pub fn new(files: &'a dyn Files) -> Self {
        Self {
            files,
            store: None,
            progress: &SilentProgress,
        }
    }

    /// Adds a store for solutions. The store is a handle and is cloned, so it may be a temporary value.
    #[must_use]
    pub fn store(self, store: &(impl SolutionStore + Clone + 'a)) -> Self {
        Self {
            store: Some(Arc::new(store.clone())),
            ..self
        }
    }

    /// Adds a receiver of progress.
    #[must_use]
    pub fn progress(self, progress: &'a dyn Progress) -> Self {
        Self { progress, ..self }
    }
}
