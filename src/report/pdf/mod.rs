//! A page as PDF, by Typst: its blocks become plain data, which a fixed template lays out. No text of a user is ever read as markup.

mod columns;
mod content;
mod glyphs;
mod shapes;
mod world;

pub use content::Origin;
pub use world::{PdfError, write_pdf};

#[cfg(test)]
mod tests;
