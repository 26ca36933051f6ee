//! Copies of properties for single elements.

use std::collections::{BTreeMap, BTreeSet};

/// Changes properties element by element and returns the property of each element.
///
/// `elements` contains the index of each element's property and the key of its change. Elements with the same property and key share one changed
/// copy, which is appended. A property whose elements all have one key is changed in place.
pub(super) fn change_properties<P: Clone, K: Ord + Copy>(
    properties: &mut Vec<P>,
    elements: &[(u32, Option<K>)],
    mut change: impl FnMut(&mut P, K),
) -> Vec<u32> {
    let mut keys: BTreeMap<u32, BTreeSet<Option<K>>> = BTreeMap::new();
    for (property, key) in elements {
        keys.entry(*property).or_default().insert(*key);
    }
    let mut changed: BTreeMap<(u32, K), u32> = BTreeMap::new();
    for (property, keys) in keys {
        let whole = keys.len() == 1;
        for key in keys.into_iter().flatten() {
            let at = property as usize;
            if whole {
                properties
                    .get_mut(at)
                    .into_iter()
                    .for_each(|p| change(p, key));
                changed.insert((property, key), property);
            } else if let Some(mut own) = properties.get(at).cloned() {
                change(&mut own, key);
                changed.insert((property, key), properties.len() as u32);
                properties.push(own);
            }
        }
    }
    let place = |(property, key): &(u32, Option<K>)| {
        let own = key.and_then(|key| changed.get(&(*property, key)));
        own.copied().unwrap_or(*property)
    };
    elements.iter().map(place).collect()
}
