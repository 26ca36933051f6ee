//! Zones: properties whose stiffness may be wrong together.

use crate::gauge::Gauge;
use crate::host::fault::Faults;
use crate::job::{Ids, Job};
use crate::model::Model;
use std::collections::BTreeMap;

/// Returns the zones that the job states, else each shell property with gauges, by its name in the deck.
///
/// # Errors
/// Names that no property of the deck or more than one property has.
pub(super) fn zones(
    job: &Job,
    model: &Model,
    gauges: &[Gauge],
) -> Result<BTreeMap<String, Ids>, Faults> {
    let with_ids = job.with_property_ids(&model.property_names)?;
    if let Some(r) = with_ids.reconcile.filter(|r| !r.zones.is_empty()) {
        let zones = r.zones.into_iter();
        return Ok(zones.map(|(zone, list)| (zone, list.ids)).collect());
    }
    let mut zones: BTreeMap<String, Ids> = BTreeMap::new();
    for gauge in gauges {
        let shell = model.shell_ix(gauge.element);
        let shell = shell.and_then(|ix| model.shells.get(ix.us()));
        let Some(property) = shell.and_then(|s| model.shell_properties.get(s.property.us())) else {
            continue;
        };
        let named = model.property_names.iter().find(|n| n.0 == property.id);
        let name = named.map_or_else(|| format!("property{}", property.id), |n| n.1.clone());
        let ids = zones.entry(name).or_insert_with(|| Ids(Vec::new()));
        if !ids.contains(property.id) {
            ids.0.push([property.id; 2]);
        }
    }
    Ok(zones)
}
