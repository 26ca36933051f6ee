//! From plain results to bytes: text, json, csv, html. Nothing is computed here.

pub mod strain;
mod strains;
pub mod vehicle;

pub use strains::{STRAINS_HEADER, write_strains};
