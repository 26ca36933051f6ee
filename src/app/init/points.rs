//! Grids where loads are likely to enter a structure of which nothing else is known.

use crate::app::deck::DeckModel;
use crate::model::{GridIx, Model, RigidKind, Vec3};
use std::collections::BTreeSet;

/// Grids proposed at most where no card says where loads enter.
const MOST_FAR: usize = 4;

/// Grids with a word for their names: reference grids of RBE3, independent grids of rigid bodies; then of a structure that the deck
/// leaves free the constrained grids, where it will stand, and of one that it holds the shell grids far from the supports.
pub(super) fn load_points(deck: &DeckModel) -> Vec<(u32, &'static str)> {
    let m = &deck.model;
    let selected: BTreeSet<u32> = deck
        .deck
        .case_control
        .effective_subcases()
        .iter()
        .filter_map(|s| s.spc)
        .filter(|sid| *sid > 0)
        .collect();
    let held: BTreeSet<GridIx> = m
        .spcs
        .iter()
        .filter(|s| selected.contains(&s.sid))
        .flat_map(|s| s.terms.iter().map(|t| t.0))
        .collect();
    let mut out: Vec<(u32, &'static str)> = Vec::new();
    let mut add = |g: GridIx, why| {
        if let Some(id) = m.grids.get(g.us()).map(|g| g.id)
            && !held.contains(&g)
            && !out.iter().any(|o| o.0 == id)
        {
            out.push((id, why));
        }
    };
    for r in &m.rigids {
        if let RigidKind::Mean { reference, .. } = &r.kind {
            add(*reference, "rbe3_");
        }
    }
    for r in &m.rigids {
        if let RigidKind::Body { independent, .. } = &r.kind {
            independent.iter().take(1).for_each(|t| add(t.0, "rigid_"));
        }
    }
    if held.is_empty() {
        let terms = m.spcs.iter().flat_map(|s| s.terms.iter());
        terms.for_each(|t| add(t.0, "support_"));
    }
    far_grids(m, &held)
        .into_iter()
        .for_each(|g| add(g, "grid_"));
    out
}

/// Shell grids far from those that are held, and from each other: each the farthest from all before it.
fn far_grids(m: &Model, held: &BTreeSet<GridIx>) -> Vec<GridIx> {
    let place = |g: GridIx| m.grids.get(g.us()).map(|g| g.x);
    let grids: BTreeSet<GridIx> = m
        .shells
        .iter()
        .flat_map(|s| s.grids.iter().take(s.shape.n_grids()).copied())
        .collect();
    let mut near: Vec<(GridIx, Vec3, f64)> = grids
        .iter()
        .filter_map(|g| Some((*g, place(*g)?, f64::INFINITY)))
        .collect();
    let mut taken: Vec<Vec3> = held.iter().filter_map(|g| place(*g)).collect();
    if taken.is_empty() {
        // Free: from the middle outward.
        let sum = near.iter().fold(Vec3::zeros(), |s, n| s + n.1);
        taken.push(sum / near.len().max(1) as f64);
    }
    let mut out = Vec::new();
    while out.len() < MOST_FAR {
        for (_, x, distance) in &mut near {
            for t in &taken {
                *distance = distance.min((*x - t).norm());
            }
        }
        let farthest = near.iter().max_by(|a, b| a.2.total_cmp(&b.2));
        let Some(&(g, x, _)) = farthest.filter(|f| f.2 > 0.0) else {
            break;
        };
        out.push(g);
        taken = vec![x];
    }
    out
}
