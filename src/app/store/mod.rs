//! Where solutions of the built-in solver are kept between questions.
//!
//! The key is the SHA-256 of everything a solution depends on: contents of the files, load cases, version, commit and features of the
//! program. A changed deck or load finds nothing.

mod key;
mod solution_file;

#[cfg(test)]
mod tests;

pub use key::Key;

use super::half_written;
use crate::fe::Solved;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Solutions kept in one folder; those not used for longest go first.
const KEPT: usize = 64;
/// Their bytes.
const MOST_BYTES: u64 = 4 << 30;

/// Where solutions are kept, as bytes under a key.
pub trait SolutionStore: Sync {
    /// The bytes kept under a key; `None` where there are none.
    ///
    /// # Errors
    /// Why what is there can't be read.
    fn read(&self, key: &Key) -> Result<Option<Vec<u8>>, String>;

    /// Keeps bytes under a key.
    ///
    /// # Errors
    /// Why they can't be kept.
    fn write(&self, key: &Key, bytes: Vec<u8>) -> Result<(), String>;
}

/// The solution under a key; `None` where there is none.
///
/// # Errors
/// Why what is there can't be used.
pub(super) fn read_solution(
    store: &dyn SolutionStore,
    key: &Key,
    grids: usize,
    cases: usize,
) -> Result<Option<Solved>, String> {
    let Some(bytes) = store.read(key)? else {
        return Ok(None);
    };
    solution_file::decode(&bytes, key, grids, cases)
        .map(Some)
        .ok_or_else(|| "the kept solution is damaged".to_owned())
}

/// Keeps a solution.
///
/// # Errors
/// Why it can't be kept.
pub(super) fn write_solution(
    store: &dyn SolutionStore,
    key: &Key,
    solved: &Solved,
) -> Result<(), String> {
    store.write(key, solution_file::encode(solved, key))
}

/// A folder of the file system: `<key>.solution`, a few at most.
#[derive(Clone, Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// Solutions in this folder, which is made when the first is kept.
    pub fn at(folder: impl Into<PathBuf>) -> Self {
        Self(folder.into())
    }

    /// Solutions in the user's folder for caches: `STRAINBRIDGE_CACHE`, else `strainbridge` in `XDG_CACHE_HOME`, in the system's place for
    /// caches, or in that for temporary files.
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

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Removes every kept solution of the folder, and the folder where that leaves it empty: how many, and their bytes.
    ///
    /// # Errors
    /// The first that can't be removed.
    pub fn clean(&self) -> std::io::Result<(usize, u64)> {
        let (mut n, mut bytes) = (0, 0);
        for (_, size, path) in self.kept() {
            std::fs::remove_file(path)?;
            n += 1;
            bytes += size;
        }
        // Refused where something else stands in it.
        let _ = std::fs::remove_dir(&self.0);
        Ok((n, bytes))
    }

    /// Kept solutions, the oldest use first: when, bytes, file.
    fn kept(&self) -> Vec<(std::time::SystemTime, u64, PathBuf)> {
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
        let mut files = self.kept();
        // The one just kept stays, however large.
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
                // Used now: so it is not among the first to go.
                let now = std::time::SystemTime::now();
                let file = std::fs::File::options().write(true).open(self.file(key));
                let _ = file.and_then(|f| f.set_modified(now));
                Ok(Some(bytes))
            }
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(e) => Err(format!("the kept solution can't be read ({e})")),
        }
    }

    fn write(&self, key: &Key, bytes: Vec<u8>) -> Result<(), String> {
        let write = || -> std::io::Result<()> {
            std::fs::create_dir_all(&self.0)?;
            let file = self.file(key);
            let part = file.with_extension(format!("{}.part", std::process::id()));
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

/// Memory: solutions live as long as this value.
#[derive(Debug, Default)]
pub struct Memory(Mutex<HashMap<Key, Vec<u8>>>);

impl SolutionStore for Memory {
    fn read(&self, key: &Key) -> Result<Option<Vec<u8>>, String> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(kept.get(key).cloned())
    }

    fn write(&self, key: &Key, bytes: Vec<u8>) -> Result<(), String> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.insert(*key, bytes);
        Ok(())
    }
}
