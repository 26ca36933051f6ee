//! Nastran files as bytes in and tables out: bulk data, OP2, punch and HDF5. The crate computes no physics and opens no file.
//!
//! - [`bdf`] reads a deck (executive, case control, bulk data) into a [`bdf::Deck`] and writes it back line for line.
//! - [`op2`], [`punch`] and [`h5`] read results; all three give the same [`results::Block`]s and [`results::Rows`].
//! - [`cards`] holds one plain struct per card, filled from a deck or from the geometry blocks of an OP2.
//!
//! Cards contain the data of the file: a blank field is `None`, ids are the file's numbers, nothing is resolved.
#![cfg_attr(not(test), warn(clippy::print_stdout, clippy::print_stderr))]

pub mod bdf;
pub mod cards;
pub mod h5;
pub mod op2;
pub mod place;
pub mod punch;
pub mod results;

#[cfg(test)]
#[path = "../tests/support/mod.rs"]
mod support;

/// The example of README.md compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
