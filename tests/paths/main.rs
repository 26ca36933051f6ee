//! From files to results, through the program.

mod command;
mod frame;
mod wing;
