//! RBE3: a reference grid that moves as the weighted mean of others.

use super::relation::Relation;
use crate::fe::error::Refusal;
use crate::fe::rigid_motion::rigid_matrix;
use crate::linalg::{DMatrix, Matrix6};
use crate::model::{GridIx, Mat3, Model, RigidElement};
use nastran::cards::Dofs;

/// Returns the relations of an RBE3.
///
/// The reference motion is the rigid motion with the best fit to the arms: u_ref = (sum S' W S)^-1 sum S' W u. S are the rows of rigid motions about
/// the reference at each arm's dofs. W are the weights; weights of rotations are multiplied by the mean squared arm length. REFC picks rows. With UM
/// the same equations are solved for the dofs of UM instead.
///
/// # Errors
/// Arms that do not fix the motion (collinear grids with translations only); UM with a different number of dofs than REFC.
pub(super) fn relations(
    model: &Model,
    axes: &[Option<Mat3>],
    rigid: &RigidElement,
    (reference, refc): (GridIx, Dofs),
    arms: &[(f64, Dofs, GridIx)],
    um: &[(GridIx, Dofs)],
    claim: u32,
) -> Result<Vec<Relation>, Refusal> {
    let refuse = |reason: &str, remedy: &str| Refusal {
        card: format!("RBE3 {}", rigid.id),
        at: rigid.at,
        reason: reason.to_owned(),
        remedy: remedy.to_owned(),
    };
    let centre = model.grids[reference.us()].x;
    let total: f64 = arms.iter().map(|a| a.0.abs()).sum();
    let square: f64 = arms
        .iter()
        .map(|(w, _, g)| w.abs() * (model.grids[g.us()].x - centre).norm_squared())
        .sum();
    if arms.is_empty() || !(total > 0.0) {
        return Err(refuse(
            "no arm with a weight",
            "list grids with weights above zero",
        ));
    }
    let mean_square = square / total;
    let length = if mean_square > 0.0 {
        mean_square.sqrt()
    } else {
        1.0
    };
    // The unknowns are rotations times `length`.
    let rows = |g: GridIx| {
        let mut s = rigid_matrix(&model.grids[g.us()].x, &centre, &axes[g.us()]);
        for mode in 3..6 {
            s.column_mut(mode).scale_mut(1.0 / length);
        }
        s
    };
    let mut normal = Matrix6::zeros();
    let mut columns: Vec<(u32, [f64; 6])> = Vec::new();
    for (w, dofs, g) in arms {
        let s = rows(*g);
        for i in dofs.iter0() {
            let weight = if i >= 3 { w * length * length } else { *w };
            let row = s.row(i);
            normal += row.transpose() * row * weight;
            columns.push((6 * g.0 + i as u32, std::array::from_fn(|m| row[m] * weight)));
        }
    }
    let singular = normal.singular_values();
    if !(singular.min() > 1e-10 * singular.max()) {
        return Err(refuse(
            "its grids do not fix the motion of the reference grid: they are on a line, or too few dofs are listed",
            "add a grid off the line, or rotations (123456) to the arms",
        ));
    }
    let Some(inverse) = normal.try_inverse() else {
        return Err(refuse(
            "its grids do not fix the motion of the reference grid",
            "add grids or dofs",
        ));
    };
    // Rows for the dofs of the reference grid in its displacement frame. Rotations are converted back to radians.
    let back = {
        let mut b = rigid_matrix(&centre, &centre, &axes[reference.us()]);
        for mode in 3..6 {
            b.column_mut(mode).scale_mut(1.0 / length);
        }
        b * inverse
    };
    let mut all: Vec<Relation> = Vec::new();
    for i in refc.iter0() {
        let mut terms: Vec<(u32, f64)> = Vec::new();
        for (dof, column) in &columns {
            let v: f64 = (0..6).map(|m| back[(i, m)] * column[m]).sum();
            match terms.iter_mut().rev().find(|t| t.0 == *dof) {
                Some(t) => t.1 += v,
                None => terms.push((*dof, v)),
            }
        }
        let largest = terms.iter().fold(0.0_f64, |a, t| a.max(t.1.abs()));
        terms.retain(|t| t.1.abs() > 1e-14 * largest);
        all.push(Relation {
            dependent: 6 * reference.0 + i as u32,
            terms,
            claim,
        });
    }
    if um.is_empty() {
        Ok(all)
    } else {
        solve_for(&all, um, &refuse)
    }
}

/// Solves the equations for the dofs of `um`, which become the dependent ones.
fn solve_for(
    all: &[Relation],
    um: &[(GridIx, Dofs)],
    refuse: &dyn Fn(&str, &str) -> Refusal,
) -> Result<Vec<Relation>, Refusal> {
    let wanted: Vec<u32> = um
        .iter()
        .flat_map(|(g, d)| d.iter0().map(move |i| 6 * g.0 + i as u32))
        .collect();
    if wanted.len() != all.len() {
        return Err(refuse(
            "UM has another number of dofs than REFC",
            "name as many dofs in UM as in REFC",
        ));
    }
    let mut others: Vec<u32> = all
        .iter()
        .flat_map(|r| r.terms.iter().map(|t| t.0).chain([r.dependent]))
        .collect();
    others.sort_unstable();
    others.dedup();
    others.retain(|d| !wanted.contains(d));
    // Equation: dependent - sum of terms = 0.
    let coefficient = |r: &Relation, dof: u32| {
        let own = if r.dependent == dof { 1.0 } else { 0.0 };
        own - r
            .terms
            .iter()
            .filter(|t| t.0 == dof)
            .map(|t| t.1)
            .sum::<f64>()
    };
    let n = wanted.len();
    let left = DMatrix::from_fn(n, n, |i, j| coefficient(&all[i], wanted[j]));
    let right = DMatrix::from_fn(n, others.len(), |i, j| -coefficient(&all[i], others[j]));
    let solved = left.full_piv_lu();
    let message = "the dofs of UM do not determine the motion";
    if !solved.is_invertible() {
        return Err(refuse(message, "choose other dofs for UM"));
    }
    let Some(solution) = solved.solve(&right) else {
        return Err(refuse(message, "choose other dofs for UM"));
    };
    Ok(wanted
        .iter()
        .enumerate()
        .map(|(i, &dependent)| Relation {
            dependent,
            terms: others
                .iter()
                .enumerate()
                .map(|(j, &d)| (d, solution[(i, j)]))
                .filter(|t| t.1 != 0.0)
                .collect(),
            claim: all[0].claim,
        })
        .collect())
}
