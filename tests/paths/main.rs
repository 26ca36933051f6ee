//! From files to results, through the program.

mod cases;
mod command;
mod frame;
mod placement;
mod sites;
#[path = "../../nastran/tests/support/mod.rs"]
mod support;
mod wing;
