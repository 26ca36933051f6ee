//! Results of single files, kept in the output folder by what they depend on.

use super::day::{Day, DayHead, FileHead, FileResult};
use super::requested_records::{ASKED, RequestedRecords};
use crate::host::whole_file::{Stamp, hex};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Folder of the stored results within the output folder.
pub const FOLDER: &str = "days";
/// Number of the form of a stored result, raised when its meaning changes.
const FORM: u32 = 11;
/// Text before the digest at the end of a stored result.
const SEAL: &[u8] = b",\"content\":\"";

/// Stored result; `D` is the part of its day that is read.
#[derive(Serialize, Deserialize)]
struct StoredResult<D> {
    form: u32,
    version: String,
    /// Digest of the inputs that the result of a record depends on, without the bytes of the record.
    job: String,
    path: String,
    sha256: String,
    /// Size and time of the file when its bytes were read.
    stamp: Option<Stamp>,
    vehicle: String,
    day: String,
    done: Option<D>,
    failed: Option<String>,
}

/// Identity of a stored result, which is readable for other forms too.
#[derive(Deserialize)]
struct Whose {
    form: u32,
    version: String,
    job: String,
}

/// Kind of a file in the folder.
enum StoredFileKind {
    Own(FileHead),
    /// Result of another job, version or form.
    Other,
    /// File that can't be read, or whose content has changed.
    Damaged,
}

/// Stored results of one job.
pub struct KeptDays {
    folder: PathBuf,
    job: String,
}

/// Content of a folder of stored results.
#[derive(Default)]
pub struct ResultFolderContent {
    /// Files of this job, by path.
    pub files: Vec<FileHead>,
    /// Results of another job, version or form.
    pub others: usize,
    /// Paths of stored results that can't be read, or whose content has changed.
    pub damaged: Vec<String>,
    /// Records requested by runs of this job.
    pub asked: Vec<RequestedRecords>,
}

/// Adds the digest of a stored result at its end; the result remains valid JSON.
fn append_digest(mut json: Vec<u8>) -> Vec<u8> {
    let seal = hex(&Sha256::digest(&json));
    json.pop();
    json.extend_from_slice(SEAL);
    json.extend_from_slice(seal.as_bytes());
    json.extend_from_slice(b"\"}");
    json
}

/// Returns the bytes if they match the digest that was stored with them.
fn verify_digest(bytes: &[u8]) -> Option<&[u8]> {
    let body = bytes.len().checked_sub(SEAL.len() + 64 + 2)?;
    let (body, seal) = bytes.split_at_checked(body)?;
    let mut hash = Sha256::new();
    hash.update(body);
    hash.update(b"}");
    let own = seal.strip_prefix(SEAL)?.strip_suffix(b"\"}")?;
    (own == hex(&hash.finalize()).as_bytes()).then_some(bytes)
}

/// Returns the SHA-256, hexadecimal.
pub fn digest(parts: &[&str]) -> String {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part.as_bytes());
    }
    hex(&hash.finalize())
}

/// SHA-256 by path, as `sha256sum` lists them: the digest, a blank, a blank or an asterisk, the path.
///
/// # Errors
/// The first line that does not have this form.
pub fn digests_of(text: &str) -> Result<BTreeMap<String, String>, String> {
    let line = |(i, line): (usize, &str)| {
        // A backslash in a name is doubled, and the line then starts with a backslash.
        let unescaped = line.strip_prefix('\\').map(|l| l.replace("\\\\", "\\"));
        let line = unescaped.as_deref().unwrap_or(line);
        let parts = line.split_once([' ']).and_then(|(digest, rest)| {
            let path = rest.strip_prefix([' ', '*'])?;
            let is_digest = digest.len() == 64 && digest.bytes().all(|b| b.is_ascii_hexdigit());
            (is_digest && !path.is_empty()).then(|| (path.to_owned(), digest.to_ascii_lowercase()))
        });
        parts.ok_or_else(|| format!("line {} is not a line of `sha256sum`", i + 1))
    };
    let lines = text.lines().enumerate().filter(|l| !l.1.trim().is_empty());
    lines.map(line).collect()
}

impl KeptDays {
    /// Returns the stored results in an output folder of the job with digest `job`.
    pub fn new(out: &Path, job: String) -> Self {
        Self {
            folder: out.join(FOLDER),
            job,
        }
    }

    /// Returns the path of the stored result of a file, from its name, the job and the version. A new result replaces the result of an earlier state
    /// of the file. A merge reads no records and could not determine which of two results is current.
    fn place(&self, name: &str) -> PathBuf {
        let version = concat!(env!("CARGO_PKG_VERSION"), " days");
        let key = digest(&[version, &FORM.to_string(), &self.job, name]);
        self.folder
            .join(format!("{}.json", key.get(..32).unwrap_or(&key)))
    }

    /// Returns the last stored result of the file with this path, for any content of the file; `None` if no result is stored.
    pub fn latest_result(&self, path: &str) -> Option<FileHead> {
        let bytes = std::fs::read(self.place(path)).ok()?;
        self.head_of(&bytes).filter(|f| f.path == path)
    }

    /// Returns the stored result of the file with this path and these bytes; `None` if no result is stored.
    pub fn head(&self, path: &str, sha256: &str) -> Option<FileHead> {
        self.latest_result(path).filter(|f| f.sha256 == sha256)
    }

    /// Returns the day of a file that [`KeptDays::head`] knows.
    pub fn day(&self, file: &FileHead) -> Option<Day> {
        let bytes = std::fs::read(self.place(&file.path)).ok()?;
        let kept: StoredResult<Day> = self.read(&bytes)?;
        kept.done
            .filter(|_| kept.path == file.path && kept.sha256 == file.sha256)
    }

    fn head_of(&self, bytes: &[u8]) -> Option<FileHead> {
        let kept: StoredResult<DayHead> = self.read(bytes)?;
        Some(FileHead {
            path: kept.path,
            sha256: kept.sha256,
            stamp: kept.stamp,
            vehicle: kept.vehicle,
            day: kept.day,
            result: match (kept.done, kept.failed) {
                (Some(day), _) => Ok(day),
                (None, failed) => Err(failed.unwrap_or_default()),
            },
        })
    }

    fn read<D: DeserializeOwned>(&self, bytes: &[u8]) -> Option<StoredResult<D>> {
        let kept: StoredResult<D> = serde_json::from_slice(verify_digest(bytes)?).ok()?;
        self.is_own(kept.form, &kept.version, &kept.job)
            .then_some(kept)
    }

    fn is_own(&self, form: u32, version: &str, job: &str) -> bool {
        form == FORM && version == env!("CARGO_PKG_VERSION") && job == self.job
    }

    fn classify_result(&self, bytes: &[u8]) -> StoredFileKind {
        let Ok(whose) = serde_json::from_slice::<Whose>(bytes) else {
            return StoredFileKind::Damaged;
        };
        if !self.is_own(whose.form, &whose.version, &whose.job) {
            return StoredFileKind::Other;
        }
        self.head_of(bytes)
            .map_or(StoredFileKind::Damaged, StoredFileKind::Own)
    }

    /// Stores the result of a file. Another run may store it at the same time, because the file is complete at any moment.
    ///
    /// # Errors
    /// The errors of the file system.
    pub fn store_result(&self, file: &FileResult) -> std::io::Result<()> {
        let kept = StoredResult {
            form: FORM,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            job: self.job.clone(),
            path: file.path.clone(),
            sha256: file.sha256.clone(),
            stamp: file.stamp,
            vehicle: file.vehicle.clone(),
            day: file.day.clone(),
            done: file.result.as_ref().ok().cloned(),
            failed: file.result.as_ref().err().cloned(),
        };
        let bytes = append_digest(serde_json::to_vec(&kept).map_err(std::io::Error::other)?);
        self.write(&self.place(&file.path), &bytes)
    }

    fn write(&self, place: &Path, bytes: &[u8]) -> std::io::Result<()> {
        std::fs::create_dir_all(&self.folder)?;
        // Processes of other machines and containers that share the folder may have the same process number.
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let nanos = now.map_or(0, |t| t.as_nanos());
        let part = place.with_extension(format!("{}-{nanos}.part", std::process::id()));
        let mut out = std::fs::File::create(&part)?;
        let written = out.write_all(bytes);
        drop(out);
        let kept = written.and_then(|()| std::fs::rename(&part, place));
        if kept.is_err() {
            // A partial file is removed, because the disk may be full.
            let _ = std::fs::remove_file(&part);
        }
        kept
    }

    /// Stores the request of a run before it begins, so that a merge can report missing results. Returns the path.
    ///
    /// # Errors
    /// The errors of the file system.
    pub fn put_asked(&self, files: &[String], parts: usize) -> std::io::Result<PathBuf> {
        let asked = RequestedRecords {
            job: self.job.clone(),
            parts,
            files: files.to_vec(),
            place: String::new(),
        };
        let bytes = serde_json::to_vec(&asked).map_err(std::io::Error::other)?;
        let name = hex(&Sha256::digest(&bytes));
        let name = format!("{}.{ASKED}", name.get(..32).unwrap_or(&name));
        let place = self.folder.join(name);
        // All shards of a request write the same file.
        match std::fs::read(&place) {
            Ok(there) if there == bytes => {}
            _ => self.write(&place, &bytes)?,
        }
        if parts > 1 {
            self.remove_contained(&asked, &place)?;
        }
        Ok(place)
    }

    /// Removes the requests of earlier runs of this job that `asked` contains completely.
    fn remove_contained(&self, asked: &RequestedRecords, place: &Path) -> std::io::Result<()> {
        for entry in std::fs::read_dir(&self.folder)? {
            let path = entry?.path();
            if path == place || path.extension().is_none_or(|e| e != ASKED) {
                continue;
            }
            // Another run may already have removed the file.
            let bytes = std::fs::read(&path).unwrap_or_default();
            if serde_json::from_slice(&bytes).is_ok_and(|a: RequestedRecords| asked.holds(&a)) {
                let _ = std::fs::remove_file(path);
            }
        }
        Ok(())
    }

    /// Whether something is kept of a file that was read.
    pub fn holds(&self, file: &FileHead) -> bool {
        !file.sha256.is_empty() && self.place(&file.path).is_file()
    }

    /// Reads all files of this job in the folder, without the days themselves.
    ///
    /// # Errors
    /// The errors of the file system.
    pub fn read_all(&self) -> std::io::Result<ResultFolderContent> {
        let mut held = ResultFolderContent::default();
        let entries = match std::fs::read_dir(&self.folder) {
            Ok(entries) => entries,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(held),
            Err(e) => return Err(e),
        };
        for entry in entries {
            let path = entry?.path();
            if path.extension().is_some_and(|e| e == "json") {
                match self.classify_result(&std::fs::read(&path)?) {
                    StoredFileKind::Own(file) => held.files.push(file),
                    StoredFileKind::Other => held.others += 1,
                    StoredFileKind::Damaged => held.damaged.push(path.display().to_string()),
                }
            } else if path.extension().is_some_and(|e| e == ASKED) {
                match serde_json::from_slice::<RequestedRecords>(&std::fs::read(&path)?) {
                    Ok(asked) if asked.job != self.job => {}
                    Ok(asked) => held.asked.push(RequestedRecords {
                        place: path.display().to_string(),
                        ..asked
                    }),
                    Err(_) => held.damaged.push(path.display().to_string()),
                }
            }
        }
        held.damaged.sort();
        held.asked.sort_by(|a, b| a.place.cmp(&b.place));
        held.files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(held)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kept_result_of_which_any_byte_was_changed_or_cut_is_none() {
        let json = br#"{"form":5,"max":1.25,"name":"A.FZ"}"#.to_vec();
        let whole = append_digest(json.clone());
        assert_eq!(verify_digest(&whole), Some(&whole[..]));
        let read: serde_json::Value = serde_json::from_slice(&whole).unwrap();
        assert_eq!(read["max"], 1.25);
        assert_eq!(verify_digest(&json), None);
        for i in 0..whole.len() {
            assert_eq!(verify_digest(&whole[..i]), None, "{i}");
            let mut other = whole.clone();
            other[i] ^= 1;
            assert_eq!(verify_digest(&other), None, "{i}");
        }
    }

    #[test]
    fn lines_of_sha256sum_are_read_and_others_refused() {
        // FIPS 180-4: digests of the empty text and of `abc`.
        let (nothing, abc) = (
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855",
            "BA7816BF8F01CFEA414140DE5DAE2223B00361A396177A9CB410FF61F20015AD",
        );
        let text = format!("{nothing}  data/T1 a.csv\r\n\n{abc} *T2.parquet\n");
        let read = digests_of(&text).unwrap();
        assert_eq!(read.len(), 2);
        assert_eq!(read["data/T1 a.csv"], nothing);
        assert_eq!(read["T2.parquet"], abc.to_lowercase());
        for wrong in [
            "T1.csv",
            "12ab  T1.csv",
            &format!("{nothing}T1.csv"),
            &format!("{nothing}  "),
        ] {
            let said = digests_of(&format!("{nothing}  a\n{wrong}\n")).unwrap_err();
            assert!(said.contains("line 2"), "{said}");
        }
    }
}
