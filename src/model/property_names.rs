//! Names of properties from the comments of a deck.

use nastran::bdf::{Deck, NameOwner};
use std::collections::BTreeMap;

/// Returns the name of each property by ascending id: the name of the property, or else the name of the component that uses it.
///
/// A component that states no property has the id of its property.
pub(super) fn property_names(deck: &Deck) -> Vec<(u32, String)> {
    let mut names: BTreeMap<u32, &str> = BTreeMap::new();
    for wanted in [NameOwner::Property, NameOwner::Component] {
        for label in deck.labels.iter().filter(|l| l.kind == wanted) {
            names
                .entry(label.property.unwrap_or(label.id))
                .or_insert(&label.name);
        }
    }
    names
        .into_iter()
        .map(|(id, name)| (id, name.to_owned()))
        .collect()
}
