//! What hangs at a grid, for messages.

use crate::model::{GridIx, Model};

/// Elements with a grid, in words, at most four named.
pub(crate) fn what_hangs(model: &Model, grid: GridIx) -> String {
    let mut all: Vec<String> = Vec::new();
    let has = |list: &[GridIx]| list.contains(&grid);
    for s in &model.shells {
        if has(&s.grids[..s.shape.n_corners()]) {
            all.push(format!("{} {}", s.shape.card(), s.id));
        }
    }
    let solids = model.solids.iter();
    all.extend(
        solids
            .filter(|s| s.grids.contains(&Some(grid)))
            .map(|s| format!("{} {}", s.shape.card(), s.id)),
    );
    for b in model.beams.iter().filter(|b| has(&b.grids)) {
        all.push(format!(
            "{} {}",
            if b.is_beam { "CBEAM" } else { "CBAR" },
            b.id
        ));
    }
    all.extend(
        model
            .rods
            .iter()
            .filter(|r| has(&r.grids))
            .map(|r| format!("rod {}", r.id)),
    );
    all.extend(
        model
            .bushes
            .iter()
            .filter(|b| b.grids.0 == grid || b.grids.1 == Some(grid))
            .map(|b| format!("CBUSH {}", b.id)),
    );
    all.extend(
        model
            .springs
            .iter()
            .filter(|s| s.ends.iter().flatten().any(|e| e.0 == grid))
            .map(|s| format!("spring {}", s.id)),
    );
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
    for j in &model.joints {
        let mut motion = j.ends.iter().flat_map(|e| &e.motion);
        if motion.any(|m| m.0 == grid) {
            all.push(format!("{} {}", j.card.name(), j.id));
        }
    }
    // The equations of a rigid bush or a weld go by the name of their card, which is listed already.
    let mut seen = std::collections::HashSet::new();
    all.retain(|name| seen.insert(name.clone()));
    let more = all.len().saturating_sub(4);
    all.truncate(4);
    match (all.is_empty(), more) {
        (true, _) => "no element".to_owned(),
        (false, 0) => all.join(", "),
        (false, more) => format!("{} and {more} more", all.join(", ")),
    }
}
