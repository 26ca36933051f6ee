//! Store of solutions of the built-in solver between questions.
//!
//! The key is the SHA-256 of everything a solution depends on: contents of the files, load cases, version, sources, dependencies and
//! features of the program. A changed deck or load finds nothing.

mod folder;
mod key;
mod solution_file;

#[cfg(test)]
mod tests;

pub use folder::Folder;
pub use key::Key;

use crate::fe::DisplacementSolution;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Store of solutions, as bytes under a key. A store is a handle: its clones share the stored solutions.
pub trait SolutionStore: Send + Sync {
    /// Returns the bytes kept under a key; `None` if no bytes are kept.
    ///
    /// # Errors
    /// Reason why the bytes cannot be read.
    fn read(&self, key: &Key) -> Result<Option<Vec<u8>>, String>;

    /// Keeps bytes under a key.
    ///
    /// # Errors
    /// Reason why the bytes cannot be kept.
    fn write(&self, key: &Key, bytes: Vec<u8>) -> Result<(), String>;
}

/// Reads the solution under a key; `None` if the store has none under it.
///
/// # Errors
/// The reason why a stored solution cannot be used.
pub(crate) fn read_solution(
    store: &dyn SolutionStore,
    key: &Key,
    grids: usize,
    cases: usize,
) -> Result<Option<DisplacementSolution>, String> {
    let Some(bytes) = store.read(key)? else {
        return Ok(None);
    };
    solution_file::decode(&bytes, key, grids, cases)
        .map(Some)
        .ok_or_else(|| "the stored solution is damaged".to_owned())
}

/// Stores a solution.
///
/// # Errors
/// Reason why the solution cannot be kept.
pub(crate) fn write_solution(
    store: &dyn SolutionStore,
    key: &Key,
    solved: &DisplacementSolution,
) -> Result<(), String> {
    store.write(key, solution_file::encode(solved, key))
}

/// Store in memory. Solutions exist as long as this value or one of its clones.
#[derive(Clone, Debug, Default)]
pub struct Memory(Arc<Mutex<HashMap<Key, Vec<u8>>>>);

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
