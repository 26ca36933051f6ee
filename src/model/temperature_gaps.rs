//! Grids of elements that a selected temperature set leaves without a temperature.

use super::elements::ElementRef;
use super::fault::{FaultKind, ModelFault};
use super::types::{Model, TemperatureSet};
use nastran::bdf::{Deck, SubcaseKind};
use std::collections::BTreeSet;

/// Returns one fault for each temperature set that a subcase selects and that states no temperature of a grid of an element. Nastran stops there.
///
/// # Reference
/// MSC Nastran Quick Reference Guide, TEMP and TEMPD: TEMPD gives the temperature of the grids that no TEMP names.
pub(super) fn missing_temperatures(model: &Model, deck: &Deck) -> Vec<ModelFault> {
    // The set of TEMPERATURE(MATERIAL) is tested when the materials at temperature are evaluated.
    let mut selected = BTreeSet::new();
    for s in deck.case_control.effective_subcases() {
        if !matches!(s.kind, SubcaseKind::Subcom | SubcaseKind::Symcom) {
            selected.extend(
                [s.temperature_load, s.temperature_initial]
                    .into_iter()
                    .flatten(),
            );
        }
    }
    let sets = model.temperatures.iter();
    sets.filter(|t| t.default.is_none() && selected.contains(&t.sid))
        .filter_map(|t| missing_of(model, t))
        .collect()
}

fn missing_of(model: &Model, set: &TemperatureSet) -> Option<ModelFault> {
    let mut stated = vec![false; model.grids.len()];
    for (g, _) in &set.grids {
        if let Some(slot) = stated.get_mut(g.us()) {
            *slot = true;
        }
    }
    let mut first: Option<(u32, String)> = None;
    let mut missing = 0;
    for element in model.elements() {
        let heated = match element {
            ElementRef::Shell(_)
            | ElementRef::Beam(_)
            | ElementRef::Rod(_)
            | ElementRef::Solid(_) => true,
            ElementRef::Bush(_)
            | ElementRef::Joint(_)
            | ElementRef::Spring(_)
            | ElementRef::ShearPanel(_) => false,
        };
        let id = model.element_id(element);
        if !heated || set.elements.contains_key(&id) {
            continue;
        }
        for g in model.element_grids(element) {
            let Some(slot) = stated.get_mut(g.us()).filter(|s| !**s) else {
                continue;
            };
            *slot = true;
            missing += 1;
            let name = || format!("{} {id}", model.element_word(element));
            let grid = model.grids.get(g.us()).map_or(0, |g| g.id);
            first.get_or_insert_with(|| (grid, name()));
        }
    }
    let (grid, element) = first?;
    Some(ModelFault {
        card: format!("TEMPERATURE SET {}", set.sid),
        field: "TEMP",
        at: set.at,
        kind: FaultKind::NoTemperature {
            grid,
            element,
            more: missing - 1,
        },
    })
}

#[cfg(test)]
mod tests {
    use crate::model::{FaultKind, Model};
    use nastran::bdf::{MemoryLoader, read_deck};

    #[test]
    fn a_grid_of_an_element_without_a_temperature_is_refused_by_name() {
        let found = |temperatures: &str| {
            let rod = "GRID,1\nGRID,2,,2.,0.,0.\nGRID,3\nCROD,7,1,1,2\nPROD,1,1,.01\nMAT1,1,1.+10,,0.,,1.-5";
            let text =
                format!("SOL 101\nCEND\nTEMP = 4\nBEGIN BULK\n{rod}\n{temperatures}\nENDDATA\n");
            let deck = read_deck("deck.bdf", text.into_bytes(), &mut MemoryLoader::default());
            let faults = Model::from_deck(&deck).1.into_iter();
            let missing = faults.filter(|f| matches!(f.kind, FaultKind::NoTemperature { .. }));
            missing.map(|f| f.kind.to_string()).collect::<Vec<String>>()
        };
        let [fault] = &found("TEMP,4,2,10.")[..] else {
            panic!("one fault")
        };
        assert!(fault.contains("grid 1 of rod 7"), "{fault}");
        for whole in [
            "TEMP,4,2,10.,1,0.",
            "TEMP,4,2,10.\nTEMPD,4,0.",
            "TEMP,5,2,10.\nTEMPD,4,0.",
        ] {
            assert_eq!(found(whole), Vec::<String>::new(), "{whole}");
        }
    }
}
