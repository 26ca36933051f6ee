//! Solutions in a folder of the file system.

use super::{Key, SolutionStore};
use crate::host::half_written;
use std::path::{Path, PathBuf};

/// Largest number of solutions in one folder. The solution that was not used for the longest time is removed first.
const KEPT: usize = 64;
/// Largest number of bytes of these solutions.
const MOST_BYTES: u64 = 4 << 30;

/// Folder that stores solutions of the built-in solver as `<key>.solution`. It removes the oldest solutions above a fixed number and size.
///
/// # Example
/// A second command on the same deck takes the stored solution:
/// ```
/// use std::path::Path;
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, Folder, solve_deck};
///
/// # const ROD: &str = "SOL 101\nCEND\nSPC = 1\nLOAD = 2\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1000.,0.,0.,,23456\nCROD,1,1,1,2
/// # PROD,1,1,100.\nMAT1,1,210000.,,.3\nSPC1,1,123456,1\nFORCE,2,2,,2100.,1.,0.,0.\nENDDATA\n";
/// # let path = std::env::temp_dir().join(format!("strainbridge-folder-{}", std::process::id()));
/// let folder = Folder::new(&path);
/// assert_eq!(folder.size().0, 0);
///
/// let files = InMemory::default().with_file("rod.bdf", ROD);
/// let cx = Context::new(&files).store(&folder);
/// let solved = solve_deck(Path::new("rod.bdf"), Default::default(), &cx)?;
/// let again = solve_deck(Path::new("rod.bdf"), Default::default(), &cx)?;
/// assert_eq!(folder.size().0, 1);
/// assert_eq!(solved.solution.cases[0].displacement, again.solution.cases[0].displacement);
///
/// assert_eq!(folder.clean()?.0, 1);
/// assert!(!path.exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// Returns the store in this folder. The folder is created when the first solution is stored.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self(folder.into())
    }

    /// Returns the store in the folder `STRAINBRIDGE_CACHE`. Without this variable, the folder is `strainbridge` in `XDG_CACHE_HOME`, in the cache
    /// folder of the system, or in the folder for temporary files.
    pub fn of_user() -> Self {
        let at = |name: &str| {
            let path = PathBuf::from(std::env::var_os(name)?);
            path.is_absolute().then_some(path)
        };
        if let Some(folder) = at("STRAINBRIDGE_CACHE") {
            return Self(folder);
        }
        let system = match std::env::consts::OS {
            "windows" => at("LOCALAPPDATA"),
            "macos" => at("HOME").map(|h| h.join("Library").join("Caches")),
            _ => at("HOME").map(|h| h.join(".cache")),
        };
        let base = at("XDG_CACHE_HOME").or(system);
        Self(base.unwrap_or_else(std::env::temp_dir).join("strainbridge"))
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Returns the number of stored solutions and their total size in bytes.
    pub fn size(&self) -> (usize, u64) {
        let kept = self.kept_solutions();
        (kept.len(), kept.iter().map(|k| k.1).sum())
    }

    /// Removes every stored solution, and the folder if it is then empty. Returns the number and the total size in bytes of the removed solutions.
    ///
    /// # Errors
    /// Returns the error of the first file that cannot be removed.
    pub fn clean(&self) -> std::io::Result<(usize, u64)> {
        half_written::remove_stale(&self.0);
        let (mut n, mut bytes) = (0, 0);
        for (_, size, path) in self.kept_solutions() {
            std::fs::remove_file(path)?;
            n += 1;
            bytes += size;
        }
        // The system refuses this if the folder contains anything else.
        let _ = std::fs::remove_dir(&self.0);
        Ok((n, bytes))
    }

    /// Kept solutions, the oldest use first: when, bytes, file.
    fn kept_solutions(&self) -> Vec<(std::time::SystemTime, u64, PathBuf)> {
        let entries = std::fs::read_dir(&self.0).into_iter().flatten();
        let mut files: Vec<_> = entries
            .filter_map(Result::ok)
            .filter(|e| e.path().extension().is_some_and(|x| x == "solution"))
            .filter_map(|e| {
                let meta = e.metadata().ok().filter(|m| m.is_file())?;
                Some((meta.modified().ok()?, meta.len(), e.path()))
            })
            .collect();
        files.sort();
        files
    }

    fn file(&self, key: &Key) -> PathBuf {
        self.0.join(format!("{}.solution", key.name()))
    }

    fn forget_oldest(&self) {
        let mut files = self.kept_solutions();
        // The newest solution stays, however large.
        files.pop();
        let mut room = MOST_BYTES;
        for (age, (_, size, path)) in files.into_iter().rev().enumerate() {
            match room.checked_sub(size).filter(|_| age + 1 < KEPT) {
                Some(left) => room = left,
                None => {
                    let _ = std::fs::remove_file(path);
                }
            }
        }
    }
}

impl SolutionStore for Folder {
    fn read(&self, key: &Key) -> Result<Option<Vec<u8>>, String> {
        match std::fs::read(self.file(key)) {
            Ok(bytes) => {
                // The file counts as used now. It is then not among the first files to be removed.
                let now = std::time::SystemTime::now();
                let file = std::fs::File::options().write(true).open(self.file(key));
                let _ = file.and_then(|f| f.set_modified(now));
                Ok(Some(bytes))
            }
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(e) => Err(format!("the stored solution cannot be read ({e})")),
        }
    }

    fn write(&self, key: &Key, bytes: Vec<u8>) -> Result<(), String> {
        let write = || -> std::io::Result<()> {
            std::fs::create_dir_all(&self.0)?;
            let file = self.file(key);
            half_written::remove_stale(&self.0);
            let name = format!("{}.solution", key.name());
            let part = self.0.join(half_written::name_of_part(&name, 0));
            half_written::note(&part);
            let done = std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, &file));
            if done.is_err() {
                let _ = std::fs::remove_file(&part);
            }
            half_written::forget(&part);
            done
        };
        write().map_err(|e| format!("`{}`: {e}", self.0.display()))?;
        self.forget_oldest();
        Ok(())
    }
}
