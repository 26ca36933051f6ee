//! Reading files: paths relative to a base, contents in memory, and the list of inputs with their hashes.

use crate::finding::{Finding, Severity};
use crate::host::context::Files;
use crate::host::fault::Fault;
use crate::host::file_read::FileRead;
use crate::host::sheet::{csv_of_sheet, is_sheet};
use crate::host::what_is::no_table;
pub use crate::host::whole_file::{FileBytes, OpenedFile, Stamp};
use crate::series::record::csv::{Layout, is_cut, unsure_end};
#[cfg(feature = "parquet")]
use crate::series::record::runs_as_csv;
use crate::series::record::{format_of, is_format};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;

/// A file that was read, as listed in `result.json`.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Input {
    /// Path as given, by the user or by the job.
    pub path: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// The files that one question read, in order. A separate thread computes the hashes.
pub struct Inputs<'a> {
    files: &'a dyn Files,
    entries: Vec<(String, PathBuf, PendingDigest)>,
    /// Tables named by the job whose last line may be cut.
    unsure: BTreeMap<String, Severity>,
    /// Findings on tables, other than on their ends, each with its table.
    noted: Vec<(String, Finding)>,
    /// Tables that were read, so that a second question on a table reads the same bytes.
    kept: BTreeMap<PathBuf, FileBytes>,
}

/// Bytes of tables that are kept at most: tables of runs and gauges are far smaller, records far larger.
const KEPT: usize = 32 << 20;

enum PendingDigest {
    Running(JoinHandle<String>),
    Done(String),
}

impl PendingDigest {
    /// The digest, waited for.
    fn finish(&mut self) -> String {
        let hex = match std::mem::replace(self, PendingDigest::Done(String::new())) {
            PendingDigest::Done(hex) => hex,
            PendingDigest::Running(thread) => thread.join().unwrap_or_default(),
        };
        *self = PendingDigest::Done(hex.clone());
        hex
    }
}

impl<'a> Inputs<'a> {
    /// Returns inputs with these files. None of them has been read yet.
    pub fn new(files: &'a dyn Files) -> Self {
        Self {
            files,
            entries: Vec::new(),
            unsure: BTreeMap::new(),
            noted: Vec::new(),
            kept: BTreeMap::new(),
        }
    }

    /// Continues with files that were read before, such as the job with its tables.
    pub fn resume(files: &'a dyn Files, read: &[FileRead]) -> Self {
        let entry = |f: &FileRead| {
            let done = PendingDigest::Done(f.sha256.clone());
            (f.given.clone(), f.path.clone(), done)
        };
        let noted = |f: &FileRead| {
            let findings = f.noted.clone().into_iter();
            let given = f.given.clone();
            findings.map(move |finding| (given.clone(), finding))
        };
        let unsure = read
            .iter()
            .filter_map(|f| Some((f.given.clone(), f.unsure?)));
        Self {
            files,
            entries: read.iter().map(entry).collect(),
            unsure: unsure.collect(),
            noted: read.iter().flat_map(noted).collect(),
            kept: BTreeMap::new(),
        }
    }

    /// Returns the files that were read, with complete hashes, so that another command can continue with them.
    pub fn files_read(&mut self) -> Vec<FileRead> {
        let entries = self.entries.iter_mut();
        entries
            .map(|(given, path, hashing)| FileRead {
                given: given.clone(),
                path: path.clone(),
                sha256: hashing.finish(),
                unsure: self.unsure.get(given).copied(),
                noted: of_table(&self.noted, given),
            })
            .collect()
    }

    /// Reads the bytes of a file by its path alone.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn load(&self, path: &Path) -> std::io::Result<FileBytes> {
        self.files.load(path)
    }

    /// Reads the bytes of the file `given`, which is relative to `base`.
    ///
    /// # Errors
    /// A fault of the file itself if it cannot be read.
    pub fn read(&mut self, base: &Path, given: &str) -> Result<FileBytes, Fault> {
        let path = base.join(given);
        if let Some(bytes) = self.kept.get(&path) {
            return Ok(bytes.clone());
        }
        let bytes = self
            .files
            .load(&path)
            .map_err(|e| unreadable_file_fault(given, &e))?;
        self.keep(given, &path, &bytes);
        self.record(given, path, &bytes);
        Ok(bytes)
    }

    /// Keeps a table while there is room.
    fn keep(&mut self, given: &str, path: &Path, bytes: &FileBytes) {
        let held: usize = self.kept.values().map(|b| b.len()).sum();
        let fits = held.saturating_add(bytes.len()) <= KEPT;
        if fits && (is_table(given) || is_sheet(bytes)) && !is_format(bytes) {
            self.kept.insert(path.to_owned(), bytes.clone());
        }
    }

    /// Reads the text of the file `given`, which is relative to `base`. It drops a byte order mark and converts the first sheet of a spreadsheet to
    /// CSV text.
    ///
    /// # Errors
    /// A fault if the file cannot be read or is not UTF-8.
    pub fn read_text(&mut self, base: &Path, given: &str) -> Result<String, Fault> {
        let bytes = self.table_bytes(base, given)?;
        match std::str::from_utf8(&bytes) {
            Ok(text) => Ok(text.strip_prefix('\u{feff}').unwrap_or(text).to_owned()),
            Err(_) => Err(no_text(given, &bytes)),
        }
    }

    /// Returns the bytes of a table of text.
    pub(crate) fn table_bytes(&mut self, base: &Path, given: &str) -> Result<FileBytes, Fault> {
        let bytes = as_table(given, self.read(base, given)?)?;
        if let Some(format) = format_of(&bytes) {
            let remedy = "name a table of text or a spreadsheet";
            return Err(Fault::new(
                given,
                "file",
                format!("it is {}, not a table", format.words()),
                remedy,
            ));
        }
        Ok(bytes)
    }

    /// Records a table whose last line may be cut.
    pub(crate) fn note_end(&mut self, given: &str, read: Option<&impl AsRef<[u8]>>) {
        if let Some(bytes) = read.filter(|_| is_table(given))
            && !is_format(bytes.as_ref())
            && unsure_end(bytes.as_ref()).is_some()
        {
            // A record is read without its last line.
            let is_record = || Layout::detect(bytes.as_ref()).is_ok_and(|l| l.is_record());
            let severity = match is_cut(bytes.as_ref()) && !is_record() {
                true => Severity::Error,
                false => Severity::Warning,
            };
            self.unsure.insert(given.to_owned(), severity);
        }
    }

    /// Adds a finding on a table, once.
    pub fn note(&mut self, table: &str, finding: Finding) {
        let entry = (table.to_owned(), finding);
        if !self.noted.contains(&entry) {
            self.noted.push(entry);
        }
    }

    /// Returns a finding for each table whose last line may be cut, and the recorded findings.
    pub fn findings(&self) -> Vec<Finding> {
        let unsure = self.unsure.iter();
        let noted = self.noted.iter().map(|n| n.1.clone());
        unsure
            .map(|(file, severity)| may_be_cut(file, *severity))
            .chain(noted)
            .collect()
    }

    /// Adds a file that other code read to the list of inputs.
    pub fn record(&mut self, given: &str, path: PathBuf, bytes: &FileBytes) {
        if self.entries.iter().any(|e| e.1 == path) {
            return;
        }
        const SMALL: usize = 1 << 20;
        let hashing = if bytes.len() <= SMALL {
            PendingDigest::Done(sha256_hex(bytes))
        } else {
            let bytes = bytes.clone();
            PendingDigest::Running(std::thread::spawn(move || sha256_hex(&bytes)))
        };
        self.entries.push((given.to_owned(), path, hashing));
    }

    /// Returns the SHA-256 of a file by the path from which it was read.
    pub fn digest_of(&mut self, path: &Path) -> Option<String> {
        let entry = self.entries.iter_mut().find(|e| e.1 == path)?;
        Some(entry.2.finish()).filter(|hex| !hex.is_empty())
    }

    /// Returns the paths of the files.
    pub fn paths(&self) -> Vec<PathBuf> {
        self.entries.iter().map(|e| e.1.clone()).collect()
    }

    /// Returns the list of files with all hashes.
    pub fn list(&mut self) -> Vec<Input> {
        self.entries
            .iter_mut()
            .map(|(path, _, hashing)| Input {
                path: path.replace('\\', "/"),
                sha256: hashing.finish(),
            })
            .collect()
    }
}

/// Returns the bytes of a table or a record. For a spreadsheet, these bytes are the CSV text of the first sheet.
///
/// # Errors
/// A file that is neither a table nor a record.
pub(crate) fn as_table(given: &str, bytes: FileBytes) -> Result<FileBytes, Fault> {
    if let Some(kind) = no_table(&bytes) {
        let wrong = format!("it is {kind}, neither a table nor a record");
        let remedy = "name a CSV or XLSX table, or a record (CSV, RPC III, Parquet, Feather, TDMS, UFF, MDF4)";
        return Err(Fault::new(given, "file", wrong, remedy));
    }
    if let Some(text) = runs_in_columns(given, &bytes)? {
        return Ok(text.into_bytes().into());
    }
    if !is_sheet(&bytes) {
        return Ok(bytes);
    }
    let text = csv_of_sheet(&bytes);
    text.map(|text| text.into_bytes().into())
        .map_err(|wrong| Fault::new(given, "sheet", wrong, "save the sheet as CSV (UTF-8)"))
}

/// Returns the table of runs in a Parquet or Feather file as CSV text; `None` for another file.
#[cfg(feature = "parquet")]
fn runs_in_columns(given: &str, bytes: &FileBytes) -> Result<Option<String>, Fault> {
    let read = runs_as_csv(std::sync::Arc::new(bytes.clone()));
    read.map_err(|e| {
        let (wrong, remedy) = e.parts();
        Fault::new(given, "record", wrong, remedy)
    })
}

/// Returns `None`: this build reads neither Parquet nor Feather.
#[cfg(not(feature = "parquet"))]
fn runs_in_columns(_: &str, _: &FileBytes) -> Result<Option<String>, Fault> {
    Ok(None)
}

/// Returns the fault of a file that is not text, at the first line that is not.
pub(crate) fn no_text(given: &str, bytes: &[u8]) -> Fault {
    let valid = std::str::from_utf8(bytes).map_or_else(|e| e.valid_up_to(), str::len);
    let before = bytes.get(..valid).unwrap_or_default();
    let line = 1 + before.iter().filter(|b| **b == b'\n').count() as u32;
    let remedy = "save the file as UTF-8 text";
    Fault::with_line(given, line, "text", "not UTF-8", remedy)
}

/// Returns the findings recorded for a table.
fn of_table(noted: &[(String, Finding)], given: &str) -> Vec<Finding> {
    let of = noted.iter().filter(|n| n.0 == given);
    of.map(|n| n.1.clone()).collect()
}

/// Returns whether a file is a table of text, by its name.
fn is_table(given: &str) -> bool {
    let name = given.to_ascii_lowercase();
    [".csv", ".tsv", ".txt"].iter().any(|e| name.ends_with(e))
}

/// Returns the finding of a table, or a record, whose last line may be cut.
pub(crate) fn may_be_cut(file: &str, severity: Severity) -> Finding {
    let (message, remedy) = match severity {
        Severity::Error => (
            "its last line has no end, and its last number lacks digits, a point or an exponent that the others of its column have: the file is cut, and this number is wrong",
            "copy the file again, or end its last line",
        ),
        Severity::Warning | Severity::Info => (
            "its last line has no end, and its last number may have lost digits: a record is read without that line, any other table with it",
            "copy the file again if it is cut; otherwise end its last line",
        ),
    };
    Finding::new(severity, "table-may-be-cut", file, message, remedy)
}

pub(crate) fn unreadable_file_fault(given: &str, e: &std::io::Error) -> Fault {
    let (mut wrong, mut remedy) = why_unreadable(e);
    // A name in another encoding, such as cp1252 of Windows, arrives with this sign in place of each byte that is not UTF-8.
    if e.kind() == std::io::ErrorKind::NotFound && given.contains('\u{fffd}') {
        "the name of the file or of its folder is not UTF-8".clone_into(&mut wrong);
        remedy =
            "rename it: `convmv -f cp1252 -t utf8 --notest NAME`, or without letters such as ä";
    }
    Fault::new(given, "file", wrong, remedy)
}

/// Returns the reason why a file cannot be read, and the remedy.
pub(crate) fn why_unreadable(e: &std::io::Error) -> (String, &'static str) {
    match e.kind() {
        std::io::ErrorKind::NotFound => (
            "no such file".to_owned(),
            "check the path; paths in a job are relative to the job file",
        ),
        std::io::ErrorKind::PermissionDenied => (
            "no permission to read it".to_owned(),
            "check the file's permissions",
        ),
        std::io::ErrorKind::IsADirectory => ("it is a folder".to_owned(), "name a file in it"),
        std::io::ErrorKind::InvalidInput => (
            "it is a device, a pipe or a socket, not a file".to_owned(),
            "write its data into a file",
        ),
        std::io::ErrorKind::ResourceBusy => (
            "it changed while it was read".to_owned(),
            "wait until the program that writes it has finished",
        ),
        std::io::ErrorKind::OutOfMemory => (
            "it is larger than the free memory".to_owned(),
            "divide the file, or use a larger machine",
        ),
        _ => (format!("it cannot be read ({e})"), "check the path"),
    }
}

pub(crate) fn sha256_hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .map(|b| format!("{b:02x}"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Counts its calls.
    struct CountingFiles(AtomicUsize, Vec<u8>);

    impl Files for CountingFiles {
        fn load(&self, _: &Path) -> std::io::Result<FileBytes> {
            self.0.fetch_add(1, Ordering::Relaxed);
            Ok(self.1.clone().into())
        }
    }

    #[test]
    fn a_table_is_loaded_once_and_what_is_no_table_or_too_large_is_not_kept() {
        for (given, size, loads) in [
            ("runs.csv", 100, 1),
            ("model.op2", 100, 3),
            ("record.csv", KEPT + 1, 3),
        ] {
            let files = CountingFiles(AtomicUsize::new(0), vec![b'1'; size]);
            let mut inputs = Inputs::new(&files);
            for _ in 0..3 {
                assert_eq!(inputs.read(Path::new("a"), given).unwrap().len(), size);
            }
            assert_eq!(files.0.load(Ordering::Relaxed), loads, "{given}");
            assert_eq!(inputs.list().len(), 1);
        }
    }
}
