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

/// Lines of a command, the table and the findings included: a terminal shows them without scrolling.
pub const LINES: usize = 25;
/// Columns where standard output is not a terminal.
pub const WIDTH: usize = 100;

#[cfg(test)]
mod tests;
