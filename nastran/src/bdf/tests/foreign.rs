//! Texts that are not decks: the fault quotes no part of them.

use super::super::{DeckFaultKind, MemoryLoader, read_deck};
use super::fault_texts;

fn read(main: &str, included: &str) -> Vec<String> {
    let mut loader = MemoryLoader::default();
    loader
        .files
        .insert("/etc/accounts".to_owned(), included.as_bytes().to_vec());
    let deck = read_deck("main.bdf", main.as_bytes().to_vec(), &mut loader);
    fault_texts(&deck)
}

#[test]
fn a_text_that_is_no_deck_is_called_that_and_not_shown() {
    for text in [
        "",
        "hello\n",
        "root:x:0:0:secret\nhello world\n",
        "{\"a\": 1}\n",
    ] {
        let deck = read_deck(
            "notes.txt",
            text.as_bytes().to_vec(),
            &mut MemoryLoader::default(),
        );
        assert_eq!(deck.faults.len(), 1, "{text}");
        assert_eq!(deck.faults[0].what, DeckFaultKind::NotADeck, "{text}");
        assert!(deck.others.is_empty() && deck.counts.is_empty(), "{text}");
    }
}

#[test]
fn an_included_file_that_is_no_deck_is_not_shown() {
    let faults = read(
        "BEGIN BULK\nINCLUDE '/etc/accounts'\nGRID,1\nENDDATA\n",
        "root:x:0:0:secret\n*secret, more\n",
    );
    assert!(!faults.is_empty());
    assert!(faults.iter().all(|f| !f.contains("secret")), "{faults:?}");
    assert!(faults[0].starts_with("/etc/accounts:1:"), "{faults:?}");
}
