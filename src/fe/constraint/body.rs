//! RBE2, RBAR, RBE1: dofs that follow one rigid motion.

use super::relation::Relation;
use crate::fe::error::Refusal;
use crate::fe::rigid_motion::rigid_matrix;
use crate::linalg::Matrix6;
use crate::model::{GridIx, Mat3, Model, RigidElement};
use nastran::cards::Dofs;

/// Returns the relations of the dependent dofs: with S the rows of rigid motions at each dof, u_dep = S_dep S_ind^-1 u_ind.
///
/// # Errors
/// Independent dofs that are not six or do not fix the motion.
pub(super) fn relations(
    model: &Model,
    axes: &[Option<Mat3>],
    rigid: &RigidElement,
    independent: &[(GridIx, Dofs)],
    dependent: &[(GridIx, Dofs)],
    claim: u32,
) -> Result<Vec<Relation>, Refusal> {
    let refuse = |reason: String| Refusal {
        card: format!("{} {}", rigid.kind.card(), rigid.id),
        at: rigid.at,
        reason,
        remedy: "name six independent dofs that together fix the rigid motion".to_owned(),
    };
    let n: usize = independent.iter().map(|(_, d)| d.len()).sum();
    if n != 6 {
        return Err(refuse(format!("independent dofs: {n}, expected: 6")));
    }
    let Some(&(first, _)) = independent.first() else {
        return Err(refuse("no independent grid".to_owned()));
    };
    let centre = model.grids[first.us()].x;
    let size = independent
        .iter()
        .map(|(g, _)| (model.grids[g.us()].x - centre).norm())
        .fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    // The unknowns are rotations times `size`, so that the conditioning does not depend on the unit of length.
    let rows = |g: GridIx| {
        let mut s = rigid_matrix(&model.grids[g.us()].x, &centre, &axes[g.us()]);
        for mode in 3..6 {
            s.column_mut(mode).scale_mut(1.0 / size);
        }
        s
    };
    let mut own = Matrix6::zeros();
    let mut masters = Vec::with_capacity(6);
    for (g, dofs) in independent {
        let s = rows(*g);
        for i in dofs.iter0() {
            let scale = if i >= 3 { size } else { 1.0 };
            own.set_row(masters.len(), &(s.row(i) * scale));
            masters.push((6 * g.0 + i as u32, scale));
        }
    }
    let singular = own.singular_values();
    if !(singular.min() > 1e-10 * singular.max()) {
        return Err(refuse(
            "the independent dofs do not fix the rigid motion".to_owned(),
        ));
    }
    let Some(inverse) = own.try_inverse() else {
        return Err(refuse(
            "the independent dofs do not fix the rigid motion".to_owned(),
        ));
    };
    let mut all = Vec::new();
    for (g, dofs) in dependent {
        let s = rows(*g) * inverse;
        for i in dofs.iter0() {
            let row = s.row(i);
            let largest = row.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
            let terms = masters
                .iter()
                .zip(row.iter())
                .filter(|(_, v)| v.abs() > 1e-14 * largest)
                .map(|(&(dof, scale), v)| (dof, v * scale))
                .collect();
            all.push(Relation {
                dependent: 6 * g.0 + i as u32,
                terms,
                claim,
            });
        }
    }
    Ok(all)
}
