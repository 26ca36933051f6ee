//! The checked, immutable model. `id` is a number of the file; `..Ix` is an index into our arrays.

mod constraint;
mod index;
mod joint;
mod load;
mod mesh;
mod model;
mod params;
mod property;
mod unsupported_card;

pub use constraint::*;
pub use index::*;
pub use joint::*;
pub use load::*;
pub use mesh::*;
pub use model::*;
pub use params::*;
pub use property::*;
pub use unsupported_card::*;
