//! Our files read by other programs, and theirs by us: pyNastran (OP2, bulk data), meshio (VTU), openpyxl (XLSX), rpc3-file (RPC III), pyarrow
//! (Parquet), asammdf (MDF4); reports in Chromium, on paper by pypdf and PDFium.
//!
//! Needs Python with these packages: the interpreter named by STRAINBRIDGE_PYTHON, else `python3`. Skipped, said and
//! counted as `support` does, where they are absent; with STRAINBRIDGE_TESTS=required that is a failure.

#![allow(clippy::print_stderr, reason = "says why it is skipped")]

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
