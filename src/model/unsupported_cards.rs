//! Cards and statements of a deck that act on the solution and have no part in the model.

use super::types::UnsupportedCard;
use nastran::bdf::vocabulary::{CaseWord, Effect, case_word, effect_of_card};
use nastran::bdf::{CaseLine, Deck};
use nastran::cards::{Cards, UnreadEntry};
use nastran::place::{Place, PlacedCard};

/// Solution sequences and rigid formats of linear statics, modes, buckling, flutter, frequency response and transient response. All of them use the
/// stiffness, mass and static loads that this program uses.
const LINEAR: [u32; 39] = [
    1, 2, 3, 5, 7, 8, 9, 10, 11, 12, 24, 25, 26, 27, 28, 29, 30, 31, 61, 63, 65, 67, 68, 69, 70,
    71, 72, 101, 103, 105, 107, 108, 109, 110, 111, 112, 118, 145, 200,
];
/// Solution sequences of buckling, whose preload STATSUB names.
const BUCKLING: [u32; 3] = [5, 65, 105];
/// Solution sequences of random and gust response, which are linear too.
const GUST: [u32; 3] = [146, 187, 190];

/// Returns unsupported cards that act on the solution: elements, masses, constraints, statements of case control and the solution sequence. The
/// second list contains loads, which act only if their set is selected.
pub(super) fn of_deck(deck: &Deck) -> (Vec<UnsupportedCard>, Vec<UnsupportedCard>) {
    let mut structure: Vec<UnsupportedCard> = sequence(deck).into_iter().collect();
    structure.extend(program_changes(deck));
    structure.extend(large_displacement(deck));
    structure.extend(statements(deck));
    structure.extend(superelements(deck));
    let mut loads = Vec::new();
    for c in &deck.others {
        let card = UnsupportedCard {
            card: c.name.clone(),
            id: c.first,
            at: c.at,
        };
        match effect_of_card(&c.name) {
            Some(Effect::Load) => loads.push(card),
            Some(Effect::Acts | Effect::Carried) => structure.push(card),
            Some(Effect::ActsWith("separate values")) => {
                structure.extend(super::model_parameters::find_acting_parameters(deck, c));
            }
            Some(Effect::ActsWith(what)) if is_present(deck, what) => structure.push(card),
            _ => {}
        }
    }
    (structure, loads)
}

/// Returns the unsupported cards like [`of_deck`], for the geometry blocks of an OP2.
pub(super) fn of_records(cards: &Cards) -> (Vec<UnsupportedCard>, Vec<UnsupportedCard>) {
    let (loads, structure): (Vec<_>, Vec<_>) = cards.unread.iter().partition(|e| e.is_load);
    let unsupported = |entries: Vec<&PlacedCard<UnreadEntry>>| {
        let all = entries.into_iter().map(|e| UnsupportedCard {
            card: e.name.clone(),
            id: e.id,
            at: e.at,
        });
        all.collect()
    };
    (unsupported(structure), unsupported(loads))
}

/// The solution sequence, or the approach, where it is not linear.
fn sequence(deck: &Deck) -> Option<UnsupportedCard> {
    let unsupported = |card: String, at: Place| UnsupportedCard { card, id: None, at };
    if let Some((approach, at)) = &deck.approach
        && ["HEAT", "DMAP"].iter().any(|a| approach.starts_with(a))
    {
        return Some(unsupported(format!("APP {approach}"), *at));
    }
    let text = deck.sol_text.as_ref()?;
    let is_linear = |n: &u32| LINEAR.contains(n) || GUST.contains(n);
    (!deck.sol.as_ref().is_some_and(is_linear))
        .then(|| unsupported(format!("SOL {text}"), deck.sol_at))
}

/// Returns the statements above CEND that change the solution sequence or start from an earlier run.
fn program_changes(deck: &Deck) -> impl Iterator<Item = UnsupportedCard> {
    deck.program_changes.iter().map(|c| UnsupportedCard {
        card: c.text.clone(),
        id: None,
        at: c.at,
    })
}

/// PARAM,LGDISP where it asks for large displacements.
fn large_displacement(deck: &Deck) -> Option<UnsupportedCard> {
    let asks = |p: &nastran::cards::Param| {
        let value = p.values.first().and_then(|v| v.as_f64());
        p.name == "LGDISP" && value.is_some_and(|v| v > 0.0)
    };
    let case_control = &deck.case_control;
    let cases = std::iter::once(&case_control.global).chain(&case_control.subcases);
    let stated = cases.flat_map(|c| &c.params).any(asks);
    let bulk = deck.cards.params.iter().find(|p| asks(&p.card));
    (stated || bulk.is_some()).then(|| UnsupportedCard {
        card: "PARAM LGDISP".to_owned(),
        id: None,
        at: bulk.map_or(deck.sol_at, |p| p.at),
    })
}

/// Statements of case control that act.
fn statements(deck: &Deck) -> impl Iterator<Item = UnsupportedCard> {
    let lines = deck.case_control.lines.iter().filter(|l| !l.in_packet);
    lines.filter_map(|line| {
        let word = case_word(&line.name)?;
        let value = value_of(line);
        acts(deck, word, &value).then(|| UnsupportedCard {
            card: match word.name {
                "ANALYSIS" => format!("ANALYSIS = {value}"),
                name => name.to_owned(),
            },
            id: value.parse().ok(),
            at: line.at,
        })
    })
}

/// Returns the text after the last `=`, or after the word, in upper case.
fn value_of(line: &CaseLine) -> String {
    let value = match line.text.rsplit_once('=') {
        Some((_, value)) => value,
        None => line.text.get(line.name.len()..).unwrap_or_default(),
    };
    value.trim().to_ascii_uppercase()
}

fn acts(deck: &Deck, word: CaseWord, value: &str) -> bool {
    if word.name == "ANALYSIS" {
        // Heat transfer, nonlinear statics and transients. Static aeroelasticity is detected by TRIM.
        let kinds = ["HEAT", "HSTAT", "HTRAN", "NL", "RCNS", "RCTRN", "EXP"];
        return kinds.iter().any(|k| value.starts_with(k));
    }
    let preload = word.name == "STATSUB" && deck.sol.is_some_and(|s| BUCKLING.contains(&s));
    word.effect == Effect::Acts && !preload && !["NONE", "NO", "0"].contains(&value)
}

/// Returns bulk data of superelements and modules that is not read. Models for optimisation and acoustics do not belong to the structure.
fn superelements(deck: &Deck) -> impl Iterator<Item = UnsupportedCard> {
    const ASIDE: [&str; 5] = ["AUXMODEL", "ARBMODEL", "UDS", "TRMC", "FLXSLI"];
    let parts = deck.parts.iter();
    parts
        .filter(|p| ASIDE.iter().all(|a| !p.text.contains(a)))
        .map(|p| UnsupportedCard {
            card: p.text.clone(),
            id: None,
            at: p.at,
        })
}

/// Returns whether the deck has what a card acts with.
fn is_present(deck: &Deck, what: &str) -> bool {
    if what == "connectors" {
        return !(deck.cards.welds.is_empty() && deck.cards.fasteners.is_empty());
    }
    let lines = deck.case_control.lines.iter().filter(|l| !l.in_packet);
    let words = lines.filter_map(|l| case_word(&l.name));
    words.into_iter().any(|w| w.name == what)
}
