//! Files under their temporary names, which an interrupted program removes before it ends.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

static FILES: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn files() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Records a file in progress.
pub fn note(part: &Path) {
    files().insert(part.to_owned());
}

/// Forgets a file that is complete or removed.
pub fn forget(part: &Path) {
    files().remove(part);
}

/// Folders in which stale files were looked for.
static CLEANED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Returns the temporary name of a file, the `n`-th of this process.
pub fn name_of_part(name: &str, n: u64) -> String {
    format!(".{name}.{}-{}-{n}.part", host(), std::process::id())
}

/// Returns the name of this machine and of the space of its process numbers, letters and digits; empty if the system states none. Containers with one
/// name and one folder have separate process numbers.
fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let space = std::fs::read_link("/proc/self/ns/pid").unwrap_or_default();
    let both = name + &space.to_string_lossy();
    both.chars().filter(|c| c.is_alphanumeric()).collect()
}

/// Removes the temporary files that killed runs of this machine left in a folder. A run of another machine may be in progress, and a system
/// without `/proc` does not state which runs have ended.
pub fn remove_stale(folder: &Path) {
    let mut cleaned = CLEANED.lock().unwrap_or_else(PoisonError::into_inner);
    if !cleaned.insert(folder.to_owned()) {
        return;
    }
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    let host = host();
    for entry in entries.flatten() {
        let name = entry.file_name();
        if name
            .to_str()
            .and_then(|n| writer_of(n, &host))
            .is_some_and(has_ended)
        {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Returns the process of this machine that wrote a temporary file.
fn writer_of(name: &str, host: &str) -> Option<u32> {
    let (_, tag) = name
        .strip_prefix('.')?
        .strip_suffix(".part")?
        .rsplit_once('.')?;
    let (tag, n) = tag.rsplit_once('-')?;
    n.parse::<u64>().ok()?;
    let (of, process) = tag.rsplit_once('-')?;
    process.parse().ok().filter(|_| of == host)
}

/// Returns whether a process of this machine is known to have ended.
fn has_ended(process: u32) -> bool {
    Path::new("/proc/self").exists() && !Path::new(&format!("/proc/{process}")).exists()
}

/// Removes the recorded files and prevents new ones. `end` ends the program.
pub fn remove_all_and(end: impl FnOnce()) {
    // The lock is held to the end, so that no new file begins.
    let files = files();
    for file in files.iter() {
        let _ = std::fs::remove_file(file);
    }
    end();
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No process has the largest number, because numbers on Linux are below 2^22.
    #[test]
    fn files_of_killed_runs_of_this_machine_are_removed_and_no_others() {
        if host().is_empty() {
            return;
        }
        let folder =
            std::env::temp_dir().join(format!("strainbridge-stale-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let dead = format!(".loads.bin.{}-{}-3.part", host(), u32::MAX);
        let kept = [
            name_of_part("loads.bin", 1),
            format!(".loads.bin.{}x-{}-3.part", host(), u32::MAX),
            "loads.bin.part".to_owned(),
            ".part".to_owned(),
        ];
        for name in kept.iter().chain([&dead]) {
            std::fs::write(folder.join(name), "x").unwrap();
        }
        remove_stale(&folder);
        assert!(!folder.join(&dead).exists());
        assert!(kept.iter().all(|name| folder.join(name).exists()));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
