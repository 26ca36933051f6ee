//! Cards that no part of the model stands for, told apart by what leaving them out would change.
//!
//! Dampers, plot elements, heat transfer, output, optimisation and dynamics change nothing in linear statics and are not listed.

use super::types::UnsupportedCard;
use nastran::bdf::Deck;

/// Stiffness, mass and constraints.
const STRUCTURE: [&str; 39] = [
    "CBEAM3", "CBEND", "CBUSH1D", "CBUSH2D", "CCONEAX", "CMASS1", "CMASS2", "CMASS3", "CMASS4",
    "CPLSTN3", "CPLSTN4", "CPLSTN6", "CPLSTN8", "CPLSTS3", "CPLSTS4", "CPLSTS6", "CPLSTS8",
    "CQUAD", "CQUADX", "CQUADX4", "CQUADX8", "CRAC2D", "CRAC3D", "CSEAM", "CTRAX3", "CTRAX6",
    "CTRIAX", "CTRIAX6", "CYSYM", "GENEL", "RJOINT", "RROD", "RSSCON", "RTRPLT1", "RBE2GS",
    "BEDGE", "CHACAB", "CINTC", "SNORM",
];

/// Structure that acts only where case control selects it, by the word that does.
const SELECTED: [(&str, &str); 4] = [
    ("DMIG", "K2GG"),
    ("BGSET", "BGSET"),
    ("BCTSET", "BCSET"),
    ("BCONTACT", "BCONTACT"),
];

/// Loads, their set id in the first field.
const LOADS: [&str; 14] = [
    "ACCEL", "ACCEL1", "CLOAD", "DEFORM", "FORCEAX", "GMLOAD", "MOMAX", "PLOADE1", "PLOADX1",
    "PRESAX", "TEMPAX", "TEMPP2", "TEMPP3", "TEMPG",
];

/// Elements, masses and constraints, then loads, in the order of the deck.
pub(super) fn of_deck(deck: &Deck) -> (Vec<UnsupportedCard>, Vec<UnsupportedCard>) {
    let listed = |names: &[&str]| {
        let cards = deck
            .others
            .iter()
            .filter(|c| names.contains(&c.name.as_str()));
        cards
            .map(|c| UnsupportedCard {
                card: c.name.clone(),
                id: c.first,
                at: c.at,
            })
            .collect()
    };
    let selected = |word: &str| {
        deck.case_control
            .lines
            .iter()
            .any(|l| !l.in_packet && l.name == word)
    };
    let mut structure: Vec<&str> = STRUCTURE.to_vec();
    structure.extend(SELECTED.iter().filter(|s| selected(s.1)).map(|s| s.0));
    // How connectors are projected: of no matter without them.
    if !(deck.cards.welds.is_empty() && deck.cards.fasteners.is_empty()) {
        structure.push("SWLDPRM");
    }
    (listed(&structure), listed(&LOADS))
}
