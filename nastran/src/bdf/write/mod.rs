//! Writes cards, and decks with edits; bytes that no edit touches stay unchanged.

mod card;
mod case_edit;
mod edit;
mod fields;
mod real_format;

pub use card::{Field, format_card};
pub use edit::{EditError, Edits, write_deck, write_edited};
pub use fields::ToFields;
pub use real_format::{format_real, shortest_real};
