//! Where a lumped mass hangs: the grids that an RBE3 ties it to, and the forces that it puts on them.

use crate::linalg::{Matrix6, Vector6};
use crate::model::{GridIx, Model, RigidKind, Vec3};
use std::collections::BTreeSet;

/// Arms in each quadrant of the plan around a mass.
const PER_QUADRANT: usize = 4;
/// Smallest to largest singular value of the arms' rigid motions: below this they lie on a line.
const LINE: f64 = 1e-8;

/// Grids that may carry a mass.
#[derive(Clone, Debug)]
pub struct Carriers {
    grids: Vec<(GridIx, Vec3)>,
    axis: usize,
}

impl Carriers {
    /// Returns the grids of the shells whose property id `allowed` accepts, or of the bars and beams if `model` has no such shell. Grids that a rigid
    /// element moves are excluded. `axis` points up.
    pub fn from_model(model: &Model, axis: usize, allowed: impl Fn(u32) -> bool) -> Self {
        let dependent: BTreeSet<GridIx> = model
            .rigids
            .iter()
            .flat_map(|r| match &r.kind {
                RigidKind::Mean { reference, .. } => vec![*reference],
                other => other.dependent_dofs().iter().map(|d| d.0).collect(),
            })
            .collect();
        let shells = model.shells.iter().filter(|s| {
            let property = model.shell_properties.get(s.property.us());
            property.is_some_and(|p| allowed(p.id))
        });
        let mut ids: BTreeSet<GridIx> = shells
            .flat_map(|s| s.grids[..s.shape.n_corners()].to_vec())
            .collect();
        if ids.is_empty() {
            let beams = model.beams.iter().filter(|b| {
                let property = model.beam_properties.get(b.property.us());
                property.is_some_and(|p| allowed(p.id))
            });
            ids = beams.flat_map(|b| b.grids).collect();
        }
        let grids = ids
            .difference(&dependent)
            .filter_map(|g| model.grids.get(g.us()).map(|grid| (*g, grid.x)))
            .collect();
        Self { grids, axis }
    }

    /// Returns the lower and upper bound of the carriers along the two plan axes, then along the vertical axis. `None` without carriers.
    pub fn extent(&self) -> Option<[[f64; 2]; 3]> {
        let (b, c) = self.plan();
        self.grids.first()?;
        Some([b, c, self.axis].map(|k| {
            self.grids
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |r, g| {
                    [r[0].min(g.1[k]), r[1].max(g.1[k])]
                })
        }))
    }

    /// Returns the plan axes. If z points up, they are x and y.
    pub fn plan(&self) -> (usize, usize) {
        ((self.axis + 1) % 3, (self.axis + 2) % 3)
    }

    /// Returns the point at this place in plan and this height.
    pub fn point(&self, plan: [f64; 2], height: f64) -> Vec3 {
        let (b, c) = self.plan();
        let mut x = Vec3::zeros();
        (x[b], x[c], x[self.axis]) = (plan[0], plan[1], height);
        x
    }

    /// Returns the grids that carry a mass at this place: the four nearest grids in each quadrant of the plan around the place.
    pub fn arms(&self, plan: [f64; 2]) -> Vec<GridIx> {
        let (b, c) = self.plan();
        let mut quadrants: [Vec<(f64, GridIx)>; 4] = Default::default();
        for (g, x) in &self.grids {
            let (db, dc) = (x[b] - plan[0], x[c] - plan[1]);
            let q = usize::from(db >= 0.0) + 2 * usize::from(dc >= 0.0);
            quadrants[q].push((db * db + dc * dc, *g));
        }
        let mut arms: Vec<GridIx> = Vec::new();
        for mut q in quadrants {
            q.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            arms.extend(q.into_iter().take(PER_QUADRANT).map(|g| g.1));
        }
        arms.sort_unstable();
        arms
    }
}

/// Returns the forces that an RBE3 with equal weights and translations 123 applies to its arms for a force at `at`.
///
/// The force of an arm is `f_k = S_k (sum S'S)^-1 (F, 0)` with `S_k = [I, -[x_k - at] x]`. `None` if all arms are on one line.
///
/// # Example
/// The forces on the arms are in equilibrium with the force, and near arms take more of it:
/// ```
/// use nastran::bdf::{MemoryLoader, read_deck};
/// use strainbridge::model::{GridIx, Model, Vec3};
/// use strainbridge::payload::spread;
///
/// let text = "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,2.,1.,0.\nGRID,4,,0.,1.,0.\nENDDATA\n";
/// let deck = read_deck("arms.bdf", text.into(), &mut MemoryLoader::default());
/// let (model, _) = Model::from_deck(&deck);
/// let (at, force) = (Vec3::new(0.5, 0.6, 0.3), Vec3::new(0.0, 0.0, -100.0));
/// let forces = spread(&model, &[0, 1, 2, 3].map(GridIx), at, force).unwrap();
/// let sum: Vec3 = forces.iter().map(|f| f.1).sum();
/// let moment: Vec3 = forces.iter().map(|(g, f)| (model.grids[g.us()].x - at).cross(f)).sum();
/// assert!((sum - force).norm() < 1e-9 && moment.norm() < 1e-9);
/// assert!(forces[0].1.z < forces[1].1.z); // both downward, grid 1 is nearer
/// ```
pub fn spread(
    model: &Model,
    arms: &[GridIx],
    at: Vec3,
    force: Vec3,
) -> Option<Vec<(GridIx, Vec3)>> {
    let x: Vec<Vec3> = arms
        .iter()
        .map(|g| model.grids.get(g.us()).map(|grid| grid.x - at))
        .collect::<Option<_>>()?;
    let square = x.iter().map(|r| r.norm_squared()).sum::<f64>() / x.len().max(1) as f64;
    let length = if square > 0.0 { square.sqrt() } else { 1.0 };
    // Rows of the rigid-body motion (t, theta length) at an arm.
    let row = |r: &Vec3, i: usize| {
        let mut e = Vec3::zeros();
        e[i] = 1.0;
        let turn = (r / length).cross(&e);
        Vector6::new(e.x, e.y, e.z, turn.x, turn.y, turn.z)
    };
    let mut normal = Matrix6::zeros();
    for r in &x {
        for i in 0..3 {
            let s = row(r, i);
            normal += s * s.transpose();
        }
    }
    let singular = normal.singular_values();
    if !(singular.min() > LINE * singular.max()) {
        return None;
    }
    let amount = normal.try_inverse()? * Vector6::new(force.x, force.y, force.z, 0.0, 0.0, 0.0);
    Some(
        arms.iter()
            .zip(&x)
            .map(|(g, r)| (*g, Vec3::from_fn(|i, _| row(r, i).dot(&amount))))
            .collect(),
    )
}
