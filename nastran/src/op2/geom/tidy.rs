//! Removes cards that solvers write in addition to the analyst's cards, and cards that are in two tables.

use std::collections::HashSet;

use super::fields::LARGEST_ID;
use super::records::Geometry;
use crate::place::Placed;

/// Keeps one card of each id; drops properties and materials that the solver made of others: PSHELL and MAT2 of a PCOMP, PBAR of a
/// PBARL, PBEAM of a PBEAML.
pub(in crate::op2) fn tidy(g: &mut Geometry) {
    let c = &mut g.cards;
    let mut twice: Vec<String> = Vec::new();
    let mut once = |card: &str, n: usize| {
        if n > 0 {
            twice.push(format!("{n} {card}"));
        }
    };
    once("GRID", unique(&mut c.grids, |g| g.id));
    once("CORD", unique(&mut c.coords, |x| x.id));
    once("shell", unique(&mut c.shells, |e| e.id));
    once("CSHEAR", unique(&mut c.shear_panels, |e| e.id));
    once("CBAR", unique(&mut c.bars, |e| e.id));
    once("CBEAM", unique(&mut c.beams, |e| e.bar.id));
    once("CROD", unique(&mut c.rods, |e| e.id));
    once("CONROD", unique(&mut c.conrods, |e| e.id));
    once("CBUSH", unique(&mut c.bushes, |e| e.id));
    once("CELAS", unique(&mut c.springs, |e| e.id));
    once("solid", unique(&mut c.solids, |e| e.id));
    once("CONM1", unique(&mut c.conm1s, |e| e.id));
    once("CONM2", unique(&mut c.conm2s, |e| e.id));
    once("CMASS", unique(&mut c.scalar_masses, |e| e.id));
    once("RBE1", unique(&mut c.rbe1s, |e| e.id));
    once("RBE2", unique(&mut c.rbe2s, |e| e.id));
    once("RBE3", unique(&mut c.rbe3s, |e| e.id));
    once("RBAR", unique(&mut c.rbars, |e| e.id));
    once("PSHELL", unique(&mut c.pshells, |p| p.id));
    once("PCOMP", unique(&mut c.pcomps, |p| p.id));
    once("PSHEAR", unique(&mut c.pshears, |p| p.id));
    once("PBAR", unique(&mut c.pbars, |p| p.id));
    once("PBARL", unique(&mut c.pbarls, |p| p.id));
    once("PBEAM", unique(&mut c.pbeams, |p| p.id));
    once("PBEAML", unique(&mut c.pbeamls, |p| p.id));
    once("PROD", unique(&mut c.prods, |p| p.id));
    once("PTUBE", unique(&mut c.ptubes, |p| p.id));
    once("PBUSH", unique(&mut c.pbushes, |p| p.id));
    once("PELAS", unique(&mut c.pelas, |p| p.id));
    once("PMASS", unique(&mut c.pmasses, |p| p.id));
    once("PSOLID", unique(&mut c.psolids, |p| p.id));
    once("MAT1", unique(&mut c.mat1s, |m| m.id));
    once("MAT2", unique(&mut c.mat2s, |m| m.id));
    once("MAT8", unique(&mut c.mat8s, |m| m.id));
    once("MAT9", unique(&mut c.mat9s, |m| m.id));

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

/// Keeps the first card of each id; how many went.
fn unique<T>(list: &mut Vec<Placed<T>>, id: impl Fn(&T) -> u32) -> usize {
    let before = list.len();
    let mut seen = HashSet::with_capacity(before);
    list.retain(|card| seen.insert(id(&card.card)));
    before.saturating_sub(list.len())
}
