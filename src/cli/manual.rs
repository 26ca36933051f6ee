//! Man pages, one for each command.

use super::Arguments;
use super::arguments::ManArguments;
use super::run::refuse;
use crate::host::fault::Fault;
use crate::host::output::Output;
use clap::CommandFactory;
use std::process::ExitCode;

/// Writes `strainbridge.1`, `strainbridge-place.1` and so on.
pub(super) fn man(a: &ManArguments) -> ExitCode {
    match write(a) {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => refuse(&fault.into(), &a.common),
    }
}

fn write(a: &ManArguments) -> Result<(), Fault> {
    let mut out = Output::begin(&a.folder)?;
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    let commands = program.get_subcommands();
    for command in std::iter::once(&program).chain(commands) {
        let page = clap_mangen::Man::new(command.clone());
        out.write(&page.get_filename(), |mut w| page.render(&mut w))?;
    }
    out.rename_all()
}
