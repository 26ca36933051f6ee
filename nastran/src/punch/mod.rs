//! Punch files: the 80-column text that `DISPLACEMENT(PUNCH)`, `STRAIN(PUNCH)` and the like write.
//!
//! A block is a header of `$` lines (TITLE, SUBTITLE, LABEL, quantity, kind of numbers, SUBCASE ID, ELEMENT TYPE ..) and entries of
//! one line and its `-CONT-` lines. Columns 1 to 18 hold the id, then three slots of 18 columns a line; columns 73 to 80 number the lines.
//! Element entries hold the same words in the same order as an OP2 row.

mod decode;
mod entry;
mod error;
mod file;
mod header;

pub use error::PunchError;
pub use file::Punch;

#[cfg(test)]
mod tests;
