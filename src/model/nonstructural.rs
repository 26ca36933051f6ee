//! NSM, NSM1, NSML, NSML1, NSMADD: mass that no property states, where case control selects it.

use super::fault::{FaultKind, ModelFault};
use super::types::{BeamProperty, Model, ShellKind, ShellProperty, UnsupportedCard};
use nastran::bdf::Deck;
use nastran::cards::{Cards, IdList, NonstructuralMass};
use nastran::place::Placed;
use std::collections::BTreeSet;

/// The set that case control selects, that of the first subcase where none stands above.
pub(super) fn selected(deck: &Deck) -> Option<u32> {
    let lines = deck.case_control.lines.iter();
    let mut of_nsm = lines.filter(|l| !l.in_packet && l.name == "NSM");
    let value = of_nsm.next()?.text.split('=').nth(1)?;
    value.trim().parse().ok()
}

/// Adds the mass of a set to the properties that it names. Mass per area or length adds to that of the property; a total is spread over the
/// area or length of all its elements. What is named by element, and properties whose mass elements hold themselves, are handed back.
pub(super) fn add(
    model: &mut Model,
    cards: &Cards,
    set: u32,
) -> (Vec<UnsupportedCard>, Vec<ModelFault>) {
    let (mut refused, mut faults) = (Vec::new(), Vec::new());
    let sets = parts(cards, set);
    for card in cards.nsms.iter().filter(|c| sets.contains(&c.sid)) {
        let found = match card.of.as_str() {
            "PSHELL" => shells(model, card, |p| {
                matches!(p.kind, ShellKind::Homogeneous { .. })
            }),
            "PCOMP" | "PCOMPG" => shells(model, card, |p| {
                matches!(p.kind, ShellKind::Laminate { .. })
            }),
            "PBAR" | "PBARL" | "PBEAM" | "PBEAML" => beams(model, card),
            _ => {
                refused.push(UnsupportedCard {
                    card: format!("NSM of {}", card.of),
                    id: Some(card.sid),
                    at: card.at,
                });
                continue;
            }
        };
        for id in named(card).filter(|id| !found.contains(id)) {
            faults.push(ModelFault {
                card: format!("NSM {}", card.sid),
                field: "ID",
                at: card.at,
                kind: FaultKind::Missing {
                    what: "property",
                    id: id.into(),
                },
            });
        }
    }
    (refused, faults)
}

/// A set and those that NSMADD puts into it.
fn parts(cards: &Cards, set: u32) -> BTreeSet<u32> {
    let mut all = BTreeSet::new();
    let mut open = vec![set];
    while let Some(sid) = open.pop() {
        if all.insert(sid) {
            let sums = cards.nsmadds.iter().filter(|s| s.sid == sid);
            open.extend(sums.flat_map(|s| s.sets.iter().copied()));
        }
    }
    all
}

/// Ids that a card names one by one.
fn named(card: &NonstructuralMass) -> impl Iterator<Item = u32> {
    let lists = card.ids.iter().flatten();
    lists
        .flat_map(|l| match l {
            IdList::Each(ids) => ids.as_slice(),
            IdList::Thru(..) => &[],
        })
        .copied()
}

fn names(card: &NonstructuralMass, id: u32) -> bool {
    card.ids.as_ref().is_none_or(|lists| {
        lists.iter().any(|l| match l {
            IdList::Each(ids) => ids.contains(&id),
            IdList::Thru(a, b) => (*a..=*b).contains(&id),
        })
    })
}

/// Adds to shells; the properties it was added to.
fn shells(
    model: &mut Model,
    card: &Placed<NonstructuralMass>,
    of_type: impl Fn(&ShellProperty) -> bool,
) -> Vec<u32> {
    let wanted = |p: &ShellProperty| of_type(p) && names(card, p.id);
    let add = |model: &mut Model, value: f64| {
        let all = model.shell_properties.iter_mut();
        all.filter(|p| wanted(p)).for_each(|p| p.nsm += value);
    };
    spread(model, card, add);
    let all = model.shell_properties.iter();
    all.filter(|p| wanted(p)).map(|p| p.id).collect()
}

/// Adds to bars and beams; the properties it was added to.
fn beams(model: &mut Model, card: &Placed<NonstructuralMass>) -> Vec<u32> {
    let wanted = |p: &BeamProperty| names(card, p.id);
    let add = |model: &mut Model, value: f64| {
        let all = model.beam_properties.iter_mut().filter(|p| wanted(p));
        all.flat_map(|p| &mut p.sections)
            .for_each(|(_, section)| section.nsm += value);
    };
    spread(model, card, add);
    let all = model.beam_properties.iter();
    all.filter(|p| wanted(p)).map(|p| p.id).collect()
}

/// Adds the value of a card, a total over the area or length that mass per unit of it weighs.
fn spread(model: &mut Model, card: &NonstructuralMass, add: impl Fn(&mut Model, f64)) {
    if !card.lumped {
        return add(model, card.value);
    }
    let mut heavier = model.clone();
    add(&mut heavier, 1.0);
    let measure = (heavier.weight().mass - model.weight().mass) / model.params.wtmass;
    if measure > 0.0 {
        add(model, card.value / measure);
    }
}
