//! Punch files: the 80-column text that `DISPLACEMENT(PUNCH)`, `STRAIN(PUNCH)` and similar requests write.
//!
//! A block is a header of `$` lines (TITLE, SUBTITLE, LABEL, quantity, kind of numbers, SUBCASE ID, ELEMENT TYPE ..), followed by entries. An entry
//! is one line and its `-CONT-` lines. Columns 1 to 18 contain the id, then a line has three slots of 18 columns; columns 73 to 80 number the lines.
//! An element entry contains the values of an OP2 row in the same order.

mod decode;
mod entry;
mod error;
mod file;
mod header;

pub use error::PunchError;
pub use file::Punch;

#[cfg(test)]
mod tests;
