//! Entry point: parse the arguments, run the command, leave with its exit code.

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    strainbridge::cli::run(strainbridge::cli::Arguments::parse())
}
