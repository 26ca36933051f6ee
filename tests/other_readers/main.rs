//! Our files read by other programs, and theirs by us: pyNastran (OP2, bulk data), meshio (VTU), openpyxl (XLSX), rpc3-file (RPC III), pyarrow
//! (Parquet), asammdf (MDF4); reports in Chromium, on paper by pypdf and PDFium.
//!
//! Needs Python with these packages: the interpreter named by STRAINBRIDGE_PYTHON, else `python3`. Skipped, with a message, where they
//! are absent.

#![allow(clippy::print_stderr, reason = "says why it is skipped")]

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
