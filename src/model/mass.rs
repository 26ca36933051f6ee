//! Mass, centre of gravity and rigid-body mass matrix, from masses lumped at grids.
//!
//! Line elements lump by linear weights at their ends, offsets included; shells, panels and solids in equal parts at their corners, those
//! with mid-side grids at the points of a Gauss rule.

use super::point_mass::rigid_body_matrix;
use super::types::*;
use crate::linalg::{Matrix6, Vector6};

/// What a model weighs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    /// Mass, PARAM,WTMASS applied.
    pub mass: f64,
    /// Centre of gravity, basic frame; the origin for a model without mass.
    pub cg: Vec3,
}

impl Weight {
    /// Returns mass and centre of gravity of a rigid-body mass matrix about `about`; `None` without mass.
    ///
    /// Where the mass differs by direction (CONM1, scalar masses), it is the largest of the three along its principal directions, as
    /// Nastran's grid point weight generator lists them in its mass axis system.
    pub(crate) fn of(m: &Matrix6<f64>, about: Vec3) -> Option<Self> {
        let by_axis = [m[(0, 0)], m[(1, 1)], m[(2, 2)]];
        let translation = m.fixed_view::<3, 3>(0, 0).into_owned();
        let even = translation == Mat3::from_diagonal_element(by_axis[0]);
        let mass = match even {
            true => by_axis[0],
            false => translation.symmetric_eigenvalues().max(),
        };
        if !(mass > 0.0) {
            return None;
        }
        let share = |first: f64, i: usize, j: usize| match by_axis[i] + by_axis[j] {
            sum if sum > 0.0 => first / sum,
            _ => 0.0,
        };
        let offset = Vec3::new(
            share(m[(1, 5)] - m[(2, 4)], 1, 2),
            share(m[(2, 3)] - m[(0, 5)], 0, 2),
            share(m[(0, 4)] - m[(1, 3)], 0, 1),
        );
        Some(Self {
            mass,
            cg: about + offset,
        })
    }
}

impl Model {
    /// Returns mass and centre of gravity from [`Self::rigid_body_mass`], WTMASS applied.
    pub fn weight(&self) -> Weight {
        let origin = Vec3::zeros();
        let nothing = Weight {
            mass: 0.0,
            cg: origin,
        };
        Weight::of(&self.rigid_body_mass(origin), origin).unwrap_or(nothing)
    }

    /// Rigid-body mass matrix (6 x 6: translations, then rotations) about the basic location `about`, WTMASS applied.
    ///
    /// OGPWG of a solver is this without WTMASS.
    pub fn rigid_body_mass(&self, about: Vec3) -> Matrix6<f64> {
        let mut sum = Matrix6::zeros();
        let mut point = |m: f64, x: Vec3| {
            if m != 0.0 {
                sum += rigid_body_matrix(m, x - about, Mat3::zeros());
            }
        };
        self.lump_shells(&mut point);
        self.lump_lines(&mut point);
        self.lump_solids(&mut point);
        for c in &self.masses {
            let r = self.at(c.grid) - about;
            // Rigid motion about the reference point, seen at the grid.
            let mut t = Matrix6::identity();
            t.fixed_view_mut::<3, 3>(0, 3).copy_from(&-r.cross_matrix());
            sum += t.transpose() * c.matrix * t;
        }
        for c in &self.scalar_masses {
            let row = self.motion_of(c, about);
            sum += row * row.transpose() * c.mass;
        }
        sum * self.params.wtmass
    }

    /// Returns the motion of a scalar mass in each of the six rigid motions about `about`: first end minus second end. Scalar points and
    /// ground do not move.
    fn motion_of(&self, mass: &ScalarMass, about: Vec3) -> Vector6<f64> {
        let mut row = Vector6::zeros();
        for (end, sign) in mass.ends.iter().zip([1.0, -1.0]) {
            let Some((g, dof)) = end else { continue };
            let Some(grid) = self.grids.get(g.us()).filter(|g| !g.is_scalar()) else {
                continue;
            };
            let dof = usize::from(*dof).min(5);
            let axis = self.cd_axes(*g).row(dof % 3).transpose() * sign;
            let mut add = |first: usize, v: Vec3| (0..3).for_each(|i| row[first + i] += v[i]);
            if dof < 3 {
                add(0, axis);
                add(3, (grid.x - about).cross(&axis));
            } else {
                add(3, axis);
            }
        }
        row
    }

    fn at(&self, g: GridIx) -> Vec3 {
        self.grids.get(g.us()).map_or_else(Vec3::zeros, |g| g.x)
    }

    fn density(&self, m: MaterialIx) -> f64 {
        self.materials.get(m.us()).map_or(0.0, |m| m.rho)
    }

    /// Mass per area of a shell of thickness t: of MID1, else MID2, or of the plies, and the non-structural mass.
    fn shell_mass(&self, p: &ShellProperty, t: f64) -> f64 {
        let structure = match &p.kind {
            ShellKind::Homogeneous {
                membrane, bending, ..
            } => membrane.or(*bending).map_or(0.0, |m| self.density(m) * t),
            ShellKind::Laminate { plies, .. } => {
                plies.iter().map(|p| self.density(p.material) * p.t).sum()
            }
        };
        structure + p.nsm
    }

    fn lump_shells(&self, point: &mut impl FnMut(f64, Vec3)) {
        for s in &self.shells {
            let Some(p) = self.shell_properties.get(s.property.us()) else {
                continue;
            };
            let n = s.shape.n_corners();
            let x = self.corners_of(s);
            let offset = match (s.zoffs, super::shell::shell_normal(&x)) {
                (z, Some(normal)) if z != 0.0 => normal * z,
                _ => Vec3::zeros(),
            };
            match super::curved::shell_parts(s.shape, &self.places_of(s)) {
                Some(parts) => {
                    for part in parts {
                        let t = part
                            .corners
                            .iter()
                            .zip(s.thickness)
                            .map(|(n, t)| n * t)
                            .sum();
                        point(self.shell_mass(p, t) * part.measure, part.x + offset);
                    }
                }
                None => {
                    let t = s.thickness.iter().take(n).sum::<f64>() / n as f64;
                    let mass = self.shell_mass(p, t) * area(&x);
                    x.iter().for_each(|x| point(mass / n as f64, x + offset));
                }
            }
        }
        for s in &self.shear_panels {
            let x = s.grids.map(|g| self.at(g));
            let mass = (self.density(s.material) * s.t + s.nsm) * area(&x);
            x.iter().for_each(|x| point(mass / 4.0, *x));
        }
    }

    /// Returns the area of shell `i` that its mass is computed from.
    pub(super) fn shell_area(&self, i: usize) -> f64 {
        let Some(s) = self.shells.get(i) else {
            return 0.0;
        };
        match super::curved::shell_parts(s.shape, &self.places_of(s)) {
            Some(parts) => parts.iter().map(|p| p.measure).sum(),
            None => area(&self.corners_of(s)),
        }
    }

    /// Returns the area of shear panel `i`.
    pub(super) fn panel_area(&self, i: usize) -> f64 {
        let panel = self.shear_panels.get(i);
        panel.map_or(0.0, |s| area(&s.grids.map(|g| self.at(g))))
    }

    /// Returns the length of bar or beam `i`, offsets included.
    pub(super) fn beam_length(&self, i: usize) -> f64 {
        let length = |b: &Beam| {
            let [a, e] = [0, 1].map(|k| self.at(b.grids[k]) + b.offsets[k]);
            (e - a).norm()
        };
        self.beams.get(i).map_or(0.0, length)
    }

    /// Returns the length of rod `i`.
    pub(super) fn rod_length(&self, i: usize) -> f64 {
        let length = |r: &Rod| (self.at(r.grids[1]) - self.at(r.grids[0])).norm();
        self.rods.get(i).map_or(0.0, length)
    }

    /// Returns the corners of a shell.
    fn corners_of(&self, s: &Shell) -> Vec<Vec3> {
        let corners = s.grids.iter().take(s.shape.n_corners());
        corners.map(|g| self.at(*g)).collect()
    }

    /// Returns the grid locations of a shell, `None` for a missing mid-side grid. In the model, the latter repeats the first corner of its edge.
    fn places_of(&self, s: &Shell) -> Vec<Option<Vec3>> {
        let n = s.shape.n_corners();
        (0..s.shape.n_grids())
            .map(|i| {
                s.grids
                    .get(i)
                    .filter(|g| i < n || s.grids.get(i - n) != Some(g))
            })
            .map(|g| g.map(|g| self.at(*g)))
            .collect()
    }

    fn lump_lines(&self, point: &mut impl FnMut(f64, Vec3)) {
        for b in &self.beams {
            let Some(p) = self.beam_properties.get(b.property.us()) else {
                continue;
            };
            let ends = [
                self.at(b.grids[0]) + b.offsets[0],
                self.at(b.grids[1]) + b.offsets[1],
            ];
            let length = (ends[1] - ends[0]).norm();
            let rho = self.density(p.material);
            let across = |yz: [f64; 2]| b.axes.tr_mul(&Vec3::new(0.0, yz[0], yz[1]));
            // Structure along the neutral axis, non-structural mass along its own, linear between stations.
            for pair in p.sections.windows(2) {
                let [(x0, s0), (x1, s1)] = pair else { continue };
                let share = (x1 - x0) * length;
                let parts = [
                    ([rho * s0.area, rho * s1.area], [s0.neutral, s1.neutral]),
                    ([s0.nsm, s1.nsm], [s0.nsm_centre, s1.nsm_centre]),
                ];
                for (m, yz) in parts {
                    let near = share * (m[0] / 3.0 + m[1] / 6.0);
                    let far = share * (m[0] / 6.0 + m[1] / 3.0);
                    for (mass, x, yz) in [(near, x0, yz[0]), (far, x1, yz[1])] {
                        point(mass * (1.0 - x), ends[0] + across(yz));
                        point(mass * x, ends[1] + across(yz));
                    }
                }
            }
        }
        for r in &self.rods {
            let x = r.grids.map(|g| self.at(g));
            let mass = (self.density(r.material) * r.area + r.nsm) * (x[1] - x[0]).norm();
            x.iter().for_each(|x| point(mass / 2.0, *x));
        }
    }

    fn lump_solids(&self, point: &mut impl FnMut(f64, Vec3)) {
        for s in &self.solids {
            let rho = self
                .solid_properties
                .get(s.property as usize)
                .map_or(0.0, |p| self.density(p.material));
            let all: Vec<Option<Vec3>> = s.grids.iter().map(|g| g.map(|g| self.at(g))).collect();
            if let Some(parts) = super::curved::solid_parts(s.shape, &all) {
                parts.iter().for_each(|p| point(rho * p.measure, p.x));
                continue;
            }
            let x: Vec<Vec3> = s
                .grids
                .iter()
                .take(s.shape.n_corners())
                .flatten()
                .map(|g| self.at(*g))
                .collect();
            let mass = rho * super::face::volume(s.shape, &x);
            x.iter().for_each(|p| point(mass / x.len() as f64, *p));
        }
    }
}

/// Area of a triangle, or of a quad by its diagonals.
fn area(x: &[Vec3]) -> f64 {
    match x {
        [a, b, c] => (b - a).cross(&(c - a)).norm() / 2.0,
        [a, b, c, d] => (c - a).cross(&(d - b)).norm() / 2.0,
        _ => 0.0,
    }
}
