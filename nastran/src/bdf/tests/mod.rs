//! Decks that test one rule each. The rules come from the quick reference guides.

mod cards;
mod case_control;
mod continuations;
mod edits;
mod extra_fields;
mod faults;
mod fields;
mod foreign;
mod includes;
mod names;
mod numbers;
mod replication;
mod vocabulary;

use super::{Deck, MemoryLoader, read_deck};

/// Reads text that has only bulk data.
fn bulk(text: &str) -> Deck {
    read_deck(
        "test.bdf",
        text.as_bytes().to_vec(),
        &mut MemoryLoader::default(),
    )
}

/// Reads bulk data that must be free of faults.
fn read_clean_deck(text: &str) -> Deck {
    let deck = bulk(text);
    assert_eq!(fault_texts(&deck), Vec::<String>::new());
    deck
}

fn fault_texts(deck: &Deck) -> Vec<String> {
    deck.faults
        .iter()
        .map(|f| f.show(&deck.sources).to_string())
        .collect()
}
