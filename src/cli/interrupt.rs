//! Ctrl-C leaves no half files: what is being written is removed, then the program ends.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Exit code of a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

/// Files under their temporary names.
static HALF_WRITTEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn half_written() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    HALF_WRITTEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Notes a file that is being written.
pub(super) fn note(part: &Path) {
    half_written().insert(part.to_owned());
}

/// Forgets a file that is complete or removed.
pub(super) fn forget(part: &Path) {
    half_written().remove(part);
}

/// From here on Ctrl-C removes the noted files before the program ends. Where no handler can be had, the next run replaces them.
pub(super) fn watch() {
    let _ = ctrlc::set_handler(|| {
        // Held to the end: nothing more is begun.
        let files = half_written();
        for file in files.iter() {
            let _ = std::fs::remove_file(file);
        }
        std::process::exit(INTERRUPTED);
    });
}
