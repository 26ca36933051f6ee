//! `check`: what is in the files, and every fault.

use super::fault::Faults;
use super::{FilesArguments, Session, job};
use std::path::Path;

/// Reads every file and reports.
pub fn run(arguments: &FilesArguments, session: &mut Session) -> Result<(), Faults> {
    let mut faults = Faults::new();
    for file in &arguments.files {
        let is_job = file
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("toml"));
        let read = if is_job {
            job::read_job(&mut session.inputs, file).map(|_| ())
        } else {
            let given = file.display().to_string();
            session
                .inputs
                .read(Path::new(""), &given)
                .map(|_| ())
                .map_err(|f| vec![f])
        };
        faults.extend(read.err().unwrap_or_default());
    }
    session.put("decks", serde_json::json!([]))?;
    session.put("results", serde_json::json!([]))?;
    session.output_if_asked()?;
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}
