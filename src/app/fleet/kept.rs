//! Results of single files, kept in the output folder by what they depend on.

use super::day::{Day, DayHead, FileHead, FileResult};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Folder of the kept results within the output folder.
pub const FOLDER: &str = "days";
/// Counts up when what is kept changes its meaning.
const FORM: u32 = 4;

/// A kept result; `D` is what is read of its day.
#[derive(Serialize, Deserialize)]
struct Kept<D> {
    form: u32,
    version: String,
    /// Digest of the job and of every file it stands on.
    job: String,
    path: String,
    sha256: String,
    vehicle: String,
    day: String,
    done: Option<D>,
    failed: Option<String>,
}

/// Kept results of one job.
pub struct KeptDays {
    folder: PathBuf,
    job: String,
}

/// What a folder holds.
#[derive(Default)]
pub struct Held {
    /// Files of this job, by path.
    pub files: Vec<FileHead>,
    /// Results of another job, version or form, and files that can't be read.
    pub others: usize,
}

/// SHA-256, hexadecimal.
pub fn digest(parts: &[&str]) -> String {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part.as_bytes());
    }
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

/// SHA-256 by path, as `sha256sum` lists them: the digest, a blank, a blank or an asterisk, the path.
///
/// # Errors
/// The first line that is none.
pub fn digests_of(text: &str) -> Result<BTreeMap<String, String>, String> {
    let line = |(i, line): (usize, &str)| {
        let parts = line.split_once([' ']).and_then(|(digest, rest)| {
            let path = rest.strip_prefix([' ', '*'])?;
            let is_digest = digest.len() == 64 && digest.bytes().all(|b| b.is_ascii_hexdigit());
            (is_digest && !path.is_empty()).then(|| (path.to_owned(), digest.to_ascii_lowercase()))
        });
        parts.ok_or_else(|| format!("line {} is no line of `sha256sum`", i + 1))
    };
    let lines = text.lines().enumerate().filter(|l| !l.1.trim().is_empty());
    lines.map(line).collect()
}

impl KeptDays {
    /// Those of a job, whose digest is `job`, in an output folder.
    pub fn new(out: &Path, job: String) -> Self {
        Self {
            folder: out.join(FOLDER),
            job,
        }
    }

    /// Where the result of a file is kept: by its bytes, its name, the job and the version.
    fn place(&self, sha256: &str, name: &str) -> PathBuf {
        let version = concat!(env!("CARGO_PKG_VERSION"), " days");
        let key = digest(&[version, &FORM.to_string(), &self.job, sha256, name]);
        self.folder
            .join(format!("{}.json", key.get(..32).unwrap_or(&key)))
    }

    /// What became of a file with these bytes and this path, where it is kept.
    pub fn head(&self, path: &str, sha256: &str) -> Option<FileHead> {
        let bytes = std::fs::read(self.place(sha256, path)).ok()?;
        self.head_of(&bytes)
            .filter(|f| f.path == path && f.sha256 == sha256)
    }

    /// The day of a file that [`KeptDays::head`] knows.
    pub fn day(&self, file: &FileHead) -> Option<Day> {
        let bytes = std::fs::read(self.place(&file.sha256, &file.path)).ok()?;
        self.read(&bytes)?.done
    }

    fn head_of(&self, bytes: &[u8]) -> Option<FileHead> {
        let kept: Kept<DayHead> = self.read(bytes)?;
        Some(FileHead {
            path: kept.path,
            sha256: kept.sha256,
            vehicle: kept.vehicle,
            day: kept.day,
            result: match (kept.done, kept.failed) {
                (Some(day), _) => Ok(day),
                (None, failed) => Err(failed.unwrap_or_default()),
            },
        })
    }

    fn read<D: DeserializeOwned>(&self, bytes: &[u8]) -> Option<Kept<D>> {
        let kept: Kept<D> = serde_json::from_slice(bytes).ok()?;
        let own =
            kept.form == FORM && kept.version == env!("CARGO_PKG_VERSION") && kept.job == self.job;
        own.then_some(kept)
    }

    /// Keeps the result of a file; another run may do the same at the same time, the file is whole at any moment.
    ///
    /// # Errors
    /// Those of the system.
    pub fn put(&self, file: &FileResult) -> std::io::Result<()> {
        let kept = Kept {
            form: FORM,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            job: self.job.clone(),
            path: file.path.clone(),
            sha256: file.sha256.clone(),
            vehicle: file.vehicle.clone(),
            day: file.day.clone(),
            done: file.result.as_ref().ok().cloned(),
            failed: file.result.as_ref().err().cloned(),
        };
        let bytes = serde_json::to_vec(&kept).map_err(std::io::Error::other)?;
        std::fs::create_dir_all(&self.folder)?;
        let place = self.place(&file.sha256, &file.path);
        // Processes of other machines and containers that share the folder may have this one's number.
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let nanos = now.map_or(0, |t| t.as_nanos());
        let part = place.with_extension(format!("{}-{nanos}.part", std::process::id()));
        let mut out = std::fs::File::create(&part)?;
        out.write_all(&bytes)?;
        drop(out);
        std::fs::rename(&part, &place)
    }

    /// All that the folder holds of this job, without the days themselves.
    ///
    /// # Errors
    /// Those of the system.
    pub fn all(&self) -> std::io::Result<Held> {
        let mut held = Held::default();
        let entries = match std::fs::read_dir(&self.folder) {
            Ok(entries) => entries,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(held),
            Err(e) => return Err(e),
        };
        for entry in entries {
            let path = entry?.path();
            if path.extension().is_some_and(|e| e == "json") {
                match self.head_of(&std::fs::read(&path)?) {
                    Some(file) => held.files.push(file),
                    None => held.others += 1,
                }
            }
        }
        held.files.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(held)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_sha256sum_are_read_and_others_refused() {
        // FIPS 180-4: of nothing, and of `abc`.
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
