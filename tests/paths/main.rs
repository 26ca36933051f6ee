//! From files to results, through the program.

mod cases;
mod command;
mod frame;
mod placement;
mod sites;
mod wing;
