//! The drawn surface: shells and the outer faces of solids, by property.

use super::mesh_coarsening::coarsen;
use super::part::{Owner, Part};
use super::solids::outer_faces;
use crate::model::{GridIx, Model};
use std::cmp::Reverse;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Maximum number of triangles drawn, with a few fields and with many. Each field has its own numbers in the page, so that many fields need a coarser
/// mesh.
const MOST_TRIANGLES: usize = 120_000;
const LEAST_TRIANGLES: usize = 40_000;
/// Fields up to which the picture is as fine as it gets.
const FEW_FIELDS: usize = 6;
/// Properties that are switched on and off one by one; the smallest beyond go together.
const MOST_PARTS: usize = 40;

/// Level of detail of the finest picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finest {
    /// Where single elements are picked on it.
    Always,
    /// With few fields alone.
    FewFields,
}

/// Returns faces by property, coarsened so that their total stays below a limit. Small parts are unchanged, large parts share the remaining
/// triangles.
pub(super) fn skin(model: &Model, fields: usize, finest: Finest) -> Vec<Part> {
    let limit = match finest {
        Finest::Always => MOST_TRIANGLES,
        Finest::FewFields => MOST_TRIANGLES * FEW_FIELDS / fields.max(FEW_FIELDS),
    };
    skin_within(model, limit.max(LEAST_TRIANGLES))
}

/// Returns the faces by property, with a limit on the total number of triangles.
pub(super) fn skin_within(model: &Model, most: usize) -> Vec<Part> {
    let mut parts = merge_small_parts(collect_faces(model));
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by_key(|i| parts[*i].n_triangles());
    let (mut left, mut n) = (most, parts.len());
    for i in order {
        let most = left / n.max(1);
        parts[i].drawn = coarsen(model, &parts[i], most);
        left = left.saturating_sub(parts[i].drawn.triangles.len());
        n -= 1;
    }
    parts
}

/// A face before its part numbers its grids.
type RawFace = (Owner, [GridIx; 4]);

fn collect_faces(model: &Model) -> Vec<(String, Vec<RawFace>)> {
    let mut by_kind: BTreeMap<(u8, u32), Vec<RawFace>> = BTreeMap::new();
    for (i, s) in model.shells.iter().enumerate() {
        let id = model
            .shell_properties
            .get(s.property.us())
            .map_or(0, |p| p.id);
        let last = if s.shape.n_corners() == 4 { 3 } else { 2 };
        let corners = [s.grids[0], s.grids[1], s.grids[2], s.grids[last]];
        let faces = by_kind.entry((0, id)).or_default();
        faces.push((Owner::Shell(i), corners));
    }
    for (i, corners) in outer_faces(model) {
        let property = model.solids[i].property as usize;
        let id = model.solid_properties.get(property).map_or(0, |p| p.id);
        let faces = by_kind.entry((1, id)).or_default();
        faces.push((Owner::Solid(i), corners));
    }
    if !model.shear_panels.is_empty() {
        let panels = model.shear_panels.iter();
        by_kind.insert((2, 0), panels.map(|p| (Owner::Panel, p.grids)).collect());
    }
    let named = |id: u32| {
        let mut names = model.property_names.iter();
        names
            .find(|n| n.0 == id)
            .map_or(String::new(), |n| format!(" {}", n.1))
    };
    let word = |(kind, id): (u8, u32)| match kind {
        0 => format!("shells {id}{}", named(id)),
        1 => format!("solids {id}{}", named(id)),
        _ => "shear panels".to_owned(),
    };
    by_kind.into_iter().map(|(k, f)| (word(k), f)).collect()
}

/// Numbers the grids of every part. The smallest parts beyond [`MOST_PARTS`] are merged into one part of shells and one part of all other elements.
fn merge_small_parts(mut list: Vec<(String, Vec<RawFace>)>) -> Vec<Part> {
    if list.len() > MOST_PARTS {
        // Shells stay separate from other elements: in a part of shells, each element is one face.
        let mut order: Vec<usize> = (0..list.len()).collect();
        order.sort_by_key(|i| (Reverse(list[*i].1.len()), *i));
        let largest: HashSet<usize> = order.into_iter().take(MOST_PARTS - 2).collect();
        let mut small = ["shell", "other"].map(|kind| (kind, 0, Vec::new()));
        let mut kept = Vec::new();
        for (i, part) in list.into_iter().enumerate() {
            if largest.contains(&i) {
                kept.push(part);
                continue;
            }
            let shells = matches!(part.1.first(), Some((Owner::Shell(_), _)));
            let (_, n, faces) = &mut small[usize::from(!shells)];
            *n += 1;
            faces.extend(part.1);
        }
        for (kind, n, faces) in small.into_iter().filter(|s| s.1 > 0) {
            kept.push((format!("{n} small {kind} properties"), faces));
        }
        list = kept;
    }
    list.into_iter()
        .map(|(name, faces)| {
            let mut part = Part {
                name,
                ..Part::default()
            };
            let mut local: HashMap<GridIx, u32> = HashMap::new();
            for (owner, corners) in faces {
                let ids = corners.map(|g| {
                    *local.entry(g).or_insert_with(|| {
                        part.grids.push(g);
                        part.grids.len() as u32 - 1
                    })
                });
                part.faces.push((owner, ids));
            }
            part
        })
        .collect()
}
