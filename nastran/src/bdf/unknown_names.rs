//! Refuses names that exist in no dialect of Nastran.

use super::deck::Deck;
use super::fault::{DeckFaultKind, Fault};
use super::fields::note_fault;
use super::sections::Statement;
use super::source::Note;
use super::vocabulary::{
    Effect, case_word, effect_of_card, executive_word, nearest_card, nearest_executive,
    nearest_parameter, nearest_word,
};
use crate::place::SourceIx;
use std::collections::BTreeSet;

/// Adds a fault for each unknown bulk data name and each unknown case control command, and a note for each misspelt parameter.
pub(super) fn check_names(deck: &mut Deck) {
    check_words(deck);
    note_parameters(deck);
    let mut seen = BTreeSet::new();
    for card in &deck.others {
        if !seen.insert(card.name.as_str()) || effect_of_card(&card.name).is_some() {
            continue;
        }
        let what = DeckFaultKind::UnknownName {
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

/// Adds a note for each name of a parameter that one letter separates from a parameter of the program.
fn note_parameters(deck: &mut Deck) {
    let bulk = deck.cards.params.iter().map(|p| (p.name.as_str(), p.at));
    let statements = deck.case_control.lines.iter();
    let stated = statements.filter(|l| !l.in_packet && l.name == "PARAM");
    let stated = stated.filter_map(|l| {
        let mut words = l
            .text
            .split([' ', '\t', ',', '='])
            .filter(|w| !w.is_empty());
        Some((words.nth(1)?, l.at))
    });
    let misspelt = bulk.chain(stated).filter_map(|(name, at)| {
        let meant = nearest_parameter(&name.to_ascii_uppercase())?;
        let text = format!("PARAM,{name} is not read: did you mean `{meant}`?");
        Some(Note { at, text })
    });
    let misspelt: Vec<Note> = misspelt.collect();
    deck.notes.extend(misspelt);
}

/// Adds a fault for each line above CEND that begins with no statement of executive control.
///
/// Lines between ALTER or COMPILE and ENDALTER are statements of another language, and a line after one that ends with a comma continues it.
pub(super) fn check_executive(statements: &[Statement], faults: &mut Vec<Fault>) {
    let (mut in_program, mut continued) = (false, false);
    for statement in statements {
        let text = statement.text.trim();
        let continues = std::mem::replace(&mut continued, text.ends_with(','));
        let mut words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        let word = words.next().unwrap_or_default().to_ascii_uppercase();
        match word.as_str() {
            _ if continues => continue,
            "ALTER" | "COMPILE" | "MALTER" | "RFALTER" | "BEGIN" | "DMAP" => in_program = true,
            "ENDALTER" | "END" => in_program = false,
            _ => {}
        }
        if in_program || word.is_empty() || executive_word(&word) {
            continue;
        }
        let what = match case_word(&word) {
            Some(known) if matches!(known.effect, Effect::None(_)) => continue,
            Some(_) => DeckFaultKind::Statement {
                found: word.clone(),
                why: "case control begins below CEND",
            },
            None => DeckFaultKind::UnknownName {
                near: nearest_executive(&word),
                cards: 1,
            },
        };
        let fault = Fault {
            at: statement.at,
            card: word,
            field: None,
            what,
        };
        note_fault(faults, fault);
    }
}

fn check_words(deck: &mut Deck) {
    // An executive statement is a fault only if the main deck has CEND and contains the statement. Elsewhere executive control is part of the first
    // section.
    let first = SourceIx(0);
    let without_cend = deck.bounds.case_start.is_none();
    for line in deck.case_control.lines.iter().filter(|l| !l.in_packet) {
        let what = match case_word(&line.name) {
            Some(word)
                if word.effect.is_executive() && !without_cend && line.at.source == first =>
            {
                DeckFaultKind::Statement {
                    found: line.name.clone(),
                    why: "executive control ends at CEND",
                }
            }
            Some(_) => continue,
            None => DeckFaultKind::UnknownName {
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
