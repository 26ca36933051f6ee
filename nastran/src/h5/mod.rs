//! HDF5 result files of MSC Nastran (NH5RDB) and of solvers that write the same tree.
//!
//! `/NASTRAN/RESULT/DOMAINS` lists subcases and steps. Every result is a table of records whose last field, DOMAIN_ID, refers to this list.
//! `/NASTRAN/RESULT/NODAL` contains nodal vectors. `/NASTRAN/RESULT/ELEMENTAL/STRAIN` and `STRESS` contain one table for each element type. Fields
//! are found by name, so a schema with additional fields can still be read. Values that the tables do not contain (principal values, von Mises of
//! shells and solids) are NaN in the rows.

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

/// Returns whether `bytes` begin with the signature of an HDF5 file.
pub fn is_h5(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89HDF\r\n\x1a\n")
}

#[cfg(test)]
mod tests;
