//! Runs the program in a separate folder.

use std::path::{Path, PathBuf};
use std::process::Command;

pub fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("truck")
        .join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Returns exit code, result.json and standard error.
pub fn run(arguments: &[&str], out: &Path) -> (i32, serde_json::Value, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .arg("--out")
        .arg(out)
        .output()
        .unwrap();
    let text = std::fs::read_to_string(out.join("result.json")).unwrap_or_default();
    (
        done.status.code().unwrap_or(-1),
        serde_json::from_str(&text).unwrap_or_default(),
        String::from_utf8_lossy(&done.stderr).into_owned(),
    )
}

/// Returns `[model]` and the six wheels.
pub fn head() -> String {
    let mut text = String::from(
        "title = \"truck\"\nunits = \"mm-t-s\"\nreport_units = { force = \"kN\", moment = \"kN m\", length = \"m\", mass = \"kg\" }\n\
         [model]\ndeck = \"truck.bdf\"\nmesh_error = false\n",
    );
    for (name, id) in crate::world::NAMES.iter().zip(crate::world::WHEELS) {
        text += &format!(
            "[[load]]\nname = \"{name}\"\ngrid = {id}\ncomponent = \"FZ\"\nexpected = 25000.0\n"
        );
    }
    text
}

pub fn codes(result: &serde_json::Value, severity: &str) -> Vec<String> {
    result["findings"]
        .as_array()
        .into_iter()
        .flatten()
        .filter(|f| f["severity"] == severity)
        .filter_map(|f| f["code"].as_str().map(str::to_owned))
        .collect()
}
