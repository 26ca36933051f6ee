//! Reading of a whole file into memory, or in parts, and the possible errors.
//!
//! Files are read, not mapped. If another program shortens a mapped file, a signal ends this program. If another program rewrites it, half of the
//! numbers are old and half are new. Reading costs a copy, a third of a second for each gigabyte.

use crate::series::record::{Parts, Source, is_read_in_parts};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::UNIX_EPOCH;

/// Bytes hashed at a time: they are still in the processor's nearer cache.
const PART: usize = 1 << 17;

/// Bytes of a file in memory. Later changes of the file by another program have no effect on these bytes.
#[derive(Clone)]
pub struct FileBytes(Arc<Vec<u8>>);

impl From<Vec<u8>> for FileBytes {
    fn from(bytes: Vec<u8>) -> Self {
        Self(Arc::new(bytes))
    }
}

impl AsRef<[u8]> for FileBytes {
    fn as_ref(&self) -> &[u8] {
        self
    }
}

impl std::ops::Deref for FileBytes {
    type Target = [u8];
    fn deref(&self) -> &[u8] {
        &self.0
    }
}

/// Reads the bytes of a file.
///
/// # Errors
/// Errors of the system, and errors of these kinds:
/// - [`ErrorKind::IsADirectory`] for a folder, [`ErrorKind::InvalidInput`] for a device, pipe or socket, which may never end;
/// - [`ErrorKind::OutOfMemory`] for a file larger than the free memory;
/// - [`ErrorKind::ResourceBusy`] for a file that changed during reading.
pub fn load(path: &Path) -> std::io::Result<FileBytes> {
    rest_of(open_file(path)?)
}

/// Bytes of a file of which the first may have been read.
fn rest_of((file, before, mut bytes): (File, Metadata, Vec<u8>)) -> std::io::Result<FileBytes> {
    let left = before.len().saturating_sub(bytes.len() as u64);
    (&file).take(left).read_to_end(&mut bytes)?;
    if bytes.len() as u64 != before.len() || differs(&before, &file.metadata()?) {
        return Err(ErrorKind::ResourceBusy.into());
    }
    Ok(bytes.into())
}

/// A file that is open.
pub enum OpenedFile {
    /// Bytes, in memory.
    Whole(FileBytes),
    /// One whose format is [read in parts](is_read_in_parts).
    Parts(Arc<InParts>),
}

impl OpenedFile {
    /// Returns the source from which a record is opened.
    pub fn source(&self) -> Source {
        match self {
            Self::Whole(bytes) => Source::Memory(Arc::new(bytes.clone())),
            Self::Parts(file) => Source::File(file.clone()),
        }
    }

    /// SHA-256 of its bytes, hexadecimal.
    ///
    /// # Errors Kind [`ErrorKind::ResourceBusy`] if the file was shortened after it was opened. An error if a part could not be read.
    pub fn sha256(&self) -> std::io::Result<String> {
        let file = match self {
            Self::Whole(bytes) => return Ok(hex(&Sha256::digest(&**bytes))),
            Self::Parts(file) => file,
        };
        let (mut hash, size) = (Sha256::new(), file.size());
        let (mut part, mut from) = (vec![0; PART], 0);
        while from < size {
            let n = PART.min(usize::try_from(size - from).unwrap_or(PART));
            let part = part.get_mut(..n).unwrap_or_default();
            fill_from_file(&file.file, from, part).map_err(cut_meanwhile)?;
            hash.update(part);
            from += n as u64;
        }
        Ok(hex(&hash.finalize()))
    }

    /// Checks that all requested bytes were read, and that all are from one state of the file.
    ///
    /// # Errors Kind [`ErrorKind::ResourceBusy`] if the file was written to after it was opened. An error if a part could not be read.
    pub fn check(&self) -> std::io::Result<()> {
        let Self::Parts(file) = self else {
            return Ok(());
        };
        if file.failed.load(Ordering::Relaxed) {
            return Err(Error::other("a part of it could not be read"));
        }
        if differs(&file.before, &file.file.metadata()?) {
            return Err(ErrorKind::ResourceBusy.into());
        }
        Ok(())
    }
}

/// A file that is read in parts, each part by the code that needs it. The file stays open, so a change of its path has no effect.
pub struct InParts {
    file: File,
    before: Metadata,
    /// A part of it could not be read.
    failed: AtomicBool,
}

impl Parts for InParts {
    fn size(&self) -> u64 {
        self.before.len()
    }

    fn read_at(&self, from: u64, out: &mut [u8]) -> std::io::Result<()> {
        let read = fill_from_file(&self.file, from, out);
        if read.is_err() {
            self.failed.store(true, Ordering::Relaxed);
        }
        read
    }
}

/// Fills `out` from a place of a file, many threads at a time.
fn fill_from_file(file: &File, mut from: u64, mut out: &mut [u8]) -> std::io::Result<()> {
    while !out.is_empty() {
        #[cfg(windows)]
        let read = std::os::windows::fs::FileExt::seek_read(file, out, from);
        #[cfg(unix)]
        let read = std::os::unix::fs::FileExt::read_at(file, out, from);
        match read {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(n) => {
                out = out.get_mut(n..).unwrap_or_default();
                from += n as u64;
            }
            Err(e) if e.kind() == ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(())
}

/// Opens a file. Its bytes are in memory unless its format is [read in parts](is_read_in_parts).
///
/// # Errors
/// The errors of [`load`].
pub fn open(path: &Path) -> std::io::Result<OpenedFile> {
    // The check precedes the opening, because opening a pipe waits for its writer.
    check_kind(&std::fs::metadata(path)?)?;
    let mut file = File::open(path)?;
    let before = file.metadata()?;
    check_kind(&before)?;
    let mut begin = Vec::new();
    (&mut file).take(8).read_to_end(&mut begin)?;
    if !is_read_in_parts(&begin) {
        return load(path).map(OpenedFile::Whole);
    }
    Ok(OpenedFile::Parts(Arc::new(InParts {
        file,
        before,
        failed: AtomicBool::new(false),
    })))
}

fn cut_meanwhile(e: Error) -> Error {
    match e.kind() {
        ErrorKind::UnexpectedEof => ErrorKind::ResourceBusy.into(),
        _ => e,
    }
}

/// Returns a digest as hexadecimal text.
pub fn hex(digest: &[u8]) -> String {
    digest.iter().map(|b| format!("{b:02x}")).collect()
}

/// Opens a file; returns it with its metadata, and room for its bytes.
fn open_file(path: &Path) -> std::io::Result<(File, Metadata, Vec<u8>)> {
    // The check precedes the opening, because opening a pipe waits for its writer.
    check_kind(&std::fs::metadata(path)?)?;
    let file = File::open(path)?;
    let before = file.metadata()?;
    check_kind(&before)?;
    let size = before.len();
    if free_memory().is_some_and(|free| size > free) {
        return Err(ErrorKind::OutOfMemory.into());
    }
    let room = usize::try_from(size).map_err(|_| ErrorKind::OutOfMemory)?;
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(room)
        .map_err(|_| ErrorKind::OutOfMemory)?;
    Ok((file, before, bytes))
}

fn check_kind(meta: &Metadata) -> std::io::Result<()> {
    if meta.is_dir() {
        Err(ErrorKind::IsADirectory.into())
    } else if meta.is_file() {
        Ok(())
    } else {
        Err(Error::from(ErrorKind::InvalidInput))
    }
}

/// State of a file as the system reports it. It changes with each write. It is determined without reading the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// Length of the file, bytes.
    pub size: u64,
    /// Time of the last change, in nanoseconds since 1970; `None` if the system does not keep it.
    pub written_ns: Option<u64>,
}

impl From<&Metadata> for Stamp {
    fn from(meta: &Metadata) -> Self {
        let since = meta.modified().ok();
        let since = since.and_then(|t| t.duration_since(UNIX_EPOCH).ok());
        Self {
            size: meta.len(),
            written_ns: since.and_then(|t| u64::try_from(t.as_nanos()).ok()),
        }
    }
}

/// Returns whether the size or the time of the last write of a file differs between two checks.
fn differs(before: &Metadata, after: &Metadata) -> bool {
    Stamp::from(before) != Stamp::from(after)
}

/// Returns the memory that is available without swapping; `None` if `/proc/meminfo` does not state it.
fn free_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    kib.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn scratch(name: &str) -> std::path::PathBuf {
        std::env::temp_dir().join(format!("whole_file_{}_{name}", std::process::id()))
    }

    #[test]
    fn a_file_is_read_as_it_is_and_an_empty_one_is_empty() {
        let path = scratch("plain");
        for bytes in [vec![], vec![7_u8; 3_000_000]] {
            std::fs::write(&path, &bytes).unwrap();
            assert!(*load(&path).unwrap() == *bytes);
            let read = open(&path).unwrap();
            let hash = read.sha256().unwrap();
            assert!(matches!(read, OpenedFile::Whole(_)));
            let whole = read.source().read_all().unwrap();
            assert!((*whole).as_ref() == bytes.as_slice());
            assert_eq!(hash, hex(&Sha256::digest(&bytes)));
        }
        std::fs::remove_file(&path).unwrap();
    }

    #[cfg(feature = "parquet")]
    #[test]
    fn a_file_in_parts_has_the_digest_of_the_whole_and_is_refused_once_it_changed() {
        let path = scratch("parts");
        let bytes: Vec<u8> = b"PAR1"
            .iter()
            .copied()
            .chain((0..3_000_000_u32).map(|i| i as u8))
            .collect();
        std::fs::write(&path, &bytes).unwrap();
        let read = open(&path).unwrap();
        let hash = read.sha256().unwrap();
        assert_eq!(hash, hex(&Sha256::digest(&bytes)));
        let OpenedFile::Parts(file) = &read else {
            panic!("read whole")
        };
        let mut part = [0; 5];
        file.read_at(2_000_000, &mut part).unwrap();
        assert_eq!(part, bytes[2_000_000..2_000_005]);
        assert!(read.check().is_ok());
        std::fs::write(&path, &bytes[..100]).unwrap();
        assert_eq!(read.check().unwrap_err().kind(), ErrorKind::ResourceBusy);
        assert!(file.read_at(2_000_000, &mut part).is_err());
        assert_eq!(read.check().unwrap_err().kind(), ErrorKind::Other);
        std::fs::remove_file(&path).unwrap();
    }

    #[test]
    fn folders_and_devices_are_refused_and_a_pipe_is_not_waited_for() {
        let kind = |path: &Path| load(path).err().map(|e| e.kind());
        assert_eq!(kind(&std::env::temp_dir()), Some(ErrorKind::IsADirectory));
        assert_eq!(kind(&scratch("gone")), Some(ErrorKind::NotFound));
        if cfg!(unix) {
            assert_eq!(kind(Path::new("/dev/zero")), Some(ErrorKind::InvalidInput));
            let pipe = scratch("pipe");
            let made = std::process::Command::new("mkfifo").arg(&pipe).status();
            if made.is_ok_and(|s| s.success()) {
                assert_eq!(kind(&pipe), Some(ErrorKind::InvalidInput));
                std::fs::remove_file(&pipe).unwrap();
            }
        }
    }

    #[test]
    fn a_file_that_is_cut_or_written_anew_while_it_is_read_is_refused() {
        const SIZE: usize = 1 << 20;
        let path = scratch("changing");
        let changes: [(&str, &dyn Fn()); 4] = [
            ("cut to nothing", &|| drop(File::create(&path).unwrap())),
            ("cut to a part", &|| {
                std::fs::write(&path, vec![2; SIZE * 3 / 4]).unwrap()
            }),
            ("as long as before", &|| {
                std::fs::write(&path, vec![2; SIZE]).unwrap()
            }),
            ("longer", &|| {
                let mut file = File::options().append(true).open(&path).unwrap();
                file.write_all(&[1]).unwrap();
            }),
        ];
        for read in [0, SIZE / 2, SIZE] {
            for (what, change) in changes {
                std::fs::write(&path, vec![1_u8; SIZE]).unwrap();
                let (file, before, mut bytes) = open_file(&path).unwrap();
                (&file).take(read as u64).read_to_end(&mut bytes).unwrap();
                // This exceeds the clock tick of the file system, so that every state has a different time.
                std::thread::sleep(std::time::Duration::from_millis(20));
                change();
                let loaded = rest_of((file, before, bytes)).map(|_| ());
                let kind = loaded.expect_err(what).kind();
                assert_eq!(kind, ErrorKind::ResourceBusy, "{what}, {read} bytes read");
            }
            std::fs::write(&path, vec![1_u8; SIZE]).unwrap();
            let (file, before, mut bytes) = open_file(&path).unwrap();
            (&file).take(read as u64).read_to_end(&mut bytes).unwrap();
            assert!(*rest_of((file, before, bytes)).unwrap() == vec![1; SIZE]);
        }
        std::fs::remove_file(&path).unwrap();
    }
}
