//! Columns of the table of a payload's signature.

use super::table::Table;
use super::unread::Unread;
use crate::app::files::Inputs;

/// Columns of the signature, each by its names: microstrain per mass, per mass and length along x, along y, and along both.
pub const COLUMNS: [[&str; 2]; 4] = [
    ["b0", "b0"],
    ["b_dx", "b_x"],
    ["b_dy", "b_y"],
    ["b_dxdy", "b_xy"],
];

/// Adds a finding that names the columns of a payload's signature which nothing reads.
pub fn note_unread(inputs: &mut Inputs, table: &Table, key: usize) {
    let is_read = |c: &usize| *c == key || COLUMNS.iter().flatten().any(|n| table.header[*c] == *n);
    let unread = (0..table.header.len()).filter(|c| !is_read(c));
    let unread: Vec<&str> = unread.map(|c| table.header[c].as_str()).collect();
    let lacking = COLUMNS.iter().map(|n| n[0]);
    let lacking: Vec<&str> = lacking.filter(|n| table.column(&[n]).is_none()).collect();
    if let Some(unread) = Unread::of(&unread, &lacking) {
        inputs.note(&table.file, unread.finding(&table.file));
    }
}
