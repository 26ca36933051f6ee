//! Runs the program on records in a separate folder.

use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Job with two loads and S from a table.
pub const JOB: &str = r#"units = "m-kg-s"
report_units = { force = "kN", moment = "kN m" }
[sensitivity]
file = "S.csv"
per = { force = "kN" }
[[load]]
name = "A.FZ"
expected = 20000.0
[[load]]
name = "B.FZ"
expected = 20000.0
[measured]
noise_microstrain = 0.001
model_uncertainty_rel = 0.02
[fleet]
file_name = "{vehicle}_{day}.csv"
"#;

/// Creates an empty folder for one test.
pub fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("fleet")
        .join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs `fleet job.toml` on these files. Returns exit code and result, or the output of the program if there is no
/// result.
pub fn fleet(dir: &Path, out: &str, files: &[impl AsRef<OsStr>], more: &[&str]) -> (i32, Value) {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .current_dir(dir)
        .args(["fleet", "job.toml"])
        .args(files)
        .args(["--out", out, "--json"])
        .args(more)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&done.stderr).into_owned();
    let json = serde_json::from_slice(&done.stdout).unwrap_or(Value::String(error));
    (done.status.code().unwrap(), json)
}
