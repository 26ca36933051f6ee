//! `open`: the server of a live plan, its address on standard output, the browser.

use super::OpenArguments;
use super::progress::Terminal;
use super::reporter::Reporter;
use super::run::{Run, refuse, thread_pool};
use crate::host::context::{Progress, SilentProgress};
use crate::host::fault::Faults;
use crate::host::store::Folder;
use crate::open::{Limits, Server, Session, Surroundings};
use std::io::Write;
use std::process::{Command, ExitCode, Stdio};

/// Runs the server until no page has called for ten minutes.
pub(super) fn open(a: &OpenArguments) -> ExitCode {
    let (server, session) = match begin(a) {
        Ok(begun) => begun,
        Err(faults) => return refuse(&faults, &a.common),
    };
    let address = server.address();
    let mut out = std::io::stdout();
    // Whoever started the program may have closed its output; the browser still gets the address.
    let _ = writeln!(out, "{address}").and_then(|()| out.flush());
    let reporter = Reporter::from_arguments(&a.common);
    let for_browser = || {
        server
            .address_for_browser()
            .is_ok_and(|once| open_browser(&once))
    };
    if !a.no_browser && !for_browser() {
        reporter.note("no browser could be started: open the address above");
    }
    reporter
        .note("Ctrl-C ends the program; it also ends ten minutes after the last page was closed");
    server.run(session);
    ExitCode::SUCCESS
}

fn begin(a: &OpenArguments) -> Result<(Server, Session), Faults> {
    let server = Server::bind(a.port, Limits::default())?;
    let around = Surroundings {
        pool: thread_pool(&a.common)?,
        store: (!a.common.no_cache).then(Folder::of_user),
        out: Run::from_arguments(&a.common, &a.job).folder(&a.job),
    };
    let terminal = Terminal::default();
    let progress: &dyn Progress = match Reporter::from_arguments(&a.common).is_quiet() {
        true => &SilentProgress,
        false => &terminal,
    };
    let session = Session::begin(&a.job, around, progress)?;
    Ok((server, session))
}

/// Opens an address with the program that the system uses for it. Returns whether that could be started.
fn open_browser(address: &str) -> bool {
    let mut command = match std::env::consts::OS {
        "windows" => {
            let mut c = Command::new("rundll32");
            c.arg("url.dll,FileProtocolHandler");
            c
        }
        "macos" => Command::new("open"),
        _ => Command::new("xdg-open"),
    };
    let quiet = command.arg(address).stdin(Stdio::null());
    let quiet = quiet.stdout(Stdio::null()).stderr(Stdio::null());
    let Ok(mut child) = quiet.spawn() else {
        return false;
    };
    // The starter may live as long as the browser.
    std::thread::spawn(move || child.wait());
    true
}
