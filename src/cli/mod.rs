//! The command line: the only place that reads files, writes files and prints.
//!
//! One file a command; what they share:
//! [`Session`] (options, inputs, stages, findings, output of one command), [`files`] (reading), [`output`] (writing),
//! [`fault`] (bad input), [`job`] (job.toml and the tables it names).

mod arguments;
mod ballast;
mod cases;
mod check;
pub mod deck;
mod demo;
pub mod fault;
pub mod files;
mod identify;
mod init;
mod interrupt;
pub mod job;
pub mod output;
mod paper;
mod payload;
mod place;
mod progress;
mod reconcile;
mod recover;
mod respond;
mod scene;
mod sensitivity;
mod session;
mod solution_cache;
mod solve;
mod solved;
mod spreadsheets;
mod strain;
mod strains;
mod study;
pub mod vehicle;
mod wheels;
mod words;

pub use arguments::*;
pub use session::*;

use clap::CommandFactory;
use std::io::Write;
use std::process::ExitCode;

/// Runs the command and returns the exit code: 0 done, 1 done with error findings, 2 bad input.
pub fn run(arguments: Arguments) -> ExitCode {
    interrupt::watch();
    match arguments.command {
        Command::Strains(a) => Session::run("strains", &a.common, |s| strains::run(&a, s)),
        Command::Check(a) => Session::run("check", &a.common, |s| check::run(&a, s)),
        Command::Init(a) => Session::run("init", &a.common, |s| init::run(&a, s)),
        Command::Cases(a) => Session::run("cases", &a.common, |s| cases::run(&a, s)),
        Command::Place(a) => Session::run("place", &a.common, |s| place::run(&a, s)),
        Command::Recover(a) => Session::run("recover", &a.common, |s| recover::run(&a, s)),
        Command::Sensitivity(a) => {
            Session::run("sensitivity", &a.common, |s| sensitivity::run(&a, s))
        }
        Command::Ballast(a) => Session::run("ballast", &a.common, |s| ballast::run(&a, s)),
        Command::Payload(a) => Session::run("payload", &a.common, |s| payload::run(&a, s)),
        Command::Respond(a) => Session::run("respond", &a.common, |s| respond::run(&a, s)),
        Command::Study(a) => Session::run("study", &a.common, |s| study::run(&a, s)),
        Command::Demo(a) => Session::run("demo", &a.common, |s| demo::run(&a, s)),
        Command::Solve(a) => Session::run("solve", &a.job.common, |s| {
            solve::run(&a.job, a.heated(), s)
        }),
        Command::Reconcile(a) => Session::run("reconcile", &a.common, |s| reconcile::run(&a, s)),
        Command::Identify(a) => Session::run("identify", &a.common, |s| identify::run(&a, s)),
        Command::Schema => print(job::schema::job_schema().as_bytes()),
        Command::Completions(a) => {
            let mut text = Vec::new();
            clap_complete::generate(
                a.shell,
                &mut Arguments::command(),
                "strainbridge",
                &mut text,
            );
            print(&text)
        }
    }
}

/// Prints text that is the whole answer.
fn print(text: &[u8]) -> ExitCode {
    // A closed pipe (`| head`) is no fault of ours.
    let _ = std::io::stdout().write_all(text);
    ExitCode::SUCCESS
}
