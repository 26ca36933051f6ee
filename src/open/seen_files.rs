//! Files of a session that other programs may change.

use crate::host::context::{Disk, Files};
use crate::host::fault::Fault;
use crate::host::whole_file::Stamp;
use crate::job::Job;
use crate::workflow::place::Plan;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Files of a session with their state when they were last read or written.
#[derive(Default)]
pub(super) struct SeenFiles(Mutex<Seen>);

#[derive(Default)]
struct Seen {
    stamps: BTreeMap<PathBuf, Option<Stamp>>,
    /// Files that this session wrote.
    written: BTreeSet<PathBuf>,
}

impl SeenFiles {
    fn lock(&self) -> MutexGuard<'_, Seen> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes the state of every file of a job and its plan.
    pub(super) fn note_all(&self, job: &Job, plan: &Plan) {
        let of_job = job.read.iter().map(|f| f.path.clone());
        let files = of_job.chain(plan.files().map(Path::to_owned)).chain([
            job.folder.join(job.picked_file()),
            job.folder.join(job.gauges_file()),
        ]);
        let stamps = files.map(|f| (f.clone(), Disk.stamp(&f).ok())).collect();
        self.lock().stamps = stamps;
    }

    /// Returns the names of files that changed since they were noted.
    pub(super) fn list_changed(&self) -> Vec<String> {
        let seen = self.lock();
        let changed = seen
            .stamps
            .iter()
            .filter(|(f, s)| Disk.stamp(f).ok() != **s);
        let names = changed.map(|(f, _)| f.file_name().unwrap_or(f.as_os_str()));
        names.map(|n| n.to_string_lossy().into_owned()).collect()
    }

    /// Notes a file that this session wrote.
    pub(super) fn note_written(&self, path: PathBuf) {
        let mut seen = self.lock();
        seen.stamps.insert(path.clone(), Disk.stamp(&path).ok());
        seen.written.insert(path);
    }

    /// Returns whether this session wrote a file.
    pub(super) fn has_written(&self, path: &Path) -> bool {
        self.lock().written.contains(path)
    }
}

/// The fault of files that another program changed.
pub(super) fn changed_files_fault(changed: &[String]) -> Fault {
    Fault::new(
        changed.join(", "),
        "file",
        "the file changed on disk since this session read it",
        "press `read again`, then repeat the change",
    )
}
