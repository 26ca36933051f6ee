//! Results of other commands in the folder of an output.

use crate::host::manifest::Manifest;
use crate::host::whole_file::load;
use std::path::Path;

/// Page of a folder that lists the results of all commands.
pub const INDEX: &str = "index.html";

/// Result of another command in the folder of an output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OtherResult {
    /// Command.
    pub command: String,
    /// File name of the report.
    pub report: String,
    /// Sentence that states the result.
    pub summary: String,
    /// Whether findings include an error.
    pub has_errors: bool,
}

/// Returns the results of other commands that a folder contains once the files of `command` are in place, sorted by command.
pub fn other_results(folder: &Path, command: &str) -> Vec<OtherResult> {
    let written = Manifest::read(folder);
    let result = |(by, names): (&str, Vec<&str>)| {
        let kept = |name: &str| format!("{by}.{name}");
        let at = |name: &str| match names.contains(&name) {
            true => Some(name.to_owned()),
            false => names.contains(&kept(name).as_str()).then(|| kept(name)),
        };
        at("report.html")?;
        let bytes = load(&folder.join(at("result.json")?)).ok()?;
        let result: serde_json::Value = serde_json::from_slice(&bytes).ok()?;
        let findings = result.get("findings").and_then(|f| f.as_array());
        let has_errors = findings.is_some_and(|f| f.iter().any(|f| f["severity"] == "error"));
        Some(OtherResult {
            has_errors,
            command: by.to_owned(),
            report: kept("report.html"),
            summary: result.get("summary")?.as_str()?.to_owned(),
        })
    };
    let others = written.of_others(command).into_iter();
    others.filter_map(result).collect()
}
