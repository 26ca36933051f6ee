//! Ctrl-C leaves no half files: what is being written is removed, then the program ends.

use crate::host::half_written;

/// Exit code of a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

/// From here on Ctrl-C removes the noted files before the program ends. Where no handler can be had, the next run replaces them.
pub(super) fn watch() {
    let _ = ctrlc::set_handler(|| half_written::remove_all_and(|| std::process::exit(INTERRUPTED)));
}
