//! From plain results to bytes: text, json, csv, html. Nothing is computed here.

pub mod strain;
mod strains;
pub mod vehicle;
mod result_blocks;
mod strains;
mod vtu;

pub use result_blocks::for_each_block;
pub use strains::{STRAINS_HEADER, write_strains};
pub use vtu::write_vtu;
