//! References to cards without a struct of their own: a message names the existing card and does not report it as missing.

use super::fault::{FaultKind, ModelFault};
use super::types::{Model, UnsupportedCard};
use nastran::bdf::vocabulary::effect_of_card;
use nastran::bdf::{Deck, OtherCard};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Kind of object that a card defines under its id.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum ObjectKind {
    Grid,
    Frame,
    Material,
    Property,
    Element,
}

/// Cards that generate grids and elements; no field contains their ids.
const GENERATORS: [&str; 5] = ["GRIDG", "CGEN", "EGRID", "FEEDGE", "GMCURV"];

/// Entries that begin with P and define no property of an element.
const NO_PROPERTIES: [&str; 16] = [
    "PARAM", "PARTN", "PLOTEL", "PLY", "POINT", "POINTAX", "PRESAX", "PRESPT", "PSET", "PVAL",
    "PBUSHT", "PDAMPT", "PELAST", "PFASTT", "PBSH2DT", "PCONV",
];

/// Replaces references to a missing card by a fault of the unsupported card with this id. The built-in solver refuses this card.
pub(super) fn name_cards(
    deck: &Deck,
    model: &mut Model,
    faults: Vec<ModelFault>,
) -> Vec<ModelFault> {
    let is_missing = |f: &ModelFault| matches!(f.kind, FaultKind::Missing { .. });
    if deck.others.is_empty() || !faults.iter().any(is_missing) {
        return faults;
    }
    let cards = by_id(deck);
    let generator = deck
        .others
        .iter()
        .find(|c| GENERATORS.contains(&c.name.as_str()));
    let mut users: BTreeMap<(nastran::place::Place, &'static str), Vec<ModelFault>> =
        BTreeMap::new();
    let mut named: HashMap<nastran::place::Place, &OtherCard> = HashMap::new();
    let mut out = Vec::with_capacity(faults.len());
    for fault in faults {
        match card_of(&fault.kind, deck, &cards, generator) {
            // The fault that reports the unknown name is sufficient.
            Some((_, card)) if effect_of_card(&card.name).is_none() => {}
            Some((what, card)) => {
                named.insert(card.at, card);
                users.entry((card.at, what)).or_default().push(fault);
            }
            None => out.push(fault),
        }
    }
    for ((at, what), references) in users {
        let (Some(card), Some(first)) = (named.get(&at), references.first()) else {
            continue;
        };
        if model.unsupported_cards.iter().all(|c| c.at != at) {
            model.unsupported_cards.push(UnsupportedCard {
                card: card.name.clone(),
                id: card.first,
                at,
            });
        }
        let id = card.first.map_or(String::new(), |id| format!(" {id}"));
        out.push(ModelFault {
            card: format!("{}{id}", card.name),
            field: "card",
            at,
            kind: FaultKind::NotCarried {
                what,
                user: first.card.clone(),
                more: references.len() - 1,
            },
        });
    }
    out.sort_by_key(|f| f.at);
    out
}

/// Removes the notes on unattached grids that belong to an unsupported element. The element uses the grids, although the model lacks the element.
pub(super) fn attach_grids(deck: &Deck, faults: &mut Vec<ModelFault>) {
    let is_element = |c: &&OtherCard| defined_by(&c.name) == Some(ObjectKind::Element);
    let elements = deck.others.iter().filter(is_element);
    let mut named: HashSet<String> = HashSet::new();
    for card in elements {
        named.extend(deck.fields(card).into_iter().skip(2));
    }
    if named.is_empty() {
        return;
    }
    faults.retain(|f| {
        let grid = f.card.strip_prefix("GRID ");
        f.kind != FaultKind::Unattached || !grid.is_some_and(|id| named.contains(id))
    });
}

/// Cards without a struct by what they define and its id, the first of each.
fn by_id(deck: &Deck) -> HashMap<(ObjectKind, u32), &OtherCard> {
    let mut cards = HashMap::new();
    for card in &deck.others {
        if let (Some(defined), Some(id)) = (defined_by(&card.name), card.first) {
            cards.entry((defined, id)).or_insert(card);
        }
    }
    cards
}

fn defined_by(name: &str) -> Option<ObjectKind> {
    let is_material = |rest: &str| {
        rest.starts_with(|c: char| c.is_ascii_digit())
            || [
                "HP", "HE", "ORT", "G", "VP", "USR", "SMA", "UDS", "DIGI", "PE",
            ]
            .iter()
            .any(|m| rest.starts_with(m))
    };
    Some(match name {
        "GRIDB" | "GRIDF" | "EGRID" | "RINGAX" | "RINGFL" => ObjectKind::Grid,
        // Misspelt name: a reference to its id is not a second fault.
        n if n.starts_with("MAT") && effect_of_card(n).is_none() => ObjectKind::Material,
        n if n.starts_with("CORD") || n == "GMCORD" => ObjectKind::Frame,
        n if n.strip_prefix("MAT").is_some_and(is_material) => ObjectKind::Material,
        n if n.starts_with("PLOAD") || NO_PROPERTIES.contains(&n) => return None,
        n if n.starts_with('P') => ObjectKind::Property,
        n if n.starts_with('C') => ObjectKind::Element,
        _ => return None,
    })
}

/// The card that a missing reference means, and what it was looked for as.
fn card_of<'d>(
    kind: &FaultKind,
    deck: &'d Deck,
    cards: &HashMap<(ObjectKind, u32), &'d OtherCard>,
    generator: Option<&'d OtherCard>,
) -> Option<(&'static str, &'d OtherCard)> {
    let FaultKind::Missing { what, id } = kind else {
        return None;
    };
    let id = u32::try_from(*id).ok()?;
    let defined = match *what {
        "grid" => ObjectKind::Grid,
        "coordinate system" => ObjectKind::Frame,
        "material" => ObjectKind::Material,
        "shell" | "shell or solid" | "CBAR or CBEAM" => ObjectKind::Element,
        w if w.ends_with("property") || w.starts_with('P') => ObjectKind::Property,
        _ => return None,
    };
    let exact = cards.get(&(defined, id)).copied();
    let card = exact.or_else(|| match defined {
        ObjectKind::Grid => extra_point(deck, id).or(generator),
        ObjectKind::Element => generator,
        _ => None,
    })?;
    Some((*what, card))
}

/// The EPOINT card that lists the id.
fn extra_point(deck: &Deck, id: u32) -> Option<&OtherCard> {
    let lists = |card: &&OtherCard| {
        let text = deck.text(card);
        let words: Vec<&str> = text
            .split(|c: char| !c.is_ascii_alphanumeric())
            .filter(|w| !w.is_empty())
            .collect();
        let number = |w: &&str| w.parse::<u32>().ok();
        let in_range = |w: &[&str]| match w {
            [a, thru, b] if thru.eq_ignore_ascii_case("THRU") => number(a)
                .zip(number(b))
                .is_some_and(|(a, b)| (a..=b).contains(&id)),
            _ => false,
        };
        words.iter().any(|w| number(w) == Some(id)) || words.windows(3).any(in_range)
    };
    deck.others
        .iter()
        .filter(|c| c.name == "EPOINT")
        .find(lists)
}
