//! Files on the disk, and files in memory with paths.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use strainbridge::Disk;
use strainbridge::host::context::Files;
use strainbridge::host::files::{FileBytes, OpenedFile, Stamp};

/// The disk, with files in memory that have priority.
#[derive(Clone, Debug, Default)]
pub(crate) struct Desk(pub BTreeMap<PathBuf, Vec<u8>>);

impl Files for Desk {
    fn load(&self, path: &Path) -> std::io::Result<FileBytes> {
        match self.0.get(path) {
            Some(bytes) => Ok(FileBytes::from(bytes.clone())),
            None => Disk.load(path),
        }
    }

    fn open(&self, path: &Path) -> std::io::Result<OpenedFile> {
        match self.0.get(path) {
            Some(bytes) => Ok(OpenedFile::Whole(FileBytes::from(bytes.clone()))),
            None => Disk.open(path),
        }
    }

    fn stamp(&self, path: &Path) -> std::io::Result<Stamp> {
        match self.0.get(path) {
            Some(bytes) => Ok(Stamp {
                size: bytes.len() as u64,
                written_ns: None,
            }),
            None => Disk.stamp(path),
        }
    }
}
