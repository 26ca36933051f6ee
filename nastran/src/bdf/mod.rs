//! Nastran decks: reads executive control, case control and bulk data; keeps every byte; edits a deck and writes it back.

mod assemble;
mod budget;
mod bulk_scan;
mod card;
mod case;
mod chunk;
mod continuation_name;
mod deck;
mod emit;
mod fault;
mod fields;
mod include;
mod include_statement;
mod line;
mod loose_continuations;
mod merge;
mod missing_sections;
mod names;
mod number;
mod part;
mod read;
mod replicate;
mod sections;
mod source;
mod split;
mod unknown_names;
pub mod vocabulary;
mod write;

#[cfg(test)]
mod tests;

pub use case::{CaseControl, CaseLine, Request, Selection, Set, SetItem, Subcase, SubcaseKind};
pub use deck::{Deck, OtherCard};
pub use fault::{DeckFaultKind, Fault, FieldName};
pub use include::{IncludeRequest, LoadedFile, Loader, MemoryLoader};
pub use names::{Label, NameOwner};
pub use number::{Number, read_number};
pub use read::read_deck;
pub use source::{Note, Source};
pub use write::{
    EditError, Edits, Field, ToFields, format_card, format_real, shortest_real, write_deck,
    write_edited,
};
