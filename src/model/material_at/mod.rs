//! MATT1: materials at the temperature of their elements, where case control selects one.

mod material_faults;
mod temperature_dependence;
mod temperature_selection;
mod uses;

use super::own_property::change_properties;
use super::types::*;
use material_faults::MaterialFaults;
use nastran::bdf::Deck;
use std::collections::{BTreeMap, BTreeSet};
use temperature_dependence::{TemperatureDependentMaterial, dependent_materials};
use temperature_selection::selected_set;
use uses::Uses;

/// Gives every element whose MAT1 has a MATT1 the material at its temperature. This temperature is the mean over its grids, or the temperature that
/// TEMPP1 or TEMPRB states.
///
/// TEMPERATURE(MATERIAL), (BOTH), or no option selects the temperatures. Without these, TEMPERATURE(INITIAL) selects them. Without any selection the
/// values of MAT1 apply: TEMPERATURE(LOAD) alone changes no material in linear statics.
///
/// # Reference
/// MSC Nastran Quick Reference Guide, case control command TEMPERATURE, remarks; Autodesk Nastran Reference Guide, MATT1, remark 1 (no
/// selection, no dependence).
pub(super) fn heat_materials(model: &mut Model, deck: &Deck) -> MaterialFaults {
    let mut found = MaterialFaults::default();
    if deck.cards.matt1s.is_empty() {
        return found;
    }
    let Some(set) = selected_set(model, deck, &mut found) else {
        return found;
    };
    let dependent = dependent_materials(model, deck, &mut found);
    if dependent.is_empty() {
        return found;
    }
    model.material_temperature = Some(set.sid);
    refuse_others(model, deck, &set, &dependent, &mut found);
    let uses = Uses::from_temperatures(model, &set, &dependent, &mut found);
    let pairs: Vec<(u32, u64)> = uses.materials(model, &dependent).into_iter().collect();
    let mut heated: BTreeMap<(u32, u64), Material> = BTreeMap::new();
    let mut reported = BTreeSet::new();
    for pair in &pairs {
        let Some(one) = dependent.get(&pair.0) else {
            continue;
        };
        match one.material_at(f64::from_bits(pair.1)) {
            Ok(material) => {
                heated.insert(*pair, material);
            }
            Err(fault) if reported.insert(pair.0) => found.faults.push(fault),
            Err(_) => {}
        }
    }
    let keys: Vec<(u32, Option<(u32, u64)>)> = pairs.iter().map(|p| (p.0, Some(*p))).collect();
    let own = change_properties(&mut model.materials, &keys, |material, key| {
        if let Some(heated) = heated.get(&key) {
            *material = *heated;
        }
    });
    let own = pairs.into_iter().zip(own.into_iter().map(MaterialIx));
    uses.apply(model, &own.collect());
    found
}

/// Refuses uses of these materials that are not carried: plies, spot welds, temperature cards that are not read.
fn refuse_others(
    model: &Model,
    deck: &Deck,
    set: &TemperatureSet,
    dependent: &BTreeMap<u32, TemperatureDependentMaterial<'_>>,
    found: &mut MaterialFaults,
) {
    for p in &model.shell_properties {
        if let ShellKind::Laminate { plies, .. } = &p.kind
            && plies
                .iter()
                .any(|ply| dependent.contains_key(&ply.material.0))
        {
            let card = "PCOMP with plies of a MATT1".to_owned();
            found.refuse(card, Some(p.id), p.at);
        }
    }
    let is = |mid: u32| dependent.values().any(|d| d.id() == mid);
    for p in &deck.cards.pwelds {
        if !deck.cards.welds.is_empty() && is(p.mid) {
            found.refuse("PWELD with a MATT1".to_owned(), Some(p.id), p.at);
        }
    }
    let sets = model.load_sets.iter().filter(|s| s.sid == set.sid);
    for (_, load) in sets.flat_map(|s| &s.loads) {
        if let Load::Unsupported(card, at) = load
            && card.starts_with("TEMP")
        {
            found.refuse(card.clone(), Some(set.sid), *at);
        }
    }
}
