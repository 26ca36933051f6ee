//! NSM, NSM1, NSML, NSML1, NSMADD: mass that no property states, where case control selects it.

use super::fault::{FaultKind, ModelFault};
use super::own_property::change_properties;
use super::types::*;
use nastran::bdf::Deck;
use nastran::cards::{Cards, IdList, NonstructuralMass};
use nastran::place::{Place, PlacedCard};
use std::collections::{BTreeMap, BTreeSet};

/// Adds the nonstructural mass of the set that case control selects. The set identifies elements by id or by property. A total mass is distributed
/// over the area or length of all its elements. The function refuses unsupported types and total masses over both areas and lengths. It also refuses
/// sets that differ between subcases, because the structure has only one mass.
pub(super) fn add_selected(
    model: &mut Model,
    deck: &Deck,
) -> (Vec<UnsupportedCard>, Vec<ModelFault>) {
    let (mut refused, mut faults) = (Vec::new(), Vec::new());
    let subcases = deck.case_control.effective_subcases();
    let Some(set) = subcases.first().and_then(|s| s.nsm) else {
        let odd = subcases.iter().find(|s| s.nsm.is_some());
        refused.extend(odd.map(|s| unsupported_subcase_nsm(s.nsm, s.at)));
        return (refused, faults);
    };
    if let Some(odd) = subcases.iter().find(|s| s.nsm != Some(set)) {
        refused.push(unsupported_subcase_nsm(Some(set), odd.at));
        return (refused, faults);
    }
    let cards = &deck.cards;
    let sets = parts(cards, set);
    let first = subcases.first().map(|s| s.id);
    let stated = deck.case_control.place_of("NSM", first);
    if set != 0 && !cards.nsms.iter().any(|c| sets.contains(&c.sid)) {
        faults.push(ModelFault {
            card: "NSM".to_owned(),
            field: "SID",
            at: stated.unwrap_or_default(),
            kind: FaultKind::Missing {
                what: "NSM set",
                id: set.into(),
            },
        });
    }
    let carriers = Carriers::from_model(model, cards);
    let mut added: BTreeMap<Carrier, f64> = BTreeMap::new();
    for card in cards.nsms.iter().filter(|c| sets.contains(&c.sid)) {
        let Some(named) = carriers.by_type.get(card.of.as_str()) else {
            refused.push(not_carried(card, format!("NSM of {}", card.of)));
            continue;
        };
        let known = |id: &u32| named.contains_key(id) || carriers.has_property(&card.of, *id);
        for id in named_ids(card).filter(|id| !known(id)) {
            faults.push(ModelFault {
                card: format!("NSM {}", card.sid),
                field: "ID",
                at: card.at,
                kind: FaultKind::Missing {
                    what: if card.of == "ELEMENT" {
                        "shell, shear panel, bar, beam or rod"
                    } else {
                        "property"
                    },
                    id: id.into(),
                },
            });
        }
        let chosen: Vec<Carrier> = named
            .iter()
            .filter(|(id, _)| names(card, **id))
            .flat_map(|(_, list)| list.iter().copied())
            .collect();
        let areas = chosen.iter().filter(|c| c.has_area()).count();
        let mixed = areas > 0 && areas < chosen.len();
        if mixed && (card.lumped || card.ids.is_none()) {
            let what = "NSM of ELEMENT with areas and lengths together";
            refused.push(not_carried(card, what.to_owned()));
            continue;
        }
        let whole: f64 = chosen.iter().map(|c| c.measure(model)).sum();
        let value = match card.lumped {
            false => card.value,
            true if whole > 0.0 => card.value / whole,
            true => 0.0,
        };
        for carrier in chosen {
            *added.entry(carrier).or_insert(0.0) += value;
        }
    }
    add(model, &added);
    (refused, faults)
}

fn not_carried(card: &PlacedCard<NonstructuralMass>, what: String) -> UnsupportedCard {
    UnsupportedCard {
        card: what,
        id: Some(card.sid),
        at: card.at,
    }
}

/// Element that can have non-structural mass, by its index in the list of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Carrier {
    Shell(usize),
    Panel(usize),
    Beam(usize),
    Rod(usize),
}

impl Carrier {
    fn has_area(self) -> bool {
        matches!(self, Self::Shell(_) | Self::Panel(_))
    }

    /// Area or length.
    fn measure(self, model: &Model) -> f64 {
        match self {
            Self::Shell(i) => model.shell_area(i),
            Self::Panel(i) => model.panel_area(i),
            Self::Beam(i) => model.beam_length(i),
            Self::Rod(i) => model.rod_length(i),
        }
    }
}

/// Elements by type of NSM, then by the id that a card names: property id, or element id.
struct Carriers {
    by_type: BTreeMap<&'static str, BTreeMap<u32, Vec<Carrier>>>,
    /// Property ids of the deck by type, unused ones included.
    properties: BTreeMap<&'static str, BTreeSet<u32>>,
}

impl Carriers {
    fn from_model(model: &Model, cards: &Cards) -> Self {
        let properties = properties(cards);
        let is = |word: &str, id: u32| properties.get(word).is_some_and(|ids| ids.contains(&id));
        let types = properties.keys().map(|word| (*word, BTreeMap::new()));
        let mut by_type: BTreeMap<&'static str, BTreeMap<u32, Vec<Carrier>>> = types.collect();
        let mut note = |words: &[&'static str], id: u32, carrier: Carrier| {
            for word in words {
                let ids: &mut BTreeMap<u32, Vec<Carrier>> = by_type.entry(word).or_default();
                ids.entry(id).or_default().push(carrier);
            }
        };
        for (i, s) in model.shells.iter().enumerate() {
            note(&["ELEMENT"], s.id, Carrier::Shell(i));
            let Some(p) = model.shell_properties.get(s.property.us()) else {
                continue;
            };
            match p.kind {
                ShellKind::Homogeneous { .. } => note(&["PSHELL"], p.id, Carrier::Shell(i)),
                ShellKind::Laminate { .. } => note(&["PCOMP", "PCOMPG"], p.id, Carrier::Shell(i)),
            }
        }
        for (i, b) in model.beams.iter().enumerate() {
            note(&["ELEMENT"], b.id, Carrier::Beam(i));
            let Some(p) = model.beam_properties.get(b.property.us()) else {
                continue;
            };
            let words: &[&'static str] = match b.is_beam {
                true => &["PBEAM", "PBEAML"],
                false => &["PBAR", "PBARL"],
            };
            // A deck may contain a PBAR and a PBEAM with the same id.
            if words.iter().any(|word| is(word, p.id)) {
                note(words, p.id, Carrier::Beam(i));
            }
        }
        let of_rod: BTreeMap<u32, u32> = cards
            .rods
            .iter()
            .map(|r| (r.id, r.pid.unwrap_or(r.id)))
            .collect();
        for (i, r) in model.rods.iter().enumerate() {
            note(&["ELEMENT"], r.id, Carrier::Rod(i));
            let pid = of_rod.get(&r.id).copied();
            match (r.card, pid) {
                (RodCard::Conrod, _) => note(&["CONROD"], r.id, Carrier::Rod(i)),
                (RodCard::Crod, Some(pid)) => note(&["PROD"], pid, Carrier::Rod(i)),
                (RodCard::Ctube, Some(pid)) => note(&["PTUBE"], pid, Carrier::Rod(i)),
                _ => {}
            }
        }
        let of_panel: BTreeMap<u32, u32> = cards
            .shear_panels
            .iter()
            .map(|p| (p.id, p.pid.unwrap_or(p.id)))
            .collect();
        for (i, p) in model.shear_panels.iter().enumerate() {
            note(&["ELEMENT"], p.id, Carrier::Panel(i));
            if let Some(pid) = of_panel.get(&p.id) {
                note(&["PSHEAR"], *pid, Carrier::Panel(i));
            }
        }
        Self {
            by_type,
            properties,
        }
    }

    /// Returns whether the deck has a property of that type and id.
    fn has_property(&self, word: &str, id: u32) -> bool {
        let ids = self.properties.get(word);
        ids.is_some_and(|ids| ids.contains(&id))
    }
}

/// Returns property ids by type of NSM. PBAR and PBARL are one type, and so are PBEAM and PBEAML, PCOMP and PCOMPG.
fn properties(cards: &Cards) -> BTreeMap<&'static str, BTreeSet<u32>> {
    fn ids<T>(list: &[PlacedCard<T>], id: impl Fn(&T) -> u32) -> BTreeSet<u32> {
        list.iter().map(|p| id(&p.card)).collect()
    }
    let mut bars = ids(&cards.pbars, |p| p.id);
    bars.extend(ids(&cards.pbarls, |p| p.id));
    let mut beams = ids(&cards.pbeams, |p| p.id);
    beams.extend(ids(&cards.pbeamls, |p| p.id));
    let laminates = ids(&cards.pcomps, |p| p.id);
    BTreeMap::from([
        ("ELEMENT", BTreeSet::new()),
        ("CONROD", BTreeSet::new()),
        ("PSHELL", ids(&cards.pshells, |p| p.id)),
        ("PCOMP", laminates.clone()),
        ("PCOMPG", laminates),
        ("PBAR", bars.clone()),
        ("PBARL", bars),
        ("PBEAM", beams.clone()),
        ("PBEAML", beams),
        ("PROD", ids(&cards.prods, |p| p.id)),
        ("PTUBE", ids(&cards.ptubes, |p| p.id)),
        ("PSHEAR", ids(&cards.pshears, |p| p.id)),
    ])
}

/// Adds mass per area or length to elements.
fn add(model: &mut Model, added: &BTreeMap<Carrier, f64>) {
    let bits = |carrier: Carrier| {
        let value = added.get(&carrier).filter(|v| **v != 0.0);
        value.map(|v| v.to_bits())
    };
    let shells = model.shells.iter().enumerate();
    let keys: Vec<_> = shells
        .map(|(i, s)| (s.property.0, bits(Carrier::Shell(i))))
        .collect();
    let own = change_properties(&mut model.shell_properties, &keys, |p, v| {
        p.nsm += f64::from_bits(v);
    });
    for (s, property) in model.shells.iter_mut().zip(own) {
        s.property = ShellPropertyIx(property);
    }
    let beams = model.beams.iter().enumerate();
    let keys: Vec<_> = beams
        .map(|(i, b)| (b.property.0, bits(Carrier::Beam(i))))
        .collect();
    let own = change_properties(&mut model.beam_properties, &keys, |p, v| {
        let sections = p.sections.iter_mut();
        sections.for_each(|(_, section)| section.nsm += f64::from_bits(v));
    });
    for (b, property) in model.beams.iter_mut().zip(own) {
        b.property = BeamPropertyIx(property);
    }
    for (carrier, value) in added {
        match *carrier {
            Carrier::Panel(i) => model.shear_panels[i].nsm += value,
            Carrier::Rod(i) => model.rods[i].nsm += value,
            Carrier::Shell(_) | Carrier::Beam(_) => {}
        }
    }
}

fn unsupported_subcase_nsm(set: Option<u32>, at: Place) -> UnsupportedCard {
    UnsupportedCard {
        card: "NSM that differs between subcases".to_owned(),
        id: set,
        at,
    }
}

/// Returns a set and the sets that NSMADD adds to it.
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
fn named_ids(card: &NonstructuralMass) -> impl Iterator<Item = u32> {
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
