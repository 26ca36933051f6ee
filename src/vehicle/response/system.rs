//! Equations of motion of a vehicle as a first-order system.

use super::types::{Inputs, PrescribedMotion, ResponseError};
use crate::linalg::spd;
use crate::linalg::tall::left_inverse;
use crate::vehicle::layout::Vehicle;
use crate::vehicle::term::Term;
use std::f64::consts::PI;

/// Kind of a motion of a body, with its index among the motions of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coordinate {
    /// The equations determine the motion.
    Free(usize),
    /// The acceleration is an input.
    Accelerated(usize),
    /// The displacement is an input.
    Displaced(usize),
}

/// A vehicle as y' = f(y, u).
///
/// State y: displacements of free motions, their velocities, displacements of accelerated motions, their velocities.
/// Input u: wheel forces, accelerations, displacements, rates of the displacements.
pub(super) struct System {
    /// Kind of every motion, body by body.
    pub coordinates: Vec<Coordinate>,
    /// First motion of each body.
    pub first: Vec<usize>,
    /// Number of free, accelerated and displaced motions.
    pub counts: [usize; 3],
    /// Samples of forces, of accelerations, and of displacements.
    pub samples: [Vec<Vec<f64>>; 3],
    /// Weight of every motion in the stretch of each link.
    links: Vec<Vec<(usize, f64)>>,
    /// Terms of each link with their coefficients.
    terms: Vec<Vec<(Term, f64)>>,
    /// Free motions that each prescribed wheel force moves, with weights.
    wheels: Vec<Vec<(usize, f64)>>,
    /// Inverse inertia of the free motions.
    inverse: Vec<Vec<f64>>,
    /// Inertia of the free motions.
    inertia: Vec<Vec<f64>>,
}

/// Motion of all bodies at one time.
#[derive(Default)]
pub(super) struct Moment {
    /// Displacement of every motion.
    pub displacement: Vec<f64>,
    /// Velocity of every motion.
    pub velocity: Vec<f64>,
    /// Acceleration of every motion; NaN where the displacement is an input.
    pub acceleration: Vec<f64>,
    /// Stretch and rate of each link, and the forces of its spring and of its damper.
    pub links: Vec<[f64; 4]>,
}

impl System {
    /// Returns the system of a vehicle with parameters `values`.
    ///
    /// # Errors
    /// [`ResponseError`] if an inertia is missing or not positive, or a term cannot be simulated.
    pub fn new(vehicle: &Vehicle, values: &[f64], inputs: &Inputs) -> Result<Self, ResponseError> {
        let mut out = Self {
            coordinates: vec![],
            first: vec![],
            counts: [0; 3],
            samples: [vec![], vec![], vec![]],
            links: vec![],
            terms: vec![],
            wheels: vec![],
            inverse: vec![],
            inertia: vec![],
        };
        for (b, body) in vehicle.bodies.iter().enumerate() {
            out.first.push(out.coordinates.len());
            let prescribed = inputs.motions.get(b).and_then(Option::as_ref);
            for j in 0..body.shape.n() {
                let (kind, samples) = match prescribed {
                    None => (0, None),
                    Some(PrescribedMotion::Accelerations(a)) => (1, a.get(j)),
                    Some(PrescribedMotion::Displacements(d)) => (2, d.get(j)),
                };
                let at = out.counts[kind];
                out.counts[kind] += 1;
                out.samples[kind].extend(samples.cloned());
                out.coordinates.push(match kind {
                    0 => Coordinate::Free(at),
                    1 => Coordinate::Accelerated(at),
                    _ => Coordinate::Displaced(at),
                });
            }
        }
        out.set_inertia(vehicle, values)?;
        for (l, link) in vehicle.links.iter().enumerate() {
            if link.terms.contains(&Term::Inertance) {
                return Err(ResponseError::Inertance(link.name.clone()));
            }
            let mut weights = Vec::new();
            for (w, p) in &link.ends {
                let functions = vehicle.functions(p);
                let first = out.first[p.body];
                weights.extend(
                    functions
                        .iter()
                        .enumerate()
                        .map(|(j, f)| (first + j, w * f)),
                );
            }
            out.links.push(weights);
            let value = |t: usize| values.get(vehicle.term_index(l, t)).copied();
            let with_value = |(t, term): (usize, &Term)| (*term, value(t).unwrap_or(f64::NAN));
            out.terms
                .push(link.terms.iter().enumerate().map(with_value).collect());
        }
        for (wheel, force) in vehicle.wheels.iter().zip(&inputs.forces) {
            let Some(force) = force else { continue };
            let first = out.first[wheel.at.body];
            let weight = |(j, f): (usize, &f64)| match out.coordinates[first + j] {
                Coordinate::Free(i) => Some((i, *f)),
                _ => None,
            };
            let functions = vehicle.functions(&wheel.at);
            let weights = functions.iter().enumerate().filter_map(weight).collect();
            out.wheels.push(weights);
            out.samples[0].push(force.clone());
        }
        Ok(out)
    }

    fn set_inertia(&mut self, vehicle: &Vehicle, values: &[f64]) -> Result<(), ResponseError> {
        let n = self.counts[0];
        self.inertia = vec![vec![0.0; n]; n];
        self.inverse = vec![vec![0.0; n]; n];
        for (b, body) in vehicle.bodies.iter().enumerate() {
            let size = body.shape.n();
            let Some(Coordinate::Free(at)) = self.coordinates.get(self.first[b]).copied() else {
                continue;
            };
            let value = |i: usize, j: usize| {
                let value = values.get(vehicle.inertia_index(b, i, j)).copied();
                value.unwrap_or(f64::NAN)
            };
            let rows: Vec<Vec<f64>> = (0..size)
                .map(|i| (0..size).map(|j| value(i, j)).collect())
                .collect();
            let flat: Vec<f64> = rows.iter().flatten().copied().collect();
            let positive = spd::cholesky(&flat, size).is_some();
            let inverse = left_inverse(&rows).filter(|_| positive);
            let inverse = inverse.ok_or_else(|| ResponseError::Inertia(body.name.clone()))?;
            for i in 0..size {
                self.inertia[at + i][at..at + size].copy_from_slice(&rows[i]);
                self.inverse[at + i][at..at + size].copy_from_slice(&inverse[i]);
            }
        }
        Ok(())
    }

    /// Number of states.
    pub fn n_states(&self) -> usize {
        2 * (self.counts[0] + self.counts[1])
    }

    /// Number of inputs: forces, accelerations, displacements, rates of the displacements.
    pub fn n_inputs(&self) -> usize {
        self.samples[0].len() + self.counts[1] + 2 * self.counts[2]
    }

    /// Returns whether every term is proportional to stretch or rate.
    pub fn is_linear(&self) -> bool {
        self.terms.iter().flatten().all(|(t, _)| t.is_linear())
    }

    /// Highest natural frequency of the undamped free motions, Hz, with prescribed bodies held; 0 without springs.
    pub fn fastest_hz(&self) -> f64 {
        let n = self.counts[0];
        // An end stop that is in contact makes the spring stiffer.
        let stiffness = self.stiffness(|t| matches!(t, Term::Stiffness | Term::BumpStop { .. }));
        let flat: Vec<f64> = self.inertia.iter().flatten().copied().collect();
        let Some(lower) = spd::cholesky(&flat, n) else {
            return 0.0;
        };
        let inverse = spd::inverse_lower(&lower, n);
        let half = spd::product(&inverse, &stiffness, n);
        let transposed: Vec<f64> = (0..n * n).map(|i| inverse[(i % n) * n + i / n]).collect();
        let largest = spd::eigenvalues(&spd::product(&half, &transposed, n), n);
        largest
            .last()
            .map_or(0.0, |v| v.max(0.0).sqrt() / (2.0 * PI))
    }

    /// Stiffness of the free motions by the terms that `counts` selects, by rows.
    fn stiffness(&self, counts: impl Fn(&Term) -> bool) -> Vec<f64> {
        let n = self.counts[0];
        let mut stiffness = vec![0.0; n * n];
        for (weights, terms) in self.links.iter().zip(&self.terms) {
            let k = terms.iter().filter(|t| counts(&t.0)).map(|t| t.1).sum();
            spd::add_outer(&mut stiffness, &self.free_row(weights), k);
        }
        stiffness
    }

    /// Weights of the free motions in the stretch of a link.
    fn free_row(&self, weights: &[(usize, f64)]) -> Vec<f64> {
        let mut row = vec![0.0; self.counts[0]];
        for &(i, w) in weights {
            if let Coordinate::Free(i) = self.coordinates[i] {
                row[i] += w;
            }
        }
        row
    }

    /// Stretch of each link under the weight of the free bodies, with all other bodies held; `None` if springs do not carry every free motion.
    pub fn static_stretch(&self, gravity: f64) -> Option<Vec<f64>> {
        let n = self.counts[0];
        let stiffness = self.stiffness(|t| matches!(t, Term::Stiffness));
        let rows: Vec<Vec<f64>> = stiffness.chunks_exact(n).map(<[f64]>::to_vec).collect();
        let inverse = left_inverse(&rows)?;
        let heaves = self
            .first
            .iter()
            .filter_map(|i| match self.coordinates[*i] {
                Coordinate::Free(k) => Some(k),
                _ => None,
            });
        let mut weight = vec![0.0; n];
        for k in heaves {
            let column = self.inertia.iter().map(|row| row[k]);
            weight
                .iter_mut()
                .zip(column)
                .for_each(|(w, m)| *w -= gravity * m);
        }
        let q: Vec<f64> = inverse.iter().map(|row| spd::dot(row, &weight)).collect();
        let stretch = |weights: &Vec<(usize, f64)>| spd::dot(&self.free_row(weights), &q);
        Some(self.links.iter().map(stretch).collect())
    }

    /// Computes the motion of all bodies for a state and an input.
    pub fn moment(&self, y: &[f64], u: &[f64], out: &mut Moment) {
        let [free, accelerated, displaced] = self.counts;
        let forces = self.samples[0].len();
        let n = self.coordinates.len();
        for list in [
            &mut out.displacement,
            &mut out.velocity,
            &mut out.acceleration,
        ] {
            list.resize(n, 0.0);
        }
        out.links.resize(self.links.len(), [0.0; 4]);
        for (i, coordinate) in self.coordinates.iter().enumerate() {
            let (d, v, a) = match *coordinate {
                Coordinate::Free(k) => (y[k], y[free + k], 0.0),
                Coordinate::Accelerated(k) => {
                    let at = 2 * free + k;
                    (y[at], y[at + accelerated], u[forces + k])
                }
                Coordinate::Displaced(k) => {
                    let at = forces + accelerated + k;
                    (u[at], u[at + displaced], f64::NAN)
                }
            };
            out.displacement[i] = d;
            out.velocity[i] = v;
            out.acceleration[i] = a;
        }
        let mut force = vec![0.0; free];
        for (l, (weights, terms)) in self.links.iter().zip(&self.terms).enumerate() {
            let (mut d, mut v) = (0.0, 0.0);
            for &(i, w) in weights {
                d += w * out.displacement[i];
                v += w * out.velocity[i];
            }
            let (mut spring, mut damper) = (0.0, 0.0);
            for (term, c) in terms {
                let pull = c * term.basis(d, v);
                match term {
                    Term::Damping
                    | Term::Friction { .. }
                    | Term::TwoRate
                    | Term::QuadraticDamping => damper += pull,
                    _ => spring += pull,
                }
            }
            out.links[l] = [d, v, spring, damper];
            for &(i, w) in weights {
                if let Coordinate::Free(i) = self.coordinates[i] {
                    force[i] -= w * (spring + damper);
                }
            }
        }
        for (wheel, f) in self.wheels.iter().zip(u) {
            wheel.iter().for_each(|&(i, w)| force[i] += w * f);
        }
        for (i, coordinate) in self.coordinates.iter().enumerate() {
            if let Coordinate::Free(k) = *coordinate {
                out.acceleration[i] = spd::dot(&self.inverse[k], &force);
            }
        }
    }

    /// Time derivative of the state.
    pub fn rates(&self, y: &[f64], u: &[f64], moment: &mut Moment, out: &mut [f64]) {
        self.moment(y, u, moment);
        let [free, accelerated, _] = self.counts;
        for (i, coordinate) in self.coordinates.iter().enumerate() {
            let (at, n) = match *coordinate {
                Coordinate::Free(k) => (k, free),
                Coordinate::Accelerated(k) => (2 * free + k, accelerated),
                Coordinate::Displaced(_) => continue,
            };
            out[at] = moment.velocity[i];
            out[at + n] = moment.acceleration[i];
        }
    }
}
