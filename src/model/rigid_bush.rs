//! RIGID on a PBUSH: components of a bush that don't give way.

use super::build::Builder;
use super::types::*;
use crate::linalg::DMatrix;

impl Builder<'_> {
    /// Equations that hold the relative displacement of the rigid components at zero: rows axes (u_B - u_A) at the bush's location, solved
    /// for as many dofs of B (of A where the bush is grounded), pivots largest first.
    pub(super) fn rigid_components(&self, bush: &Bush, rigid: &[bool; 6]) -> Option<Rigid> {
        let ends: Vec<(GridIx, f64)> = std::iter::once((bush.grids.0, -1.0))
            .chain(bush.grids.1.map(|g| (g, 1.0)))
            .collect();
        let wanted: Vec<usize> = (0..6).filter(|i| rigid.get(*i) == Some(&true)).collect();
        if wanted.is_empty() {
            return None;
        }
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
        let dependent_end = ends.len() - 1;
        let mut equations = Vec::with_capacity(wanted.len());
        let mut pivots = Vec::with_capacity(wanted.len());
        for r in 0..wanted.len() {
            let columns = 6 * dependent_end..6 * dependent_end + 6;
            let column = columns
                .filter(|c| !pivots.contains(c))
                .max_by(|a, b| rows[(r, *a)].abs().total_cmp(&rows[(r, *b)].abs()))?;
            let pivot = rows[(r, column)];
            if !(pivot.abs() > 1e-12) {
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
        for (r, pivot) in pivots.iter().enumerate() {
            let term = |c: usize| -> Option<(GridIx, u8, f64)> {
                Some((ends.get(c / 6)?.0, (c % 6) as u8, rows[(r, c)]))
            };
            let mut terms = vec![term(*pivot)?];
            let others = (0..6 * ends.len()).filter(|c| !pivots.contains(c));
            terms.extend(others.filter_map(term).filter(|t| t.2.abs() > 1e-14));
            equations.push(terms);
        }
        Some(Rigid {
            id: bush.id,
            kind: RigidKind::Equations {
                card: "CBUSH",
                equations,
            },
            at: bush.at,
        })
    }
}
