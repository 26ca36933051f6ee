//! What a command meets outside: files read and checked, kept solutions, the output folder, progress, bad input, and the outcome it gives.

pub mod context;
pub mod fault;
pub mod file_read;
pub mod files;
pub mod half_written;
pub(crate) mod manifest;
pub mod outcome;
pub mod output;
pub(crate) mod sheet;
pub mod store;
pub(crate) mod what_is;
pub(crate) mod whole_file;
pub mod words;
pub mod work;
