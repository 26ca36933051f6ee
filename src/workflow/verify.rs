//! `verify`: a result folder against what its inputs give now, file by file and number by number.

use crate::finding::{Finding, LISTED, Severity};
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::files::Input;
use crate::host::manifest::Manifest;
use crate::host::outcome::{Answer, Outcome, StatedUnits};
use crate::host::words::count_of;
use crate::host::work::Work;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Keys of result.json that are of the run and not of the answer.
const OF_THE_RUN: [&str; 3] = ["seconds", "peak_memory_bytes", "extended_model"];

/// Result of a recomputation.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Recomputation {
    /// Inputs with unchanged bytes, and files with the same content as recomputed.
    pub same: Vec<String>,
    /// Inputs and files that differ.
    pub differs: Vec<Difference>,
}

impl Answer for Recomputation {
    const COMMAND: &'static str = "verify";
    const RESULT: &'static str = "The result folder";

    fn verdict(&self) -> String {
        format!(
            "{} equal to the results of the present inputs, {}.",
            match self.same.len() {
                1 => "1 file is".to_owned(),
                n => format!("{n} files are"),
            },
            count_of(self.differs.len(), "difference")
        )
    }
}

/// Difference between a result folder and its recomputation.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// Input as stated in the result, or file of the folder.
    pub file: String,
    /// Key of result.json, or line of a table; empty for a file as a whole.
    pub at: String,
    /// Value in the folder.
    pub was: String,
    /// Recomputed value.
    pub now: String,
}

/// Command, inputs and records of a result folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ResultProvenance {
    /// The command.
    pub command: String,
    /// Files read by the command, the job or deck first.
    pub inputs: Vec<Input>,
    /// Records of a fleet, as given, each once; empty for other commands.
    pub records: Vec<String>,
}

/// Reads from `result.json` which command made a result folder, and from which inputs.
///
/// # Errors
/// Returns a fault if the folder has no `result.json` of strainbridge.
pub fn read_made(folder: &Path) -> Result<ResultProvenance, Fault> {
    let file = folder.join("result.json");
    let name = file.display().to_string();
    let fault = |wrong: String| {
        Fault::new(
            &*name,
            "result.json",
            wrong,
            "name a folder that a command wrote",
        )
    };
    let text = std::fs::read_to_string(&file).map_err(|e| fault(format!("can't be read ({e})")))?;
    let json: Value = serde_json::from_str(&text).map_err(|e| fault(e.to_string()))?;
    let command = json.get("command").and_then(Value::as_str);
    let inputs = json.get("inputs").and_then(Value::as_array);
    let (Some(command), Some(inputs)) = (command, inputs) else {
        return Err(fault("it names no command and no inputs".to_owned()));
    };
    let text_of = |v: &Value, key: &str| v.get(key).and_then(Value::as_str).map(str::to_owned);
    let inputs = inputs.iter().filter_map(|v| {
        Some(Input {
            path: text_of(v, "path")?,
            sha256: text_of(v, "sha256")?,
        })
    });
    Ok(ResultProvenance {
        command: command.to_owned(),
        inputs: inputs.collect(),
        records: match command {
            "fleet" => records_of_fleet(&json),
            _ => Vec::new(),
        },
    })
}

/// Returns the paths of the records that a fleet counted, in this call or before it, and of those that failed.
fn records_of_fleet(result: &Value) -> Vec<String> {
    let list = |of: &Value, key: &str| of.get(key).and_then(Value::as_array).cloned();
    let vehicles = list(result, "vehicles").unwrap_or_default();
    let counted = vehicles.iter().filter_map(|v| list(v, "records")).flatten();
    let named = list(result, "files").unwrap_or_default();
    let paths = counted.chain(named);
    let paths = paths.filter_map(|r| r.get("path")?.as_str().map(str::to_owned));
    paths.collect::<BTreeSet<_>>().into_iter().collect()
}

/// Compares a result folder with the results that its inputs give now.
///
/// `again` computes the answer again from the command that the folder states and from its job or deck. It returns the folder with the new
/// files. The caller decides how: the command line starts a separate process, which shares no state with this one.
///
/// # Errors
/// Returns folders that can't be read, a missing job or deck, or the faults of `again`.
///
/// # Example
/// ```
/// use strainbridge::{Context, Disk, modes_of_deck, verify};
///
/// # let folder = std::env::temp_dir().join(format!("strainbridge-verify-{}", std::process::id()));
/// # std::fs::create_dir_all(folder.join("was"))?;
/// # std::fs::create_dir_all(folder.join("now"))?;
/// # let deck = "SOL 103\nCEND\nSPC = 1\nBEGIN BULK\nGRID,1,,0.,0.,0.,,23456\nGRID,2,,1.,0.,0.,,123456
/// # CELAS2,1,8000.,1,1,2,1\nCONM2,2,1,,2.\nSPC1,1,123456,2\nENDDATA\n";
/// # std::fs::write(folder.join("oscillator.bdf"), deck)?;
/// let (was, now) = (folder.join("was"), folder.join("now"));
/// let cx = Context::new(&Disk);
/// let found = modes_of_deck(&folder.join("oscillator.bdf"), 1, &cx)?;
/// std::fs::write(was.join("result.json"), found.to_json(&Default::default())?)?;
///
/// let compared = verify(&was, |made, deck| {
///     assert_eq!(made.command, "modes");
///     let json = modes_of_deck(deck, 1, &cx)?.to_json(&Default::default()).unwrap();
///     std::fs::write(now.join("result.json"), json).unwrap();
///     Ok(now.clone())
/// }, &cx)?;
/// assert!(compared.differs.is_empty() && compared.same.contains(&"result.json".to_owned()));
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn verify(
    folder: &Path,
    again: impl FnOnce(&ResultProvenance, &Path) -> Result<PathBuf, Faults>,
    cx: &Context,
) -> Result<Outcome<Recomputation>, Faults> {
    let mut work = Work::new(cx);
    let made = read_made(folder)?;
    work.sources.push(folder.join("result.json"));
    let main = main_input(folder, &made)?;
    let recomputed = work.stage("recompute", |_| again(&made, &main))?;
    let found = work.stage("compare", |_| compare(folder, &recomputed))?;
    work.findings.extend(found.findings(folder));
    Ok(work.finish(StatedUnits::default(), found))
}

/// Returns the job or deck of a result folder: the stated path, else the path next to a folder of the default name.
///
/// # Errors
/// Returns a fault if the file is in neither place.
pub fn main_input(folder: &Path, made: &ResultProvenance) -> Result<PathBuf, Fault> {
    let given = made.inputs.first().map(|i| PathBuf::from(&i.path));
    let next_to_folder = |p: &PathBuf| Some(folder.parent()?.join(p.file_name()?));
    let next_to_folder = given.as_ref().and_then(next_to_folder);
    let mut places = [given, next_to_folder].into_iter().flatten();
    places.find(|p| p.is_file()).ok_or_else(|| {
        Fault::new(
            folder.display().to_string(),
            "inputs",
            "the job or deck of this folder is not found",
            "call `verify` from the folder in which the command was called",
        )
    })
}

/// Compares a result folder with the folder of its recomputation.
fn compare(folder: &Path, again: &Path) -> Result<Recomputation, Faults> {
    let (old, new) = (read_made(folder)?, read_made(again)?);
    let mut out = Recomputation::default();
    for (i, input) in old.inputs.iter().enumerate() {
        // The path of the main input may have changed.
        let now = new.inputs.iter().find(|n| n.path == input.path);
        let now = now.or_else(|| new.inputs.first().filter(|_| i == 0));
        out.file(
            &input.path,
            &input.sha256,
            now.map_or("not read", |n| &n.sha256),
        );
    }
    // A folder may contain files of other commands. Without a manifest, all its files are compared.
    let ours = match Manifest::read(folder).names_of(&old.command) {
        own if own.is_empty() => names(folder)?,
        own => own,
    };
    let theirs = names(again)?;
    for name in ours.union(&theirs) {
        let read = |f: &Path| std::fs::read(f.join(name)).ok();
        match (read(folder), read(again)) {
            (Some(was), Some(now)) if name == "result.json" => out.json(name, &was, &now),
            (Some(was), Some(now)) => out.bytes(name, &was, &now),
            (was, now) => {
                let word = |there: bool| if there { "there" } else { "missing" };
                out.file(name, word(was.is_some()), word(now.is_some()));
            }
        }
    }
    Ok(out)
}

/// Names of the files of a folder, without hidden ones.
fn names(folder: &Path) -> Result<BTreeSet<String>, Fault> {
    let unreadable = |e: std::io::Error| {
        Fault::new(
            folder.display().to_string(),
            "folder",
            format!("can't be read ({e})"),
            "name a folder that a command wrote",
        )
    };
    let entries = std::fs::read_dir(folder).map_err(unreadable)?;
    Ok(entries
        .filter_map(Result::ok)
        .filter(|e| e.path().is_file())
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|n| !n.starts_with('.'))
        .collect())
}

impl ResultProvenance {
    /// Returns the result files among the inputs of a command on deck and results.
    pub fn results(&self) -> Vec<&str> {
        let is_result = |p: &&str| {
            let name = p.to_ascii_lowercase();
            [".op2", ".pch", ".h5"].iter().any(|e| name.ends_with(e))
        };
        let others = self.inputs.iter().skip(1).map(|i| i.path.as_str());
        others.filter(is_result).collect()
    }
}

impl Recomputation {
    /// Returns an error if anything differs.
    fn findings(&self, folder: &Path) -> Option<Finding> {
        let first = self.differs.first()?;
        let n = self.differs.len();
        let message = format!(
            "{} from the result that its inputs give now, the first in `{}`",
            count_of(n, "difference"),
            first.file
        );
        let finding = Finding::new(
            Severity::Error,
            "result-differs",
            folder.display().to_string(),
            message,
            "restore the inputs or the version of the program, or run the command again",
        );
        Some(finding.with_numbers(n as f64, 0.0))
    }

    fn file(&mut self, name: &str, was: &str, now: &str) {
        if was == now {
            self.same.push(name.to_owned());
        } else {
            self.differs.push(Difference {
                file: name.to_owned(),
                at: String::new(),
                was: was.to_owned(),
                now: now.to_owned(),
            });
        }
    }

    /// Compares the bytes of two files. A text is compared line by line, any other file as a whole.
    fn bytes(&mut self, name: &str, was: &[u8], now: &[u8]) {
        if was == now {
            return self.same.push(name.to_owned());
        }
        let is_table = name.ends_with(".csv") || name.ends_with(".bdf");
        let (Ok(a), Ok(b)) = (std::str::from_utf8(was), std::str::from_utf8(now)) else {
            return self.file(
                name,
                &size(was),
                &format!("{}, different content", size(now)),
            );
        };
        if !is_table {
            return self.file(
                name,
                &size(was),
                &format!("{}, different content", size(now)),
            );
        }
        let (mut a, mut b) = (a.lines(), b.lines());
        let mut listed = 0;
        for line in 1_usize.. {
            let (x, y) = (a.next(), b.next());
            if x.is_none() && y.is_none() || listed == LISTED {
                break;
            }
            if x != y {
                listed += 1;
                self.differs.push(Difference {
                    file: name.to_owned(),
                    at: format!("line {line}"),
                    was: x.unwrap_or("no such line").to_owned(),
                    now: y.unwrap_or("no such line").to_owned(),
                });
            }
        }
    }

    fn json(&mut self, name: &str, was: &[u8], now: &[u8]) {
        let parse = |bytes: &[u8]| serde_json::from_slice::<Value>(bytes).unwrap_or_default();
        let before = self.differs.len();
        self.value(name, "", &parse(was), &parse(now), before + LISTED);
        if self.differs.len() == before {
            self.same.push(name.to_owned());
        }
    }

    fn value(&mut self, name: &str, at: &str, was: &Value, now: &Value, most: usize) {
        if was == now || self.differs.len() >= most || OF_THE_RUN.contains(&at) {
            return;
        }
        let below = |key: &str| match at {
            "" => key.to_owned(),
            _ => format!("{at}.{key}"),
        };
        match (was, now) {
            (Value::Object(a), Value::Object(b)) => {
                let keys: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
                for key in keys {
                    let none = Value::Null;
                    let (x, y) = (a.get(key).unwrap_or(&none), b.get(key).unwrap_or(&none));
                    // Paths are as the user gave them. Digests are compared with the files.
                    if at.is_empty() && key == "inputs" {
                        continue;
                    }
                    self.value(name, &below(key), x, y, most);
                }
            }
            (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
                for (i, (x, y)) in a.iter().zip(b).enumerate() {
                    self.value(name, &below(&i.to_string()), x, y, most);
                }
            }
            _ => self.differs.push(Difference {
                file: name.to_owned(),
                at: at.to_owned(),
                was: was.to_string(),
                now: now.to_string(),
            }),
        }
    }
}

fn size(bytes: &[u8]) -> String {
    format!("{} bytes", bytes.len())
}
