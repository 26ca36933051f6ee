//! Lines of a terminal for an outcome: one table of the result, the summary, findings with the worst last, the next command, paths of files.
//!
//! The lines fit a terminal: no line is wider, and there are at most [`LINES`] of them unless all are asked for. `cli` prints them.

mod content;
mod findings;
mod layout;
mod table;
mod wrap;

pub use content::{Console, ConsoleTable, Texts};
pub use findings::FindingLines;
pub use layout::{Layout, Room, ascii, lay_out};
pub use wrap::wrap_lines;

/// Number of lines of a command, including table and findings, that a terminal shows without scrolling.
pub const LINES: usize = 25;
/// Number of columns if standard output is not a terminal.
pub const WIDTH: usize = 100;

#[cfg(test)]
mod tests;
