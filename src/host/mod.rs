//! Inputs and outputs of commands: files read and checked, stored solutions, the output folder, progress, bad input, and the outcome.

pub mod context;
pub mod fault;
pub mod file_read;
pub mod files;
pub mod half_written;
pub(crate) mod manifest;
pub mod other_results;
pub mod outcome;
pub mod output;
pub(crate) mod sheet;
pub mod store;
pub(crate) mod what_is;
pub(crate) mod whole_file;
pub mod words;
pub mod work;
