//! Refuses names that no dialect of Nastran has.

use super::deck::Deck;
use super::fault::{Fault, Wrong};
use super::fields::note_fault;
use super::source::Note;
use super::vocabulary::{Effect, case_word, effect_of_card, nearest_card, nearest_word};
use crate::place::SourceIx;
use std::collections::BTreeSet;

/// Adds a fault for each unknown name of bulk data and each unknown word of case control, and a note for each misspelt word that is
/// read by its first four letters.
pub(super) fn check_names(deck: &mut Deck) {
    check_words(deck);
    let mut seen = BTreeSet::new();
    for card in &deck.others {
        if effect_of_card(&card.name).is_some() || !seen.insert(card.name.as_str()) {
            continue;
        }
        let what = Wrong::UnknownName {
            near: nearest_card(&card.name),
            cards: deck.counts.get(&card.name).copied().unwrap_or(1),
        };
        let fault = Fault {
            at: card.at,
            card: card.name.clone(),
            field: None,
            what,
        };
        note_fault(&mut deck.faults, fault);
    }
}

fn check_words(deck: &mut Deck) {
    // Without CEND in the first file executive control is part of the first section, and so is that of an included file.
    let first = SourceIx(0);
    let without_cend = deck.bounds.case_start.is_none();
    for line in deck.case_control.lines.iter().filter(|l| !l.in_packet) {
        let what = match case_word(&line.name) {
            Some(word)
                if word.effect == Effect::Executive && !without_cend && line.at.source == first =>
            {
                Wrong::Statement {
                    found: line.name.clone(),
                    why: "executive control ends at CEND",
                }
            }
            Some(word) if word.misspelt => {
                let text = format!("`{}` is read as {}", line.name, word.name);
                deck.notes.push(Note { at: line.at, text });
                continue;
            }
            Some(_) => continue,
            None => Wrong::UnknownName {
                near: nearest_word(&line.name),
                cards: 1,
            },
        };
        let fault = Fault {
            at: line.at,
            card: line.name.clone(),
            field: None,
            what,
        };
        note_fault(&mut deck.faults, fault);
    }
}
