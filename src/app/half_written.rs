//! Files under their temporary names: what an interrupted program removes before it ends.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

static FILES: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn files() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Notes a file that is being written.
pub fn note(part: &Path) {
    files().insert(part.to_owned());
}

/// Forgets a file that is complete or removed.
pub fn forget(part: &Path) {
    files().remove(part);
}

/// Removes the noted files and lets nothing more begin: the program ends by `end`.
pub fn remove_all_and(end: impl FnOnce()) {
    // Held to the end: nothing more is begun.
    let files = files();
    for file in files.iter() {
        let _ = std::fs::remove_file(file);
    }
    end();
}
