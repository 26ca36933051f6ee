//! CONM1 and CONM2 as 6 x 6 matrices in the basic frame.

use super::build::Builder;
use super::fault::FaultKind;
use super::types::*;
use crate::linalg::Matrix6;
use std::collections::HashMap;

/// Returns the mass matrix about the grid of a rigid body: mass, centre of gravity from the grid, inertia tensor about the centre of gravity.
///
/// M = [[m I, -m [r]x], [m [r]x, J + m (r.r I - r r')]], displacement then rotation.
pub(super) fn rigid_body_matrix(mass: f64, r: Vec3, inertia: Mat3) -> Matrix6<f64> {
    let cross = Mat3::new(0.0, -r.z, r.y, r.z, 0.0, -r.x, -r.y, r.x, 0.0);
    let mut m = Matrix6::zeros();
    m.fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&(Mat3::identity() * mass));
    m.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-cross * mass));
    m.fixed_view_mut::<3, 3>(3, 0).copy_from(&(cross * mass));
    m.fixed_view_mut::<3, 3>(3, 3)
        .copy_from(&(inertia - cross * cross * mass));
    m
}

impl Builder<'_> {
    pub(super) fn masses(&mut self) {
        let cards = self.cards;
        let mut out = Vec::new();
        for c in &cards.conm2s {
            if !self.element(c.id, "CONM2", c.at) {
                continue;
            }
            let name = format!("CONM2 {}", c.id);
            if c.mass < 0.0 {
                self.fault(
                    name.clone(),
                    "M",
                    c.at,
                    FaultKind::NotPositive {
                        what: "mass",
                        value: c.mass,
                    },
                );
            }
            let Some(grid) = self.grid(c.grid, &name, "G", c.at) else {
                continue;
            };
            let x = self.x(grid);
            let (axes, offset) = if c.cid == -1 {
                // The centre of gravity is a location in the basic system.
                (Mat3::identity(), Vec3::from(c.offset) - x)
            } else {
                let Some(f) = self.frame(c.cid.into(), &name, "CID", c.at) else {
                    continue;
                };
                let axes = self
                    .model
                    .frames
                    .get(f.us())
                    .map_or_else(Mat3::identity, |f| f.axes_at(x));
                (axes, axes.tr_mul(&Vec3::from(c.offset)))
            };
            let [i11, i21, i22, i31, i32, i33] = c.inertia;
            let local = Mat3::new(i11, -i21, -i31, -i21, i22, -i32, -i31, -i32, i33);
            let inertia = axes.tr_mul(&local) * axes;
            out.push(PointMass {
                id: c.id,
                grid,
                matrix: rigid_body_matrix(c.mass, offset, inertia),
                offset,
                at: c.at,
            });
        }
        for c in &cards.conm1s {
            if !self.element(c.id, "CONM1", c.at) {
                continue;
            }
            let name = format!("CONM1 {}", c.id);
            let Some(grid) = self.grid(c.grid, &name, "G", c.at) else {
                continue;
            };
            let Some(f) = self.frame(c.cid.into(), &name, "CID", c.at) else {
                continue;
            };
            let axes = self
                .model
                .frames
                .get(f.us())
                .map_or_else(Mat3::identity, |f| f.axes_at(self.x(grid)));
            let mut local = Matrix6::zeros();
            let mut terms = c.m.iter();
            for i in 0..6 {
                for j in 0..=i {
                    let v = terms.next().copied().unwrap_or(0.0);
                    local[(i, j)] = v;
                    local[(j, i)] = v;
                }
            }
            let mut t = Matrix6::zeros();
            t.fixed_view_mut::<3, 3>(0, 0).copy_from(&axes);
            t.fixed_view_mut::<3, 3>(3, 3).copy_from(&axes);
            let matrix = t.transpose() * local * t;
            out.push(PointMass {
                id: c.id,
                grid,
                matrix,
                offset: Vec3::zeros(),
                at: c.at,
            });
        }
        self.bush_masses(&mut out);
        out.sort_by_key(|m| m.id);
        self.model.masses = out;
    }

    /// Adds M of PBUSH: half of it at each end of a CBUSH. The half at ground has no effect.
    fn bush_masses(&self, out: &mut Vec<PointMass>) {
        let cards = self.cards;
        let masses: HashMap<u32, f64> = cards.pbushes.iter().map(|p| (p.id, p.mass)).collect();
        for b in &cards.bushes {
            let mass = masses.get(&b.pid.unwrap_or(b.id)).copied().unwrap_or(0.0);
            let ends = [Some(b.grids.0), b.grids.1];
            let grids = ends.into_iter().flatten();
            for grid in grids
                .filter_map(|g| self.grid_ix.get(&g))
                .filter(|_| mass != 0.0)
            {
                out.push(PointMass {
                    id: b.id,
                    grid: *grid,
                    matrix: rigid_body_matrix(mass / 2.0, Vec3::zeros(), Mat3::zeros()),
                    offset: Vec3::zeros(),
                    at: b.at,
                });
            }
        }
    }
}
