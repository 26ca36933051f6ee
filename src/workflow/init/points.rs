//! Grids at which loads are likely to enter a structure, if only its deck is known.

use super::plain_name::plain_name;
use crate::model::{GridIx, Model, RigidKind, Vec3};
use crate::strain_chain::deck::DeckModel;
use nastran::bdf::NameOwner;
use std::collections::{BTreeMap, BTreeSet};

/// Largest number of grids that are proposed if no card indicates where loads enter.
const MOST_FAR: usize = 4;

/// Strength of the indication that a load enters at a point, the strongest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    /// A wheel or hub by its name, or a mass at the end of an axle.
    Wheel,
    /// The hub of a rigid element, the end of a spring, a support of a structure that is free otherwise.
    Hub,
    /// A grid of the mesh far from the supports.
    Far,
}

impl Rank {
    /// All kinds of points.
    pub const ALL: [Self; 3] = [Self::Wheel, Self::Hub, Self::Far];
}

/// A grid where a load may enter.
pub(super) struct LoadPoint {
    /// Grid id.
    pub grid: u32,
    /// Name of the load at this point, without the component.
    pub name: String,
    pub rank: Rank,
}

/// Returns the points, each grid once, the likeliest first. Grids of the mesh are used only if there is no other point.
pub(super) fn load_points(deck: &DeckModel) -> Vec<LoadPoint> {
    let m = &deck.model;
    let held: BTreeSet<GridIx> = m
        .spcs
        .iter()
        .filter(|s| m.selected_spcs.contains(&s.sid))
        .flat_map(|s| s.terms.iter().map(|t| t.0))
        .collect();
    let names = grid_names(deck);
    let mut out: Vec<LoadPoint> = Vec::new();
    let mut add = |g: GridIx, word: &str, rank| {
        if let Some(id) = m.grids.get(g.us()).map(|g| g.id)
            && !held.contains(&g)
            && !out.iter().any(|o| o.grid == id)
        {
            let name = names.get(&id).map(|n| wheel_name(n).0);
            let name = name.unwrap_or_else(|| format!("{word}{id}"));
            let (grid, rank) = (id, rank);
            out.push(LoadPoint { grid, name, rank });
        }
    };
    let named_wheels = names.iter().filter(|(_, n)| wheel_name(n).1);
    named_wheels
        .filter_map(|(id, _)| m.grid_ix(*id))
        .for_each(|g| add(g, "", Rank::Wheel));
    let ends = axle_ends(m);
    ends.into_iter().for_each(|g| add(g, "axle_", Rank::Wheel));
    for r in &m.rigids {
        if let RigidKind::Mean { reference, .. } = &r.kind {
            add(*reference, "rbe3_", Rank::Hub);
        }
    }
    for r in &m.rigids {
        if let RigidKind::Body { independent, .. } = &r.kind {
            let first = independent.iter().take(1);
            first.for_each(|t| add(t.0, "rigid_", Rank::Hub));
        }
    }
    let ends = spring_ends(m);
    ends.into_iter().for_each(|g| add(g, "spring_", Rank::Hub));
    if held.is_empty() {
        let terms = m.spcs.iter().flat_map(|s| s.terms.iter());
        terms.for_each(|t| add(t.0, "support_", Rank::Hub));
    }
    let far = far_grids(m, &held);
    far.into_iter().for_each(|g| add(g, "grid_", Rank::Far));
    out.sort_by_key(|p| p.rank);
    out
}

/// Names of grids from the deck's comments.
fn grid_names(deck: &DeckModel) -> BTreeMap<u32, String> {
    let labels = deck.deck.labels.iter();
    let named = labels.filter(|l| l.kind == NameOwner::Grid);
    named.map(|l| (l.id, l.name.clone())).collect()
}

/// Returns the name for the loads of a named grid, and whether the grid is a wheel: `wheel LF` gives `LF`.
fn wheel_name(name: &str) -> (String, bool) {
    const WHEEL: [&str; 6] = ["wheel", "hub", "tyre", "tire", "spindle", "rad"];
    let is_wheel = |w: &str| WHEEL.contains(&w.to_lowercase().as_str());
    let words: Vec<&str> = name.split([' ', '_', '-', '.']).collect();
    let others: Vec<&str> = words.iter().filter(|w| !is_wheel(w)).copied().collect();
    match others.len() {
        0 => (plain_name(name), true),
        n => (plain_name(&others.join("_")), n < words.len()),
    }
}

/// Grids with a mass at the end of a chain of bars and beams: one bar there, no shell, no solid.
fn axle_ends(m: &Model) -> BTreeSet<GridIx> {
    let mut bars: BTreeMap<GridIx, usize> = BTreeMap::new();
    for g in m.beams.iter().flat_map(|b| b.grids) {
        *bars.entry(g).or_default() += 1;
    }
    let meshed = shell_and_solid_grids(m);
    let masses = m.masses.iter().map(|p| p.grid);
    masses
        .filter(|g| bars.get(g) == Some(&1) && !meshed.contains(g))
        .collect()
}

/// Returns the ends of bushes and springs to which only the spring is connected, or that are connected to ground.
fn spring_ends(m: &Model) -> BTreeSet<GridIx> {
    let bushes = m.bushes.iter().map(|b| [Some(b.grids.0), b.grids.1]);
    let springs = m.springs.iter().map(|s| s.ends.map(|e| e.map(|e| e.0)));
    let meshed = shell_and_solid_grids(m);
    let mut out = BTreeSet::new();
    for ends in bushes.chain(springs) {
        let grounded = ends.contains(&None);
        let free = |g: &GridIx| grounded || !meshed.contains(g);
        out.extend(ends.into_iter().flatten().filter(free));
    }
    out
}

/// Grids of shells and solids.
fn shell_and_solid_grids(m: &Model) -> BTreeSet<GridIx> {
    let shells = m.shells.iter().flat_map(|s| &s.grids[..s.shape.n_grids()]);
    let solids = m.solids.iter().flat_map(|s| s.grids.iter().flatten());
    shells.chain(solids).copied().collect()
}

/// Returns shell grids far from held grids and from each other. Each grid is the farthest from all previous ones.
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
        // A free structure starts from the middle outward.
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
