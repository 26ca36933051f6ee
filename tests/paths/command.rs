//! Runs the program on a copy of a case.

use std::path::{Path, PathBuf};
use std::process::Command;

pub use crate::support::find_shared_path;

/// Creates an empty folder for one test.
pub fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Outcome of a run of the program.
pub struct Outcome {
    /// Exit code.
    pub code: i32,
    /// `result.json`, or null if the program wrote none.
    pub result: serde_json::Value,
    /// Standard error.
    pub stderr: String,
}

impl Outcome {
    /// Returns the codes of the findings of one severity.
    pub fn codes(&self, severity: &str) -> Vec<String> {
        let findings = self.result["findings"]
            .as_array()
            .cloned()
            .unwrap_or_default();
        findings
            .iter()
            .filter(|f| f["severity"] == severity)
            .filter_map(|f| f["code"].as_str().map(str::to_owned))
            .collect()
    }

    /// Returns a number of the result.
    pub fn number(&self, key: &str) -> f64 {
        self.result[key].as_f64().unwrap_or(f64::NAN)
    }
}

/// Runs `strainbridge` with output to `out`.
pub fn run(arguments: &[&str], out: &Path) -> Outcome {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .arg("--out")
        .arg(out)
        .output()
        .unwrap();
    let text = std::fs::read_to_string(out.join("result.json")).unwrap_or_default();
    Outcome {
        code: done.status.code().unwrap_or(-1),
        result: serde_json::from_str(&text).unwrap_or_default(),
        stderr: String::from_utf8_lossy(&done.stderr).into_owned(),
    }
}

/// Reads a CSV file: header, then rows of fields.
pub fn csv(path: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text
        .lines()
        .map(|l| l.split(',').map(str::to_owned).collect::<Vec<String>>());
    (lines.next().unwrap_or_default(), lines.collect())
}
