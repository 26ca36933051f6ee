//! NSM, NSM1, NSML, NSML1, NSMADD: mass that no property states, where case control selects it.

use super::fault::{FaultKind, ModelFault};
use super::types::{BeamProperty, Model, ShellKind, ShellProperty, UnsupportedCard};
use nastran::bdf::Deck;
use nastran::cards::{Cards, IdList, NonstructuralMass};
use nastran::place::{Place, Placed};
use std::collections::BTreeSet;

/// Adds the mass of the set that case control selects to the properties that it names. Mass per area or length adds to that of the property; a
/// total is spread over the area or length of all its elements. What is named by element, and properties whose mass elements hold
/// themselves, are handed back; so are sets that differ from subcase to subcase: the structure has one mass.
pub(super) fn add_selected(
    model: &mut Model,
    deck: &Deck,
) -> (Vec<UnsupportedCard>, Vec<ModelFault>) {
    let (mut refused, mut faults) = (Vec::new(), Vec::new());
    let subcases = deck.case_control.effective_subcases();
    let Some(set) = subcases.first().and_then(|s| s.nsm) else {
        let odd = subcases.iter().find(|s| s.nsm.is_some());
        refused.extend(odd.map(|s| differing(s.nsm, s.at)));
        return (refused, faults);
    };
    if let Some(odd) = subcases.iter().find(|s| s.nsm != Some(set)) {
        refused.push(differing(Some(set), odd.at));
        return (refused, faults);
    }
    let cards = &deck.cards;
    let sets = parts(cards, set);
    for card in cards.nsms.iter().filter(|c| sets.contains(&c.sid)) {
        let found = match card.of.as_str() {
            "PSHELL" => shells(model, card, |p| {
                matches!(p.kind, ShellKind::Homogeneous { .. })
            }),
            "PCOMP" | "PCOMPG" => shells(model, card, |p| {
                matches!(p.kind, ShellKind::Laminate { .. })
            }),
            "PBAR" | "PBARL" => {
                let numbers = cards.pbars.iter().map(|p| p.id);
                beams(
                    model,
                    card,
                    &numbers.chain(cards.pbarls.iter().map(|p| p.id)).collect(),
                )
            }
            "PBEAM" | "PBEAML" => {
                let numbers = cards.pbeams.iter().map(|p| p.id);
                beams(
                    model,
                    card,
                    &numbers.chain(cards.pbeamls.iter().map(|p| p.id)).collect(),
                )
            }
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

fn differing(set: Option<u32>, at: Place) -> UnsupportedCard {
    UnsupportedCard {
        card: "NSM that differs between subcases".to_owned(),
        id: set,
        at,
    }
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

/// Adds to bars or beams, whose properties are `of_type`; the properties it was added to.
fn beams(model: &mut Model, card: &Placed<NonstructuralMass>, of_type: &BTreeSet<u32>) -> Vec<u32> {
    let wanted = |p: &BeamProperty| of_type.contains(&p.id) && names(card, p.id);
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
    let before = model.weight().mass;
    let (shells, beams) = (
        model.shell_properties.clone(),
        model.beam_properties.clone(),
    );
    add(model, 1.0);
    let measure = (model.weight().mass - before) / model.params.wtmass;
    model.shell_properties = shells;
    model.beam_properties = beams;
    if measure > 0.0 {
        add(model, card.value / measure);
    }
}
