//! Writing: files appear under their names only when all of them are complete, and never in place of a file that no command wrote.

use crate::finding::list_few;
use crate::host::fault::{Fault, Faults};
use crate::host::files::sha256_hex;
use crate::host::half_written;
use crate::host::manifest::{self, Manifest};
use crate::host::other_results::INDEX;
use crate::host::outcome::Tables;
use crate::host::whole_file::{FileBytes, load};
use nastran::op2::WriteError;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Counts temporary files of this process.
static PARTS: AtomicU64 = AtomicU64::new(0);

/// A file that is written piece by piece.
pub type OpenFile = BufWriter<File>;

/// The output folder of one command. Files are written under temporary names and renamed by [`Output::commit`]. Without a commit, no file remains.
pub struct Output {
    folder: PathBuf,
    pending: Vec<(PathBuf, PathBuf)>,
    tables: Tables,
}

impl Output {
    /// Opens an output folder, which is created if it is missing.
    ///
    /// # Errors
    /// A fault if it cannot be created.
    pub fn begin(folder: &Path) -> Result<Self, Fault> {
        std::fs::create_dir_all(folder).map_err(|e| unwritable_file_fault(folder, &e))?;
        half_written::remove_stale(folder);
        Ok(Self {
            folder: folder.to_owned(),
            pending: Vec::new(),
            tables: Tables::new(),
        })
    }

    /// Returns the folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// States the units of a table's columns, for `result.json`.
    pub fn declare<C: Into<String>, U: Into<String>>(
        &mut self,
        table: &str,
        columns: impl IntoIterator<Item = (C, U)>,
    ) {
        let columns = columns.into_iter().map(|(c, u)| (c.into(), u.into()));
        self.tables.insert(table.to_owned(), columns.collect());
    }

    /// Returns the units of the columns of every declared table.
    pub fn tables(&self) -> &Tables {
        &self.tables
    }

    /// Writes file `name` by `fill`, buffered.
    ///
    /// # Errors
    /// A fault if it cannot be written.
    pub fn write(
        &mut self,
        name: &str,
        fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<(), Fault> {
        let part = self.begin_file(name);
        fill_file(&part, fill).map_err(|e| unwritable_file_fault(&self.folder.join(name), &e))
    }

    /// Opens file `name` for writing piece by piece. Flush the file before [`Output::commit`].
    ///
    /// # Errors
    /// A fault if it cannot be created.
    pub fn open(&mut self, name: &str) -> Result<OpenFile, Fault> {
        let part = self.begin_file(name);
        File::create(part)
            .map(|f| BufWriter::with_capacity(1 << 20, f))
            .map_err(|e| unwritable_file_fault(&self.folder.join(name), &e))
    }

    /// Returns whether file `name` was begun.
    pub fn holds(&self, name: &str) -> bool {
        let target = self.folder.join(name);
        self.pending.iter().any(|p| p.1 == target)
    }

    /// Returns the bytes that have been written to file `name`. Flush the file first, and drop the bytes before [`Output::commit`].
    ///
    /// # Errors
    /// A fault if it cannot be read.
    pub fn read_back(&self, name: &str) -> Result<FileBytes, Fault> {
        let target = self.folder.join(name);
        let written = self.pending.iter().rev().find(|p| p.1 == target);
        let part = written.map_or(&target, |p| &p.0);
        load(part).map_err(|e| unwritable_file_fault(&target, &e))
    }

    /// A temporary name that no other run into the folder has.
    fn part(&self, name: &str) -> PathBuf {
        let n = PARTS.fetch_add(1, Ordering::Relaxed);
        self.folder.join(half_written::name_of_part(name, n))
    }

    /// Returns the fault of a file in this folder whose writing failed.
    pub fn fault(&self, name: &str, e: &std::io::Error) -> Fault {
        unwritable_file_fault(&self.folder.join(name), e)
    }

    /// Writes two files in parallel: `fill_one` writes the content of `one`, and `fill_two` the content of `two`.
    ///
    /// # Errors
    /// A fault for the first file that cannot be written.
    pub fn write_both(
        &mut self,
        (one, fill_one): (
            &str,
            impl FnOnce(&mut dyn Write) -> std::io::Result<()> + Send,
        ),
        (two, fill_two): (
            &str,
            impl FnOnce(&mut dyn Write) -> std::io::Result<()> + Send,
        ),
    ) -> Result<(), Fault> {
        let (part_one, part_two) = (self.begin_file(one), self.begin_file(two));
        let (a, b) = rayon::join(
            || fill_file(&part_one, fill_one),
            || fill_file(&part_two, fill_two),
        );
        a.map_err(|e| unwritable_file_fault(&self.folder.join(one), &e))?;
        b.map_err(|e| unwritable_file_fault(&self.folder.join(two), &e))
    }

    /// Records a file under its temporary name; a file that is begun twice is overwritten.
    fn begin_file(&mut self, name: &str) -> PathBuf {
        let target = self.folder.join(name);
        if let Some(written) = self.pending.iter().find(|p| p.1 == target) {
            return written.0.clone();
        }
        let part = self.part(name);
        half_written::note(&part);
        self.pending.push((part.clone(), self.folder.join(name)));
        part
    }

    /// Writes file `name` from bytes.
    ///
    /// # Errors
    /// A fault if it cannot be written.
    pub fn write_bytes(&mut self, name: &str, bytes: &[u8]) -> Result<(), Fault> {
        self.write(name, |w| w.write_all(bytes))
    }

    /// Refuses names of files that are inputs of the answer, or that no command wrote into the folder. Overwriting them would change the next answer
    /// or lose data.
    ///
    /// # Errors A fault for each such file.
    pub fn check_spared(&self, sources: &[PathBuf]) -> Result<(), Faults> {
        let sources = canonicalize_paths(sources);
        let ours = Manifest::read(&self.folder);
        let fault = |(part, target): &(PathBuf, PathBuf)| {
            let stands = std::fs::canonicalize(target).ok()?;
            let fault = if sources.contains(&stands) {
                Fault::new(
                    target.display().to_string(),
                    "output",
                    "the command has read this file, and would overwrite it",
                    "choose another folder with `--out`, or give the input another name",
                )
            } else {
                not_ours(&ours, target)?
            };
            (!is_same(part, target)).then_some(fault)
        };
        Faults::check(self.pending.iter().filter_map(fault).collect())
    }

    /// Refuses a folder that contains files of `names` that no command wrote. The check precedes all computation.
    ///
    /// # Errors
    /// A fault for each of these files.
    pub fn check_free(folder: &Path, names: &[&str]) -> Result<(), Faults> {
        let targets = names.iter().map(|n| folder.join(n));
        let standing: Vec<PathBuf> = targets.filter(|t| t.exists()).collect();
        // Another run lists a file before it writes it. The manifest is therefore read after the check for existing files.
        let ours = Manifest::read(folder);
        let foreign = standing.iter().filter_map(|t| not_ours(&ours, t));
        Faults::check(foreign.collect())
    }

    /// Renames every file to its name. Removes files that the command wrote into the folder before and does not write now, except `sources`.
    ///
    /// # Errors
    /// Faults of [`Output::check_spared`]; a fault for the first file that cannot be renamed.
    pub fn commit(mut self, command: &str, sources: &[PathBuf]) -> Result<(), Faults> {
        let _held = hold(&self.folder);
        self.check_spared(sources)?;
        let sources = canonicalize_paths(sources);
        let mut written = Manifest::read(&self.folder);
        let before = written.clone();
        let gone = written.replace(command, &self.names());
        if self.holds(INDEX) {
            // The page depends on the results of other commands, so it is not part of the answer.
            written.add(&format!("{command} index"), &[INDEX.to_owned()]);
        }
        for (other, kept) in self.keep_answers_of_others(command, &before)? {
            written.add(&other, &[kept]);
        }
        self.list_first(&mut written)?;
        self.rename_all()?;
        for name in gone {
            let path = self.folder.join(name);
            // A file that is already gone is not missed. A file that was changed belongs to its user.
            if !is_changed(&before, &path)
                && std::fs::canonicalize(&path).is_ok_and(|p| !sources.contains(&p))
            {
                let _ = std::fs::remove_file(path);
            }
        }
        Ok(())
    }

    /// Copies the answer and the report of another command, which this one overwrites, to names that begin with that command. Returns the writer and
    /// the name of each copy.
    fn keep_answers_of_others(
        &mut self,
        command: &str,
        before: &Manifest,
    ) -> Result<Vec<(String, String)>, Fault> {
        let mut kept = Vec::new();
        for name in ["result.json", "report.html"] {
            let other = before.writer(name).filter(|w| *w != command);
            let Some(other) = other.filter(|_| self.holds(name)) else {
                continue;
            };
            let copy = format!("{other}.{name}");
            let is_free = before.holds(&copy) || !self.folder.join(&copy).exists();
            if let (true, Ok(bytes)) = (is_free, load(&self.folder.join(name))) {
                self.write_bytes(&copy, &bytes)?;
                kept.push((other.to_owned(), copy));
            }
        }
        Ok(kept)
    }

    /// Renames every file to its name and keeps earlier files of the command: for a command that writes its folder in several calls.
    ///
    /// # Errors
    /// The errors of [`Output::commit`].
    pub fn commit_with_earlier_files(mut self, command: &str) -> Result<(), Faults> {
        let _held = hold(&self.folder);
        self.check_spared(&[])?;
        let mut written = Manifest::read(&self.folder);
        written.add(command, &self.names());
        self.list_first(&mut written)?;
        Ok(self.rename_all()?)
    }

    /// Names of the files that were begun.
    fn names(&self) -> Vec<String> {
        let names = self.pending.iter().filter_map(|p| p.1.file_name());
        names.map(|n| n.to_string_lossy().into_owned()).collect()
    }

    /// Writes the list of the folder, to be renamed before the files that it lists: the list contains every file of the program.
    fn list_first(&mut self, written: &mut Manifest) -> Result<(), Fault> {
        let digest = |(part, target): &(PathBuf, PathBuf)| {
            let name = target.file_name()?.to_string_lossy().into_owned();
            Some((name, digest_of(part, target)?))
        };
        written.state_digests(self.pending.iter().filter_map(digest));
        self.write_bytes(manifest::NAME, written.text().as_bytes())?;
        self.pending.rotate_right(1);
        Ok(())
    }

    /// Renames every file to its name and makes no other change in the folder. It is used for a file in a user's folder.
    ///
    /// # Errors
    /// A fault for the first file that cannot be renamed.
    pub fn rename_all(&mut self) -> Result<(), Fault> {
        while let Some((part, target)) = self.pending.first().cloned() {
            std::fs::rename(&part, &target).map_err(|e| unwritable_file_fault(&target, &e))?;
            half_written::forget(&part);
            self.pending.remove(0);
        }
        Ok(())
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        for (part, _) in &self.pending {
            let _ = std::fs::remove_file(part);
            half_written::forget(part);
        }
    }
}

/// Returns a note on files of other commands that are still in a folder; `None` without such files.
pub fn left_by_others(folder: &Path, command: &str) -> Option<String> {
    let written = Manifest::read(folder);
    let of = |(by, names): (&str, Vec<&str>)| {
        let stands = |n: &&str| folder.join(n).is_file();
        let names: Vec<&str> = names.into_iter().filter(stands).collect();
        (!names.is_empty()).then(|| format!("`{by}` ({})", list_few(&names)))
    };
    let list: Vec<String> = written
        .of_others(command)
        .into_iter()
        .filter_map(of)
        .collect();
    (!list.is_empty()).then(|| {
        let list = list.join(", ");
        format!("the folder also contains files of {list} from earlier runs")
    })
}

/// Returns the fault of a file that no command wrote; `None` if a command wrote it.
fn not_ours(ours: &Manifest, target: &Path) -> Option<Fault> {
    let name = target.file_name()?.to_string_lossy();
    if is_changed(ours, target) {
        return Some(Fault::new(
            target.display().to_string(),
            "output",
            "this file was changed after strainbridge wrote it, and this run would overwrite it",
            "choose another folder with `--out`, or give the changed file another name",
        ));
    }
    (!ours.holds(&name)).then(|| {
        Fault::new(
            target.display().to_string(),
            "output",
            format!(
                "the command writes a file of this name, and strainbridge did not write the existing one (`{}` lists its files)",
                manifest::NAME
            ),
            "choose another folder with `--out`, or move the file away",
        )
    })
}

/// Returns the SHA-256 of a file if its final name is one that a person may edit.
fn digest_of(file: &Path, name: &Path) -> Option<String> {
    /// Extensions of tables and jobs.
    const EDITED: [&str; 5] = ["csv", "toml", "md", "bdf", "txt"];
    /// Largest file that is compared, bytes: nobody edits a larger table by hand.
    const LARGEST: u64 = 16 << 20;
    let kind = name.extension()?.to_str()?;
    let size = std::fs::metadata(file).ok()?.len();
    if !EDITED.contains(&kind) || size > LARGEST {
        return None;
    }
    load(file).ok().map(|bytes| sha256_hex(&bytes))
}

/// Returns whether a file that a command wrote has other bytes now.
fn is_changed(ours: &Manifest, target: &Path) -> bool {
    let name = target.file_name().map(|n| n.to_string_lossy());
    let written = name.and_then(|n| ours.digest(&n).map(str::to_owned));
    let now = written.as_ref().and_then(|_| digest_of(target, target));
    // A file that grew beyond the size limit of digests has changed too.
    written.is_some_and(|w| target.is_file() && now != Some(w))
}

/// Locks the folder while its list is read and written. Without a lock, two runs that end at once would each lose the list of the other. A system
/// that cannot lock a folder works without a lock.
fn hold(folder: &Path) -> Option<File> {
    let folder = File::open(folder).ok()?;
    folder.lock().ok()?;
    Some(folder)
}

/// Returns whether two files hold the same bytes.
fn is_same(a: &Path, b: &Path) -> bool {
    let size = |p: &Path| std::fs::metadata(p).map(|m| m.len()).ok();
    size(a) == size(b) && matches!((load(a), load(b)), (Ok(a), Ok(b)) if *a == *b)
}

/// Returns the canonical paths of the files, with links followed. Files in memory are left out.
fn canonicalize_paths(paths: &[PathBuf]) -> BTreeSet<PathBuf> {
    let known = paths.iter().map(std::fs::canonicalize);
    known.filter_map(Result::ok).collect()
}

fn fill_file(
    part: &Path,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> std::io::Result<()> {
    let mut file = BufWriter::with_capacity(1 << 18, File::create(part)?);
    fill(&mut file)?;
    file.flush()
}

fn unwritable_file_fault(path: &Path, e: &std::io::Error) -> Fault {
    let of_format = e.get_ref().and_then(|e| e.downcast_ref::<WriteError>());
    let remedy = match of_format {
        Some(WriteError::Id(_)) => {
            "renumber the grid or element in the deck: its id must be below 214748365"
        }
        Some(WriteError::Unsupported { .. }) => "delete these elements from the deck",
        _ => "choose another folder with `--out`",
    };
    let wrong = format!("the file cannot be written ({e})");
    Fault::new(path.display().to_string(), "output", wrong, remedy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::other_results::{OtherResult, other_results};

    fn write_output(folder: &Path, text: &str) -> Result<(), Faults> {
        let mut out = Output::begin(folder)?;
        out.write_bytes("gauges.csv", text.as_bytes())?;
        out.commit("place", &[])
    }

    #[test]
    fn a_later_command_keeps_the_report_of_an_earlier_one_until_that_runs_again() {
        let folder = std::env::temp_dir().join(format!("strainbridge-kept-{}", std::process::id()));
        let run = |command: &str| {
            let mut out = Output::begin(&folder).unwrap();
            out.write_bytes("report.html", command.as_bytes()).unwrap();
            let json = format!("{{\"summary\": \"Done by {command}.\"}}");
            out.write_bytes("result.json", json.as_bytes()).unwrap();
            let others = other_results(&folder, command);
            out.commit(command, &[]).unwrap();
            others
        };
        let text = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
        assert_eq!(run("place"), []);
        let of_place = OtherResult {
            command: "place".to_owned(),
            report: "place.report.html".to_owned(),
            summary: "Done by place.".to_owned(),
            has_errors: false,
        };
        assert_eq!(run("recover"), std::slice::from_ref(&of_place));
        assert_eq!(run("recover"), [of_place]);
        assert_eq!(text("report.html").as_deref(), Some("recover"));
        assert_eq!(text("place.report.html").as_deref(), Some("place"));
        run("place");
        assert_eq!(text("report.html").as_deref(), Some("place"));
        assert_eq!(text("recover.report.html").as_deref(), Some("recover"));
        assert_eq!(text("place.report.html"), None);
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_table_that_was_changed_by_hand_is_not_written_over_nor_removed() {
        let folder =
            std::env::temp_dir().join(format!("strainbridge-changed-{}", std::process::id()));
        let table = folder.join("gauges.csv");
        write_output(&folder, "a").unwrap();
        write_output(&folder, "b").unwrap();
        std::fs::write(&table, "corrected").unwrap();
        let faults = write_output(&folder, "c").unwrap_err();
        assert!(
            faults.iter().any(|f| f.wrong.contains("was changed")),
            "{faults:?}"
        );
        let early = Output::check_free(&folder, &["gauges.csv"]).unwrap_err();
        assert_eq!(early.iter().count(), 1);
        assert_eq!(std::fs::read_to_string(&table).unwrap(), "corrected");
        // A run that no longer writes the table does not remove it.
        let mut out = Output::begin(&folder).unwrap();
        out.write_bytes("other.csv", b"d").unwrap();
        out.commit("place", &[]).unwrap();
        assert_eq!(std::fs::read_to_string(&table).unwrap(), "corrected");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
