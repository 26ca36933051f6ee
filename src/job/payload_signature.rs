//! Columns of the table of a payload's signature.

use super::table::Table;
use super::unread_columns;
use crate::host::files::Inputs;

/// Columns of the signature with their possible names: microstrain per mass, per mass and length along x, along y, and along both.
pub const COLUMNS: [[&str; 2]; 4] = [
    ["b0", "b0"],
    ["b_dx", "b_x"],
    ["b_dy", "b_y"],
    ["b_dxdy", "b_xy"],
];

/// Adds a finding that names the columns of a payload's signature which nothing reads.
pub fn note_unread(inputs: &mut Inputs, table: &Table, key: usize) {
    let is_read = |c: usize| c == key || COLUMNS.iter().flatten().any(|n| table.header[c] == *n);
    let lacking = COLUMNS.iter().map(|n| n[0]);
    let lacking: Vec<&str> = lacking.filter(|n| table.column(&[n]).is_none()).collect();
    unread_columns::note_unread(inputs, table, is_read, &lacking);
}
