//! Result tables as every reader gives them: an index of [`Block`]s, and [`Rows`] decoded one block at a time.

mod block;
pub mod columns;
mod element;
mod rows;

pub use block::*;
pub use element::*;
pub use rows::*;
