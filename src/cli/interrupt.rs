//! Ctrl-C leaves no incomplete files: the program removes the files in progress before it ends.

use crate::host::half_written;

/// Exit code of a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

/// Installs a handler that removes the files in progress on Ctrl-C, before the program ends. If no handler can be installed, the next run replaces
/// these files.
pub(super) fn watch() {
    let _ = ctrlc::set_handler(|| half_written::remove_all_and(|| std::process::exit(INTERRUPTED)));
}
