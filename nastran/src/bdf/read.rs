//! Reads a deck.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicUsize;

use super::budget::BUDGET;
use super::case;
use super::chunk::read_chunks;
use super::continuation_name::{ContinuationNames, find_unclaimed};
use super::deck::Deck;
use super::fault::{DeckFaultKind, Fault};
use super::fields::MAX_FAULTS;
use super::include::Loader;
use super::line::text_of;
use super::loose_continuations::{PendingContinuations, resolve};
use super::merge::append;
use super::part::Part;
use super::sections::{Statement, read_sections};
use super::source::{Chunk, Note, Position, Source};
use super::unknown_names::{check_executive, check_names};
use super::vocabulary::changes_program;
use crate::place::Place;

/// Reads the deck in `bytes` with all files that it includes. [`Deck::faults`] lists everything that cannot be read.
///
/// `main_path` is the name of the main deck in messages; relative INCLUDE names start at its folder.
///
/// # Example
/// ```
/// use nastran::bdf::{MemoryLoader, read_deck};
///
/// let text = "SOL 101\nCEND\nBEGIN BULK\nGRID    7               1.5-1   2.      .5\nGRID,8,,0.,0.,x\nENDDATA\n";
/// let deck = read_deck("frame.bdf", text.into(), &mut MemoryLoader::default());
/// assert_eq!(deck.sol, Some(101));
/// let grid = &deck.cards.grids[0];
/// assert_eq!((grid.id, grid.x), (7, [0.15, 2.0, 0.5]));
/// // A blank field is `None`, and no default is filled in.
/// assert_eq!((grid.cp, grid.at.line), (None, 4));
/// assert_eq!(deck.faults.len(), 1);
/// assert_eq!(deck.faults[0].at.line, 5);
/// ```
pub fn read_deck(main_path: &str, bytes: Vec<u8>, loader: &mut dyn Loader) -> Deck {
    let sections = read_sections(main_path, bytes, loader);
    let Part {
        cards,
        counts,
        others,
        faults,
        notes,
        labels,
        ..
    } = read_bulk(&sections.chunks, &sections.sources);
    let mut deck = Deck {
        cards,
        counts: counts
            .iter()
            .map(|(name, n)| (text_of(name.as_bytes()), *n))
            .collect::<BTreeMap<_, _>>(),
        others,
        labels,
        bounds: sections.bounds,
        ..Deck::default()
    };
    if sections.bounds.enddata.is_some() {
        deck.counts.insert("ENDDATA".to_owned(), 1);
    }
    read_sol(&sections.executive, &mut deck);
    read_sol(&sections.case, &mut deck);
    deck.program_changes = program_changes(&sections.executive);
    if sections.bounds.case_start.is_some() {
        check_executive(&sections.executive, &mut deck.faults);
    } else {
        // Without CEND, executive control is part of the first section. There, RESTART is a case control command.
        let changes = program_changes(&sections.case);
        let changes = changes.into_iter().filter(|c| c.text != "RESTART");
        deck.program_changes.extend(changes);
    }
    deck.case_control = case::read_case_control(&sections.case, &mut deck.faults);
    deck.faults.extend(sections.faults);
    // In a text that is not a deck every line is a fault. One fault replaces them all, and none of the text is quoted.
    let nameless = |f: &Fault| f.card.is_empty();
    if deck.is_empty() && deck.faults.is_empty() && faults.iter().all(nameless) {
        deck.others.clear();
        deck.counts.clear();
        deck.faults.push(Fault {
            at: Place {
                line: 1,
                ..Place::default()
            },
            card: String::new(),
            field: None,
            what: DeckFaultKind::NotADeck,
        });
    } else {
        deck.faults.extend(faults);
    }
    deck.parts = sections.parts;
    deck.notes.extend(sections.notes);
    deck.notes.extend(notes);
    check_names(&mut deck);
    refuse_several_defaults(&mut deck);
    if deck.faults.len() >= MAX_FAULTS {
        let text = format!("only {MAX_FAULTS} faults are listed, there are more");
        deck.notes.push(Note {
            at: Place::default(),
            text,
        });
    }
    deck.sources = sections.sources;
    deck
}

/// Adds a fault if a deck has several cards of defaults, of which it may have one.
fn refuse_several_defaults(deck: &mut Deck) {
    let cards = &deck.cards;
    let places = [
        ("GRDSET", cards.grdset.as_ref().map(|c| c.at)),
        ("BAROR", cards.baror.as_ref().map(|c| c.at)),
        ("BEAMOR", cards.beamor.as_ref().map(|c| c.at)),
    ];
    for (name, at) in places {
        let n = deck.counts.get(name).copied().unwrap_or(0);
        if let Some(at) = at.filter(|_| n > 1) {
            deck.faults.push(Fault {
                at,
                card: name.to_owned(),
                field: None,
                what: DeckFaultKind::Statement {
                    found: format!("{n} cards"),
                    why: "a deck may contain one card of this name",
                },
            });
        }
    }
}

/// Returns the statements that change the solution sequence or start from an earlier run.
fn program_changes(statements: &[Statement]) -> Vec<Note> {
    let named = statements.iter().map(|s| {
        let mut words = s.text.split(|c: char| !c.is_ascii_alphanumeric());
        let first = words.find(|w| !w.is_empty()).unwrap_or_default();
        (first.to_ascii_uppercase(), s.at)
    });
    let changes = named.filter(|(word, _)| changes_program(word));
    changes.map(|(text, at)| Note { at, text }).collect()
}

/// Reads the cards; continuations of a card may be anywhere in the deck.
fn read_bulk(chunks: &[Chunk], sources: &[Source]) -> Part {
    let mut budget = AtomicUsize::new(BUDGET);
    let mut part = read_chunks(chunks, sources, &budget, &ContinuationNames::default());
    if !part.loose.is_empty() {
        let claimed = find_unclaimed(&part.loose, sources);
        budget = AtomicUsize::new(BUDGET);
        part = read_chunks(chunks, sources, &budget, &claimed);
    }
    if !part.deferred.is_empty() || !part.orphans.is_empty() {
        let deferred = std::mem::take(&mut part.deferred);
        let mut orphans = std::mem::take(&mut part.orphans);
        let loose = PendingContinuations {
            deferred: &deferred,
            orphans: &mut orphans,
            chunks,
            sources,
        };
        let late = resolve(loose, &budget);
        append(&mut part, late);
    }
    part
}

/// Reads the solution from `SOL 101`, `SOL 2,1`, `SOL SESTATIC`, and the approach from `APP HEAT`.
fn read_sol(statements: &[Statement], deck: &mut Deck) {
    for statement in statements {
        let text = statement.text.trim();
        let mut words = text.split([' ', '\t', ',', '=']).filter(|w| !w.is_empty());
        if words.next().is_some_and(|w| w.eq_ignore_ascii_case("APP")) {
            let approach = words.next().map(str::to_ascii_uppercase);
            deck.approach = approach.map(|a| (a, statement.at));
        }
        let Some(rest) = text
            .get(3..)
            .filter(|_| text.get(..3).is_some_and(|s| s.eq_ignore_ascii_case("SOL")))
        else {
            continue;
        };
        if !rest.starts_with([' ', '\t', ',', '=']) || deck.sol_text.is_some() {
            continue;
        }
        let value = rest.trim_start_matches([' ', '\t', ',', '=']).trim();
        let word = value
            .split([',', ' ', '\t'])
            .next()
            .unwrap_or_default()
            .to_ascii_uppercase();
        deck.sol = word.parse().ok().or_else(|| named_solution(&word));
        deck.sol_text = Some(value.to_owned());
        deck.sol_at = statement.at;
        let source = statement.at.source.0 as usize;
        deck.bounds.sol = Some((
            Position {
                source,
                offset: statement.start,
            },
            statement.end,
        ));
    }
}

fn named_solution(name: &str) -> Option<u32> {
    Some(match name {
        // Autodesk writes LINEAR STATIC and NORMAL MODES.
        "SESTATIC" | "SESTATICS" | "STATIC" | "STATICS" | "LINEAR" => 101,
        "SEMODES" | "MODES" | "NORMAL" | "MODAL" => 103,
        "SEBUCKL" | "BUCKLING" => 105,
        "NLSTATIC" | "NLSTATICS" => 106,
        "SEDCEIG" => 107,
        "SEDFREQ" => 108,
        "SEDTRAN" => 109,
        "SEMCEIG" => 110,
        "SEMFREQ" => 111,
        "SEMTRAN" => 112,
        "CYCSTATX" | "CYCSTAT" => 114,
        "CYCMODE" | "CYCMODES" => 115,
        "NLTRAN" => 129,
        "SEFLUTTR" => 145,
        "NONLIN" => 400,
        _ => return None,
    })
}
