//! Mass, centre of gravity and rigid-body mass matrix, from masses lumped at grids.
//!
//! Line elements lump by linear weights at their ends, offsets included; shells, panels and solids in equal parts at their corners, those
//! with mid-side grids at the points of a Gauss rule.

use super::point_mass::rigid_body_matrix;
use super::types::*;
use crate::linalg::Matrix6;

/// What a model weighs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    /// Mass, PARAM,WTMASS applied.
    pub mass: f64,
    /// Centre of gravity, basic frame; the origin for a model without mass.
    pub cg: Vec3,
}

impl Model {
    /// Mass and centre of gravity, WTMASS applied.
    pub fn weight(&self) -> Weight {
        let m = self.rigid_body_mass(Vec3::zeros());
        let mass = m[(0, 0)];
        let cg = if mass != 0.0 {
            Vec3::new(m[(1, 5)], -m[(0, 5)], m[(0, 4)]) / mass
        } else {
            Vec3::zeros()
        };
        Weight { mass, cg }
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
        sum * self.params.wtmass
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
            let x: Vec<Vec3> = s.grids.iter().take(n).map(|g| self.at(*g)).collect();
            let offset = match (s.zoffs, super::shell::shell_normal(&x)) {
                (z, Some(normal)) if z != 0.0 => normal * z,
                _ => Vec3::zeros(),
            };
            // A missing mid-side grid repeats the first corner of its edge.
            let all: Vec<Option<Vec3>> = (0..s.shape.n_grids())
                .map(|i| {
                    s.grids
                        .get(i)
                        .filter(|g| i < n || s.grids.get(i - n) != Some(g))
                })
                .map(|g| g.map(|g| self.at(*g)))
                .collect();
            match super::curved::shell_parts(s.shape, &all) {
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
