//! Temperatures that case control selects for materials.

use super::material_faults::MaterialFaults;
use crate::model::fault::{FaultKind, ModelFault};
use crate::model::types::*;
use nastran::bdf::{Deck, SubcaseKind};

/// Returns the temperature set of materials. `None` if no set is selected or the set is not usable. In the second case the reason is added to
/// `found`.
pub(super) fn selected_set(
    model: &Model,
    deck: &Deck,
    found: &mut MaterialFaults,
) -> Option<TemperatureSet> {
    let case_control = &deck.case_control;
    let mut lines = case_control.lines.iter().filter(|l| !l.in_packet);
    let at = lines
        .find(|l| l.name.starts_with("TEMP"))
        .map_or_else(Default::default, |l| l.at);
    let stated = |sid: Option<u32>| sid.filter(|sid| *sid != 0);
    let mut chosen: Option<Option<u32>> = None;
    for s in case_control.effective_subcases() {
        if matches!(s.kind, SubcaseKind::Subcom | SubcaseKind::Symcom) {
            continue;
        }
        let [material, initial] = [s.temperature_material, s.temperature_initial].map(stated);
        if material.is_some() && initial.is_some() && material != initial {
            let both = "TEMPERATURE(MATERIAL) with another TEMPERATURE(INITIAL), with MATT1";
            found.refuse(both.to_owned(), material, at);
            return None;
        }
        let set = material.or(initial);
        if chosen.is_some_and(|first| first != set) {
            let differs = "TEMPERATURE(MATERIAL) that differs between subcases, with MATT1";
            found.refuse(differs.to_owned(), set, at);
            return None;
        }
        chosen = Some(set);
    }
    let sid = chosen??;
    let set = model.temperatures.iter().find(|t| t.sid == sid).cloned();
    if set.is_none() {
        found.faults.push(ModelFault {
            card: "TEMPERATURE(MATERIAL)".to_owned(),
            field: "SID",
            at,
            kind: FaultKind::Missing {
                what: "temperature set",
                id: sid.into(),
            },
        });
    }
    set
}
