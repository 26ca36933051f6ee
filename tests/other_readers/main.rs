//! Other programs read the files of this project, and this project reads theirs.
//!
//! The programs are pyNastran (OP2, bulk data), meshio (VTU), openpyxl (XLSX), rpc3-file (RPC III), pyarrow (Parquet)
//! and asammdf (MDF4). Reports are opened in Chromium, and on paper by pypdf and PDFium.
//!
//! The tests need Python with these packages: the interpreter in STRAINBRIDGE_PYTHON, or `python3`. Without them,
//! `support` counts and prints a skip, or fails if STRAINBRIDGE_TESTS=required is set.

#![allow(clippy::print_stderr, reason = "states why it is skipped")]

mod coarse;
mod exchange;
#[cfg(feature = "pdf")]
mod paper;
mod plate;
mod pointing;
mod python;
mod records;
mod report;
mod solve;
#[path = "../../nastran/tests/support/mod.rs"]
mod support;
mod vehicle;
