//! Degrees of freedom that a support holds and that also follow others.

use crate::finding::{Finding, Severity, list_few};
use crate::model::{Model, RigidElement};
use std::collections::BTreeMap;

/// Returns a finding for degrees of freedom that are both held and dependent. An SPC set or PS of a GRID holds them; a rigid element, an RBE3 or an
/// equation of the MPC set makes them dependent. Nastran and the built-in solver refuse to solve them.
pub fn held_dependents(model: &Model, spc: Option<u32>, mpc: Option<u32>) -> Option<Finding> {
    let mut dependents: BTreeMap<(u32, usize), String> = BTreeMap::new();
    for rigid in &model.rigids {
        for (g, dofs) in rigid.kind.dependent_dofs() {
            for i in dofs.iter0() {
                dependents.entry((g.0, i)).or_insert_with(|| name(rigid));
            }
        }
    }
    for set in model.mpcs.iter().filter(|s| Some(s.sid) == mpc) {
        for (g, i, _) in set.equations.iter().filter_map(|(terms, _)| terms.first()) {
            let card = || format!("MPC {}", set.sid);
            dependents
                .entry((g.0, usize::from(*i)))
                .or_insert_with(card);
        }
    }
    let sets = model.spcs.iter().filter(|s| Some(s.sid) == spc);
    let terms: Vec<_> = sets.flat_map(|s| &s.terms).collect();
    let mut both: BTreeMap<(u32, usize), String> = BTreeMap::new();
    let mut note = |at: (u32, usize), by: &dyn Fn() -> String| {
        let Some(card) = dependents.get(&at) else {
            return;
        };
        let grid = model.grids.get(at.0 as usize).map_or(0, |g| g.id);
        both.entry(at)
            .or_insert_with(|| format!("grid {grid} dof {}: {} and {card}", at.1 + 1, by()));
    };
    for (g, dofs, _) in terms {
        for i in dofs.iter0() {
            note((g.0, i), &|| format!("SPC {}", spc.unwrap_or_default()));
        }
    }
    for (g, grid) in (0u32..).zip(&model.grids) {
        for i in grid.ps.iter0() {
            note((g, i), &|| format!("PS of GRID {}", grid.id));
        }
    }
    let named: Vec<&String> = both.values().collect();
    (!both.is_empty()).then(|| {
        Finding::new(
            Severity::Error,
            "contradicting-spc",
            format!("SPC {}", spc.unwrap_or_default()),
            format!(
                "{} degrees of freedom are held and dependent at once ({}): no solver accepts this set",
                both.len(),
                list_few(&named)
            ),
            "remove them from the support, or from the dependent list of the rigid element or equation",
        )
        .with_numbers(both.len() as f64, 0.0)
    })
}

fn name(rigid: &RigidElement) -> String {
    format!("{} {}", rigid.kind.card(), rigid.id)
}
