//! RIGID on a PBUSH: components of a bush that don't give way.

use super::build::Builder;
use super::fault::FaultKind;
use super::types::*;
use crate::linalg::DMatrix;
use std::collections::HashSet;

/// A pivot of directions, whose rows have length 1, under which a row counts as a sum of others.
const NOTHING_LEFT: f64 = 1e-9;

type Terms = Vec<(GridIx, u8, f64)>;

impl Builder<'_> {
    /// Adds the equations of rigid bushes. It must run after everything else that makes dofs dependent or holds dofs.
    pub(super) fn rigid_bushes(&mut self) {
        let [mut taken, in_sets] = self.constrained_dofs();
        for i in 0..self.model.bushes.len() {
            let Some(bush) = self.model.bushes.get(i).copied() else {
                continue;
            };
            if !bush.rigid.contains(&true) {
                continue;
            }
            // B follows A, or A follows B if another element moves B. A bush to ground fixes A.
            let ends: Vec<GridIx> = bush.grids.1.into_iter().chain([bush.grids.0]).collect();
            let found: Vec<Vec<Terms>> = ends
                .iter()
                .filter_map(|g| self.rigid_components(&bush, *g))
                .collect();
            let outside = |e: &Vec<Terms>, dofs: &HashSet<(GridIx, u8)>| {
                let mut first = e.iter().filter_map(|terms| terms.first());
                first.all(|t| !dofs.contains(&(t.0, t.1)))
            };
            // Prefer an end that is in no SPC or MPC set. An end in a set is still better than one that a rigid element moves, because a load case
            // may not select the set.
            let free = |e: &&Vec<Terms>| outside(e, &taken) && outside(e, &in_sets);
            let of_rigids = |e: &&Vec<Terms>| outside(e, &taken);
            let best = found.iter().find(free);
            let best = best.or_else(|| found.iter().find(of_rigids));
            let Some(equations) = best.or(found.first()).cloned() else {
                let kind = FaultKind::Unsupported {
                    what: "RIGID in directions that hold each other".into(),
                    remedy: "give stiffnesses, or use an RBE2 or RBAR",
                };
                self.fault(format!("CBUSH {}", bush.id), "PID", bush.at, kind);
                continue;
            };
            let first = equations.iter().filter_map(|terms| terms.first());
            taken.extend(first.map(|t| (t.0, t.1)));
            self.model.rigids.push(RigidElement {
                id: bush.id,
                kind: RigidKind::Equations {
                    card: "CBUSH",
                    equations,
                },
                at: bush.at,
            });
        }
        self.model.rigids.sort_by_key(|r| r.id);
    }

    /// Dofs that rigid elements make dependent or a grid holds, whatever the load case; then those that some MPC or SPC set does.
    fn constrained_dofs(&self) -> [HashSet<(GridIx, u8)>; 2] {
        let m = &self.model;
        let each = |(g, dofs): (GridIx, nastran::cards::Dofs)| {
            dofs.iter0().map(move |i| (g, i as u8)).collect::<Vec<_>>()
        };
        let mut all: HashSet<(GridIx, u8)> = HashSet::new();
        all.extend(
            m.rigids
                .iter()
                .flat_map(|r| r.kind.dependent_dofs())
                .flat_map(each),
        );
        let permanent = m.grids.iter().enumerate();
        all.extend(permanent.flat_map(|(i, g)| each((GridIx(i as u32), g.ps))));
        let mut in_sets: HashSet<(GridIx, u8)> = HashSet::new();
        let held = m.spcs.iter().flat_map(|s| &s.terms);
        in_sets.extend(held.map(|t| (t.0, t.1)).flat_map(each));
        let equations = m.mpcs.iter().flat_map(|s| &s.equations);
        in_sets.extend(equations.filter_map(|e| e.0.first()).map(|t| (t.0, t.1)));
        [all, in_sets]
    }

    /// Returns the equations that set the relative displacement of the rigid components to zero. The rows are axes (u_B - u_A) at the location of the
    /// bush, solved for as many dofs of the grid `dependent`. Displacement rows are solved for displacements and rotation rows for rotations, so that
    /// no unit of length enters. In each row the largest pivot is chosen. `None` if a row has no pivot.
    fn rigid_components(&self, bush: &Bush, dependent: GridIx) -> Option<Vec<Terms>> {
        let ends: Vec<(GridIx, f64)> = std::iter::once((bush.grids.0, -1.0))
            .chain(bush.grids.1.map(|g| (g, 1.0)))
            .collect();
        let flags = bush.rigid.iter().enumerate();
        let wanted: Vec<usize> = flags.filter(|(_, r)| **r).map(|(i, _)| i).collect();
        let mut rows = DMatrix::zeros(wanted.len(), 6 * ends.len());
        for (end, (g, sign)) in ends.iter().enumerate() {
            let frame = self.cd_axes(*g).transpose();
            let arm = -(bush.location - self.x(*g)).cross_matrix();
            let direct = bush.axes * frame * *sign;
            let turned = bush.axes * arm * frame * *sign;
            for (r, i) in wanted.iter().enumerate() {
                for c in 0..3 {
                    if *i < 3 {
                        rows[(r, 6 * end + c)] = direct[(*i, c)];
                        rows[(r, 6 * end + 3 + c)] = turned[(*i, c)];
                    } else {
                        rows[(r, 6 * end + 3 + c)] = direct[(*i - 3, c)];
                    }
                }
            }
        }
        let dependent_end = ends.iter().position(|e| e.0 == dependent)?;
        let mut pivots = Vec::with_capacity(wanted.len());
        for (r, i) in wanted.iter().enumerate() {
            let half = 6 * dependent_end + 3 * (i / 3);
            let column = (half..half + 3)
                .filter(|c| !pivots.contains(c))
                .max_by(|a, b| rows[(r, *a)].abs().total_cmp(&rows[(r, *b)].abs()))?;
            let pivot = rows[(r, column)];
            if !(pivot.abs() > NOTHING_LEFT) {
                return None;
            }
            let scaled = rows.row(r) / pivot;
            rows.row_mut(r).copy_from(&scaled);
            for other in (0..wanted.len()).filter(|o| *o != r) {
                let factor = rows[(other, column)];
                let less = &scaled * factor;
                let mut row = rows.row_mut(other);
                row -= less;
            }
            pivots.push(column);
        }
        // The rounding error of the arms is relative to the longest arm.
        let reach = ends
            .iter()
            .map(|(g, _)| (bush.location - self.x(*g)).norm())
            .fold(0.0, f64::max);
        let rounding = |r: usize, c: usize| {
            let lengths = [c % 6 < 3, wanted.get(r).is_none_or(|i| *i < 3)];
            if lengths == [false, true] {
                1e-14 * reach
            } else {
                1e-14
            }
        };
        pivots
            .iter()
            .enumerate()
            .map(|(r, pivot)| {
                let term = |c: usize| -> Option<(GridIx, u8, f64)> {
                    Some((ends.get(c / 6)?.0, (c % 6) as u8, rows[(r, c)]))
                };
                let mut terms = vec![term(*pivot)?];
                let others = (0..6 * ends.len()).filter(|c| !pivots.contains(c));
                let others = others.filter(|c| rows[(r, *c)].abs() > rounding(r, *c));
                terms.extend(others.filter_map(term));
                Some(terms)
            })
            .collect()
    }
}
