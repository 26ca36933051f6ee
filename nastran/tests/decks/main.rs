//! Compares the decks of the real cases with the result of another program.

mod common;
mod robust;
#[path = "../support/mod.rs"]
mod support;

use std::collections::BTreeMap;

use nastran::bdf::Deck;
use nastran::cards::ParamValue;

/// Cards that the other program counts differently, or that the geometry blocks of an OP2 split. The other program reads those blocks if it cannot
/// read the deck.
const OP2_SPLITS: [&str; 8] = [
    "FORCE", "TEMPD", "MATT1", "MATT4", "MAT2", "TABLEM4", "SPCADD", "CORD2C",
];

#[test]
fn every_deck_of_the_real_cases_is_read_without_a_fault() {
    // At least one grid per deck, because a reader that reads nothing has no faults either.
    common::at_least(25, |case, deck| {
        let shown: Vec<String> = deck
            .faults
            .iter()
            .map(|f| f.show(&deck.sources).to_string())
            .collect();
        assert!(shown.is_empty(), "{}: {shown:#?}", case.name);
        deck.cards.grids.len()
    });
}

#[test]
fn card_counts_agree_with_another_reader() {
    common::at_least(25, |case, deck| {
        let Some(cards) = case.expected["mesh"]["cards"].as_object() else {
            return 0;
        };
        let expected: BTreeMap<String, u64> = cards
            .iter()
            .map(|(k, v)| (k.clone(), v.as_u64().unwrap()))
            .collect();
        let from_op2 = case.expected["mesh_source"] == "op2 geometry blocks";
        for (name, n) in &expected {
            if from_op2 && OP2_SPLITS.contains(&name.as_str()) {
                continue;
            }
            assert_eq!(
                deck.counts.get(name).copied().unwrap_or(0) as u64,
                *n,
                "{}: {name}",
                case.name
            );
        }
        if !from_op2 {
            for (name, n) in &deck.counts {
                assert_eq!(
                    expected.get(name),
                    Some(&(*n as u64)),
                    "{}: {name}",
                    case.name
                );
            }
        }
        1
    });
}

#[test]
fn solution_and_parameters_agree_with_another_reader() {
    // The set states the solution of 25 decks and the parameters of 27.
    common::at_least(48, |case, deck| {
        let mut compared = 0;
        if let Some(sol) = case.expected["mesh"]["sol"].as_u64() {
            assert_eq!(deck.sol.map(u64::from), Some(sol), "{}", case.name);
            compared += 1;
        }
        let Some(params) = case.expected["mesh"]["params"].as_object() else {
            return compared;
        };
        // The results contain parameters of the run that the deck does not state.
        if case.expected["mesh_source"] == "bdf" {
            assert_eq!(deck.cards.params.len(), params.len(), "{}", case.name);
        }
        for card in &deck.cards.params {
            let Some(values) = params.get(&card.name).and_then(|v| v.as_array()) else {
                continue;
            };
            for (ours, theirs) in card.values.iter().zip(values) {
                match ours {
                    ParamValue::Text(t) => assert_eq!(
                        Some(t.as_str()),
                        theirs.as_str(),
                        "{}: {}",
                        case.name,
                        card.name
                    ),
                    number => assert_eq!(
                        number.as_f64(),
                        theirs.as_f64(),
                        "{}: {}",
                        case.name,
                        card.name
                    ),
                }
            }
        }
        compared + 1
    });
}

fn n_elements(deck: &Deck) -> usize {
    let c = &deck.cards;
    let other = [
        "CELAS3", "CELAS4", "CDAMP1", "CDAMP2", "CDAMP3", "CDAMP4", "CVISC", "CBUSH1D",
    ];
    let others = deck
        .others
        .iter()
        .filter(|o| other.contains(&o.name.as_str()))
        .count();
    c.shells.len()
        + c.shear_panels.len()
        + c.bars.len()
        + c.beams.len()
        + c.rods.len()
        + c.conrods.len()
        + others
        + c.bushes.len()
        + c.springs.len()
        + c.solids.len()
}

#[test]
fn numbers_of_grids_elements_and_masses_agree_with_another_reader() {
    common::at_least(25, |case, deck| {
        let mesh = &case.expected["mesh"];
        let Some(nodes) = mesh["nodes"].as_u64() else {
            return 0;
        };
        assert_eq!(deck.cards.grids.len() as u64, nodes, "{}: grids", case.name);
        assert_eq!(
            Some(n_elements(deck) as u64),
            mesh["elements"].as_u64(),
            "{}: elements",
            case.name
        );
        let c = &deck.cards;
        let rigid = c.rbe1s.len() + c.rbe2s.len() + c.rbe3s.len() + c.rbars.len();
        assert_eq!(
            Some(rigid as u64),
            mesh["rigid_elements"].as_u64(),
            "{}: rigid elements",
            case.name
        );
        assert_eq!(
            Some((c.conm1s.len() + c.conm2s.len()) as u64),
            mesh["masses"].as_u64(),
            "{}: masses",
            case.name
        );
        // The other program also counts system 0.
        assert_eq!(
            Some(c.coords.len() as u64 + 1),
            mesh["coords"].as_u64(),
            "{}: coordinate systems",
            case.name
        );
        1
    });
}

#[test]
fn every_deck_is_written_as_it_was_read() {
    common::at_least(25, |_, deck| {
        let files = nastran::bdf::write_deck(deck);
        for (path, bytes) in &files {
            assert_eq!(*bytes, std::fs::read(path).unwrap(), "{path}");
        }
        files.len()
    });
}

#[test]
fn the_replicated_cards_of_a_real_deck_are_made() {
    common::at_least(1, |case, deck| {
        if case.name != "nx_quad8_replicated_deck" {
            return 0;
        }
        // The deck has one complete card, and nine by `=,=,107,=`.
        assert_eq!(deck.counts["DEFORM"], 10);
        1
    });
}

#[test]
fn quads_agree_with_another_reader() {
    // The set has 526.
    common::at_least(500, |case, deck| {
        let Some(quads) = case.expected["mesh"]["cquad4_frames"].as_array() else {
            return 0;
        };
        for quad in quads {
            let shell = deck
                .cards
                .shells
                .iter()
                .find(|s| u64::from(s.id) == quad["eid"].as_u64().unwrap())
                .unwrap();
            assert_eq!(
                shell.pid.map(u64::from),
                quad["pid"].as_u64(),
                "{}",
                case.name
            );
            let grids: Vec<u64> = quad["nodes"]
                .as_array()
                .unwrap()
                .iter()
                .filter_map(|n| n.as_u64())
                .collect();
            assert!(
                shell
                    .grids
                    .iter()
                    .map(|&g| u64::from(g))
                    .zip(grids)
                    .all(|(a, b)| a == b),
                "{}",
                case.name
            );
            let angle = &quad["theta_mcid"];
            match shell.angle {
                nastran::cards::MaterialAngle::Theta(t) => {
                    assert_eq!(angle.as_f64(), Some(t), "{}", case.name)
                }
                nastran::cards::MaterialAngle::Mcid(c) => {
                    assert_eq!(angle.as_u64(), Some(u64::from(c)), "{}", case.name)
                }
            }
        }
        quads.len()
    });
}
