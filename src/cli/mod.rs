//! The command line: the only place that reads files, writes files and prints.
//!
//! One file a command; what they share:
//! [`Session`] (options, inputs, stages, findings, output of one command), [`files`] (reading), [`output`] (writing),
//! [`fault`] (bad input), [`job`] (job.toml and the tables it names).

mod arguments;
mod cases;
mod check;
pub mod deck;
pub mod fault;
pub mod files;
mod identify;
mod init;
pub mod job;
pub mod output;
mod place;
mod progress;
mod reconcile;
mod recover;
mod sensitivity;
mod session;
mod solve;
mod strain;
mod strains;
pub mod vehicle;
mod words;

pub use arguments::*;
pub use session::*;

use std::process::ExitCode;

/// Runs the command and returns the exit code: 0 done, 1 done with error findings, 2 bad input.
pub fn run(arguments: Arguments) -> ExitCode {
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
        Command::Solve(a) => Session::run("solve", &a.common, |s| solve::run(&a, s)),
        Command::Reconcile(a) => Session::run("reconcile", &a.common, |s| reconcile::run(&a, s)),
        Command::Identify(a) => Session::run("identify", &a.common, |s| identify::run(&a, s)),
    }
}
