//! Result tables as every reader gives them: an index of [`Block`]s, and [`Rows`] decoded one block at a time.

mod block;
pub mod columns;
mod damage;
mod element;
mod file;
mod rows;

pub use block::*;
pub use damage::*;
pub use element::*;
pub use file::*;
pub use rows::*;
