//! Removes cards that solvers write in addition to the analyst's cards, and cards that are in two tables.

use std::collections::HashSet;

use super::fields::LARGEST_ID;
use super::records::Geometry;
use crate::place::PlacedCard;

/// Keeps one card of each id, and removes properties and materials that the solver made from other cards. These are PSHELL and MAT2 from a PCOMP,
/// PBAR from a PBARL, and PBEAM from a PBEAML.
pub(in crate::op2) fn tidy(g: &mut Geometry) {
    let c = &mut g.cards;
    let mut twice: Vec<String> = Vec::new();
    let mut once = |card: &str, n: usize| {
        if n > 0 {
            twice.push(format!("{n} {card}"));
        }
    };
    once("GRID", remove_duplicate_ids(&mut c.grids, |g| g.id));
    once("CORD", remove_duplicate_ids(&mut c.coords, |x| x.id));
    once("shell", remove_duplicate_ids(&mut c.shells, |e| e.id));
    once(
        "CSHEAR",
        remove_duplicate_ids(&mut c.shear_panels, |e| e.id),
    );
    once("CBAR", remove_duplicate_ids(&mut c.bars, |e| e.id));
    once("CBEAM", remove_duplicate_ids(&mut c.beams, |e| e.bar.id));
    once("CROD", remove_duplicate_ids(&mut c.rods, |e| e.id));
    once("CONROD", remove_duplicate_ids(&mut c.conrods, |e| e.id));
    once("CBUSH", remove_duplicate_ids(&mut c.bushes, |e| e.id));
    once("CELAS", remove_duplicate_ids(&mut c.springs, |e| e.id));
    once("solid", remove_duplicate_ids(&mut c.solids, |e| e.id));
    once("CONM1", remove_duplicate_ids(&mut c.conm1s, |e| e.id));
    once("CONM2", remove_duplicate_ids(&mut c.conm2s, |e| e.id));
    once(
        "CMASS",
        remove_duplicate_ids(&mut c.scalar_masses, |e| e.id),
    );
    once("RBE1", remove_duplicate_ids(&mut c.rbe1s, |e| e.id));
    once("RBE2", remove_duplicate_ids(&mut c.rbe2s, |e| e.id));
    once("RBE3", remove_duplicate_ids(&mut c.rbe3s, |e| e.id));
    once("RBAR", remove_duplicate_ids(&mut c.rbars, |e| e.id));
    once("PSHELL", remove_duplicate_ids(&mut c.pshells, |p| p.id));
    once("PCOMP", remove_duplicate_ids(&mut c.pcomps, |p| p.id));
    once("PSHEAR", remove_duplicate_ids(&mut c.pshears, |p| p.id));
    once("PBAR", remove_duplicate_ids(&mut c.pbars, |p| p.id));
    once("PBARL", remove_duplicate_ids(&mut c.pbarls, |p| p.id));
    once("PBEAM", remove_duplicate_ids(&mut c.pbeams, |p| p.id));
    once("PBEAML", remove_duplicate_ids(&mut c.pbeamls, |p| p.id));
    once("PROD", remove_duplicate_ids(&mut c.prods, |p| p.id));
    once("PTUBE", remove_duplicate_ids(&mut c.ptubes, |p| p.id));
    once("PBUSH", remove_duplicate_ids(&mut c.pbushes, |p| p.id));
    once("PELAS", remove_duplicate_ids(&mut c.pelas, |p| p.id));
    once("PMASS", remove_duplicate_ids(&mut c.pmasses, |p| p.id));
    once("PSOLID", remove_duplicate_ids(&mut c.psolids, |p| p.id));
    once("MAT1", remove_duplicate_ids(&mut c.mat1s, |m| m.id));
    once("MAT2", remove_duplicate_ids(&mut c.mat2s, |m| m.id));
    once("MAT8", remove_duplicate_ids(&mut c.mat8s, |m| m.id));
    once("MAT9", remove_duplicate_ids(&mut c.mat9s, |m| m.id));

    c.psolids
        .retain(|p| p.options.last().and_then(Option::as_deref) != Some("FAKE"));
    let laminates: HashSet<u32> = c.pcomps.iter().map(|p| p.id).collect();
    c.pshells.retain(|p| !laminates.contains(&p.id));
    let used: HashSet<u32> = c
        .pshells
        .iter()
        .flat_map(|p| {
            [
                p.mid1,
                p.mid3,
                p.mid4,
                p.mid2.and_then(|m| u32::try_from(m).ok()),
            ]
        })
        .flatten()
        .collect();
    c.mat2s
        .retain(|m| i64::from(m.id) <= LARGEST_ID || used.contains(&m.id));
    let barls: HashSet<u32> = c.pbarls.iter().map(|p| p.id).collect();
    c.pbars.retain(|p| !barls.contains(&p.id));
    let beamls: HashSet<u32> = c.pbeamls.iter().map(|p| p.id).collect();
    c.pbeams.retain(|p| !beamls.contains(&p.id));
    let mut entries = HashSet::new();
    c.unread
        .retain(|e| e.is_load || entries.insert(e.card.clone()));
    if !twice.is_empty() {
        g.note(
            "GEOM",
            format!(
                "cards with the id of an earlier one were left out: {}",
                twice.join(", ")
            ),
        );
    }
}

/// Keeps the first card of each id; returns the number of removed cards.
fn remove_duplicate_ids<T>(list: &mut Vec<PlacedCard<T>>, id: impl Fn(&T) -> u32) -> usize {
    let before = list.len();
    let mut seen = HashSet::with_capacity(before);
    list.retain(|card| seen.insert(id(&card.card)));
    before.saturating_sub(list.len())
}
