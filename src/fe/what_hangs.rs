//! Descriptions of the elements at a grid, for messages.

use crate::finding::list_few;
use crate::model::{ElementRef, GridIx, Model};

/// Returns the names of the elements with a grid.
pub(super) fn what_hangs(model: &Model, grid: GridIx) -> String {
    let here = |e: &ElementRef| model.element_grids(*e).contains(&grid);
    let named = |e: ElementRef| format!("{} {}", model.element_word(e), model.element_id(e));
    let mut all: Vec<String> = model.elements().filter(here).map(named).collect();
    all.extend(
        model
            .masses
            .iter()
            .filter(|m| m.grid == grid)
            .map(|m| format!("mass {}", m.id)),
    );
    for r in &model.rigids {
        if r.kind.grids().contains(&grid) {
            all.push(format!("{} {}", r.kind.card(), r.id));
        }
    }
    // The equations of a rigid bush or a weld have the name of their card, which the list already contains.
    let mut seen = std::collections::HashSet::new();
    all.retain(|name| seen.insert(name.clone()));
    match all.is_empty() {
        true => "no element".to_owned(),
        false => list_few(&all),
    }
}

#[cfg(test)]
mod tests;
