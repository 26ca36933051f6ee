//! HDF5 result files of MSC Nastran (NH5RDB) and of solvers that write the same tree.
//!
//! `/NASTRAN/RESULT/DOMAINS` lists subcases and steps; every result is a table of records whose last field, DOMAIN_ID, points there.
//! `/NASTRAN/RESULT/NODAL` holds nodal vectors, `/NASTRAN/RESULT/ELEMENTAL/STRAIN` and `STRESS` one table an element type.
//! Fields are found by name, so a schema that adds fields still reads. What the tables leave out (principal values, von Mises of
//! shells and solids) is NaN in the rows.

mod chunk;
mod decode;
mod domain;
mod error;
mod extent;
mod file;
mod layout;
mod table;
mod weight;

pub use error::H5Error;
pub use file::H5;

/// Whether `bytes` begin as an HDF5 file does.
pub fn is_h5(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89HDF\r\n\x1a\n")
}

#[cfg(test)]
mod tests;
