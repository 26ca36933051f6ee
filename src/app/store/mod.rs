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

/// Solutions kept in one folder; the oldest go first.
const KEPT: usize = 8;

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

    /// Solutions in `<name>.cache` beside a job or deck.
    pub fn beside(main_input: impl AsRef<Path>) -> Self {
        let main_input = main_input.as_ref();
        let mut name = main_input.file_stem().unwrap_or_default().to_owned();
        name.push(".cache");
        Self(main_input.with_file_name(name))
    }

    fn file(&self, key: &Key) -> PathBuf {
        self.0.join(format!("{}.solution", key.name()))
    }

    fn forget_oldest(&self) {
        let Ok(entries) = std::fs::read_dir(&self.0) else {
            return;
        };
        let mut files: Vec<(std::time::SystemTime, PathBuf)> = entries
            .filter_map(Result::ok)
            .filter(|e| e.path().extension().is_some_and(|x| x == "solution"))
            .filter_map(|e| Some((e.metadata().ok()?.modified().ok()?, e.path())))
            .collect();
        files.sort();
        let surplus = files.len().saturating_sub(KEPT);
        for (_, path) in files.into_iter().take(surplus) {
            let _ = std::fs::remove_file(path);
        }
    }
}

impl SolutionStore for Folder {
    fn read(&self, key: &Key) -> Result<Option<Vec<u8>>, String> {
        match std::fs::read(self.file(key)) {
            Ok(bytes) => Ok(Some(bytes)),
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
