//! Runs a script of `tests/python`.

use crate::support::skip;
use serde_json::Value;
use std::process::Command;
use std::sync::Mutex;

/// One browser at a time, as they draw in software.
static BROWSER: Mutex<()> = Mutex::new(());

/// Returns the JSON object that a script prints. If Python, a package or the browser is missing, prints and counts a
/// skip and returns `None`.
pub fn read_by(script: &str, arguments: &[&str]) -> Option<Value> {
    let opens = ["open_report.py", "point_report.py"].contains(&script);
    let _alone = opens.then(|| {
        BROWSER
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    });
    let python = std::env::var("STRAINBRIDGE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let path = format!("{}/tests/python/{script}", env!("CARGO_MANIFEST_DIR"));
    let Ok(read) = Command::new(python).arg(path).args(arguments).output() else {
        skip("no Python here");
        return None;
    };
    let text = String::from_utf8_lossy(&read.stdout);
    if read.status.code() == Some(77) {
        skip(text.trim());
        return None;
    }
    let Some(json) = text.lines().rfind(|l| l.starts_with('{')) else {
        panic!("{text}\n{}", String::from_utf8_lossy(&read.stderr));
    };
    Some(serde_json::from_str(json).unwrap())
}
