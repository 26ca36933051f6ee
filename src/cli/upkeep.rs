//! `verify` and `clean`: work on existing results and stored solutions.

use super::arguments::{CleanArguments, VerifyArguments};
use super::reporter::print;
use super::run::{Run, refuse};
use crate::host::fault::{Fault, Faults};
use crate::host::store::Folder;
use crate::host::words::count_of;
use crate::workflow::verify::ResultProvenance;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// Runs the command of a folder again with another output folder, and compares both folders.
pub(super) fn verify(a: &VerifyArguments) -> ExitCode {
    // Jobs that a command writes contain paths relative to their folder. The scratch folder is next to the given folder, so these paths agree.
    let folder = std::fs::canonicalize(&a.folder).unwrap_or_else(|_| a.folder.clone());
    let beside = format!(".strainbridge-verify-{}", std::process::id());
    let scratch = Scratch(folder.with_file_name(beside));
    Run::from_arguments(&a.common, &a.folder).question(a.common.out.as_deref(), |cx| {
        let anew =
            |made: &ResultProvenance, main: &Path| rerun_command(&a.folder, made, main, &scratch.0);
        crate::workflow::verify::verify(&a.folder, anew, cx)
    })
}

/// Runs the command again in a separate process, so that no state of this process affects the answer.
fn rerun_command(
    folder: &Path,
    made: &ResultProvenance,
    main: &Path,
    out: &Path,
) -> Result<PathBuf, Faults> {
    let fault = |wrong: String, remedy: &str| {
        Faults::from(Fault::new(
            folder.display().to_string(),
            "inputs",
            wrong,
            remedy,
        ))
    };
    let program =
        std::env::current_exe().map_err(|e| fault(e.to_string(), "call it by its path"))?;
    let mut command = Command::new(program);
    command.arg(&made.command).arg(main);
    if made.command == "strains" {
        command.args(made.results());
    }
    if !made.records.is_empty() {
        // The files go to standard input as a list, because a call with thousands of names is too long for some systems.
        command.args(["--files", "-"]);
    }
    command.args(["--no-cache", "--out"]).arg(out);
    let failed = |e: std::io::Error| fault(e.to_string(), "call `verify` again");
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(failed)?;
    let list: String = made.records.iter().map(|r| format!("{r}\n")).collect();
    if let Some(mut input) = child.stdin.take() {
        // A command that ended early does not read the list and reports the reason.
        let _ = input.write_all(list.as_bytes());
    }
    let done = child.wait_with_output().map_err(failed)?;
    if out.join("result.json").is_file() {
        return Ok(out.to_owned());
    }
    let said = String::from_utf8_lossy(&done.stderr);
    let first = said
        .lines()
        .next()
        .unwrap_or("nothing was written")
        .to_owned();
    Err(fault(
        format!("`{} {}` now fails: {first}", made.command, main.display()),
        "restore the inputs",
    ))
}

/// A folder that is removed when it is no longer needed.
struct Scratch(PathBuf);

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Returns whether a person at the terminal agrees; `None` if no person is there to ask.
fn agrees(question: &str) -> Option<bool> {
    if !(std::io::stdin().is_terminal() && std::io::stderr().is_terminal()) {
        return None;
    }
    let mut terminal = std::io::stderr();
    write!(terminal, "{question} [y/N] ").ok()?;
    terminal.flush().ok()?;
    let mut answer = String::new();
    std::io::stdin().read_line(&mut answer).ok()?;
    Some(matches!(answer.trim(), "y" | "Y" | "yes"))
}

/// Removes kept solutions, after a question or with `--yes`.
pub(super) fn clean(a: &CleanArguments) -> ExitCode {
    let folder = a.folder.as_ref().map_or_else(Folder::of_user, Folder::new);
    let shown = folder.path().display().to_string();
    let (n, bytes) = folder.size();
    let solutions = count_of(n, "stored solution");
    let what = format!("{solutions} in `{shown}`, {:.1} MB", bytes as f64 / 1e6);
    if !a.yes {
        match agrees(&format!("Remove {what}?")) {
            Some(true) => {}
            Some(false) => return print(b"nothing is removed\n"),
            None => {
                let wrong = format!("{what}: the command needs a terminal to ask for confirmation");
                let fault = Fault::new(shown, "clean", wrong, "run the command with `--yes`");
                return refuse(&fault.into(), &a.common);
            }
        }
    }
    match folder.clean() {
        Ok((n, bytes)) if a.common.json => {
            let json = serde_json::json!({ "command": "clean", "folder": shown, "removed": n, "bytes": bytes });
            print(format!("{json:#}\n").as_bytes())
        }
        Ok((n, bytes)) => {
            let solutions = count_of(n, "stored solution");
            let megabytes = bytes as f64 / 1e6;
            print(format!("{solutions} removed from `{shown}`, {megabytes:.1} MB\n").as_bytes())
        }
        Err(e) => refuse(
            &Fault::new(
                shown,
                "clean",
                format!("the file cannot be removed ({e})"),
                "check the permissions",
            )
            .into(),
            &a.common,
        ),
    }
}
