//! Simulates the motion of the bodies from wheel forces, or from the measured motion of some of them (thesis 4.4).

use super::layout::Vehicle;
use super::term::Term;
use crate::linalg::tall::left_inverse;
use crate::series::resample::upsample;
use thiserror::Error;

/// Inputs of a simulation, at the sample rate of the record.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Samples per second.
    pub rate_hz: f64,
    /// Force of each wheel. `None` for a wheel without force.
    pub forces: Vec<Option<Vec<f64>>>,
    /// Displacement and velocity of each motion of bodies with prescribed motion; `None` for bodies that move freely.
    pub given: Vec<Option<Vec<[Vec<f64>; 2]>>>,
    /// Constant force on the heave of each body.
    pub constant: Vec<f64>,
    /// Integration steps for each sample. 2 steps are sufficient if the fastest period exceeds 10 samples.
    pub steps: usize,
}

/// Motion of every body, sampled like the drive: `[body][motion][sample]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedMotion {
    /// Displacement.
    pub displacement: Vec<Vec<Vec<f64>>>,
    /// Velocity.
    pub velocity: Vec<Vec<Vec<f64>>>,
    /// Acceleration.
    pub acceleration: Vec<Vec<Vec<f64>>>,
}

/// Reason why a simulation gave no result.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SimulationError {
    /// A body without usable inertia.
    #[error(
        "the inertia of body `{0}` is unknown or singular: state it as known, or give the body's motion"
    )]
    Inertia(String),
    /// The motion grew beyond bounds.
    #[error(
        "the simulated motion diverged at {at_s:.3} s: a parameter has the wrong sign or the steps are too long"
    )]
    Diverged {
        /// Time at which the motion diverges, s.
        at_s: f64,
    },
    /// A term that the simulation has no equation for.
    #[error("link `{0}` has inertance, which cannot be simulated: delete the term")]
    Inertance(String),
    /// Histories of different length.
    #[error(
        "the records that drive the simulation have {found} and {expected} samples: cut them to one length"
    )]
    Length {
        /// Length found.
        found: usize,
        /// Length of the first.
        expected: usize,
    },
}

/// A free body: index of its motions in the state, and its inverse inertia.
struct FreeBody {
    body: usize,
    at: usize,
    n: usize,
    inverse: Vec<Vec<f64>>,
}

/// Data of a time step, in flat lists.
struct Machine<'a> {
    free: Vec<FreeBody>,
    n_state: usize,
    /// Per link: (state index or given index, weight, is given) of each end and motion.
    ends: Vec<Vec<(usize, f64, bool)>>,
    terms: Vec<Vec<(Term, f64)>>,
    /// Per wheel: (state index, phi) and its history.
    wheels: Vec<(Vec<(usize, f64)>, Vec<f64>)>,
    /// Displacement and velocity of given motions, dense.
    given: Vec<[Vec<f64>; 2]>,
    constant: &'a [f64],
}

/// Simulates from rest with the classical Runge-Kutta method of order 4 and fixed steps. Inputs between samples are band-limited interpolations.
///
/// # Errors
/// [`SimulationError`] when inertia is missing, histories differ in length, or the motion runs away.
///
/// # Example
/// Newton's second law for a quarter truck: its masses times their accelerations are the wheel force at each time.
/// ```
/// use strainbridge::vehicle::preset::{PresetRequest, vehicle};
/// use strainbridge::vehicle::simulate::{Drive, simulate};
///
/// let quarter = PresetRequest { model: "front2".to_owned(), ..PresetRequest::default() };
/// let truck = vehicle(&quarter)?;
/// let [m_b, m_f, k_s, c_s] = [3000.0, 600.0, 4e5, 1.1e4];
/// let force: Vec<f64> = (0..200).map(|i| 1e4 * (0.1 * f64::from(i)).sin()).collect();
/// let drive = Drive {
///     rate_hz: 200.0,
///     forces: vec![Some(force.clone())],
///     given: vec![None, None],
///     constant: vec![0.0, 0.0],
///     steps: 4,
/// };
/// let motion = simulate(&truck, &[m_b, m_f, k_s, c_s], &drive)?;
/// for (i, force) in force.iter().enumerate() {
///     let [body, wheel] = [0, 1].map(|b| motion.acceleration[b][0][i]);
///     assert!((m_b * body + m_f * wheel - force).abs() < 1e-6);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simulate(
    vehicle: &Vehicle,
    values: &[f64],
    drive: &Drive,
) -> Result<SimulatedMotion, SimulationError> {
    let steps = drive.steps.max(1);
    let n = samples(drive)?;
    let machine = machine(vehicle, values, drive, 2 * steps)?;
    let h = 1.0 / (drive.rate_hz * steps as f64);
    let m = machine.n_state;
    let mut y = vec![0.0; 2 * m];
    let (mut k1, mut k2, mut k3, mut k4) = (
        vec![0.0; 2 * m],
        vec![0.0; 2 * m],
        vec![0.0; 2 * m],
        vec![0.0; 2 * m],
    );
    let mut mid = vec![0.0; 2 * m];
    let empty = |v: &Vehicle| {
        v.bodies
            .iter()
            .map(|b| vec![Vec::with_capacity(n); b.shape.n()])
            .collect::<Vec<_>>()
    };
    let mut out = SimulatedMotion {
        displacement: empty(vehicle),
        velocity: empty(vehicle),
        acceleration: empty(vehicle),
    };
    for i in 0..n {
        machine.rates(&y, 2 * steps * i, &mut k1);
        for f in &machine.free {
            for j in 0..f.n {
                out.displacement[f.body][j].push(y[f.at + j]);
                out.velocity[f.body][j].push(y[m + f.at + j]);
                out.acceleration[f.body][j].push(k1[m + f.at + j]);
            }
        }
        if y.iter().any(|v| !v.is_finite() || v.abs() > 1e12) {
            return Err(SimulationError::Diverged {
                at_s: i as f64 / drive.rate_hz,
            });
        }
        if i + 1 == n {
            break;
        }
        for s in 0..steps {
            let at = 2 * (steps * i + s);
            if s > 0 {
                machine.rates(&y, at, &mut k1);
            }
            step(&y, &k1, h / 2.0, &mut mid);
            machine.rates(&mid, at + 1, &mut k2);
            step(&y, &k2, h / 2.0, &mut mid);
            machine.rates(&mid, at + 1, &mut k3);
            step(&y, &k3, h, &mut mid);
            machine.rates(&mid, at + 2, &mut k4);
            for j in 0..2 * m {
                y[j] += h / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j]);
            }
        }
    }
    for (b, given) in drive.given.iter().enumerate() {
        for (j, [d, v]) in given.iter().flatten().enumerate() {
            out.displacement[b][j].clone_from(d);
            out.velocity[b][j].clone_from(v);
            out.acceleration[b][j] = vec![f64::NAN; n];
        }
    }
    Ok(out)
}

fn step(y: &[f64], k: &[f64], h: f64, out: &mut [f64]) {
    out.iter_mut()
        .zip(y)
        .zip(k)
        .for_each(|((o, y), k)| *o = y + h * k);
}

fn samples(drive: &Drive) -> Result<usize, SimulationError> {
    let lengths = drive.forces.iter().flatten().map(Vec::len).chain(
        drive
            .given
            .iter()
            .flatten()
            .flatten()
            .flatten()
            .map(Vec::len),
    );
    let mut expected = None;
    for found in lengths {
        match expected {
            None => expected = Some(found),
            Some(e) if e != found => return Err(SimulationError::Length { found, expected: e }),
            _ => {}
        }
    }
    Ok(expected.unwrap_or(0))
}

fn machine<'a>(
    vehicle: &Vehicle,
    values: &[f64],
    drive: &'a Drive,
    dense: usize,
) -> Result<Machine<'a>, SimulationError> {
    let mut out = Machine {
        free: vec![],
        n_state: 0,
        ends: vec![],
        terms: vec![],
        wheels: vec![],
        given: vec![],
        constant: &drive.constant,
    };
    // Index of each body's first motion, in the state or in the list of given motions.
    let mut place = Vec::new();
    for (b, body) in vehicle.bodies.iter().enumerate() {
        let n = body.shape.n();
        if let Some(Some(given)) = drive.given.get(b) {
            place.push((out.given.len(), true));
            out.given.extend(
                given
                    .iter()
                    .map(|[d, v]| [upsample(d, dense), upsample(v, dense)]),
            );
            continue;
        }
        let value = |i: usize, j: usize| {
            values
                .get(vehicle.inertia_index(b, i, j))
                .copied()
                .unwrap_or(f64::NAN)
        };
        let inertia: Vec<Vec<f64>> = (0..n)
            .map(|i| (0..n).map(|j| value(i, j)).collect())
            .collect();
        let usable = inertia.iter().flatten().all(|v| v.is_finite());
        let inverse = left_inverse(&inertia)
            .filter(|_| usable)
            .ok_or_else(|| SimulationError::Inertia(body.name.clone()))?;
        place.push((out.n_state, false));
        out.free.push(FreeBody {
            body: b,
            at: out.n_state,
            n,
            inverse,
        });
        out.n_state += n;
    }
    for (l, link) in vehicle.links.iter().enumerate() {
        if link.terms.contains(&Term::Inertance) {
            return Err(SimulationError::Inertance(link.name.clone()));
        }
        let mut ends = Vec::new();
        for (w, p) in &link.ends {
            let (first, given) = place[p.body];
            ends.extend(
                vehicle
                    .functions(p)
                    .iter()
                    .enumerate()
                    .map(|(j, phi)| (first + j, w * phi, given)),
            );
        }
        out.ends.push(ends);
        let coefficient = |t: usize| {
            values
                .get(vehicle.term_index(l, t))
                .copied()
                .unwrap_or(f64::NAN)
        };
        out.terms.push(
            link.terms
                .iter()
                .enumerate()
                .map(|(t, term)| (*term, coefficient(t)))
                .collect(),
        );
    }
    for (wheel, force) in vehicle.wheels.iter().zip(&drive.forces) {
        let (first, given) = place[wheel.at.body];
        if let (Some(force), false) = (force, given) {
            let phi = vehicle
                .functions(&wheel.at)
                .iter()
                .enumerate()
                .map(|(j, p)| (first + j, *p))
                .collect();
            out.wheels.push((phi, upsample(force, dense)));
        }
    }
    Ok(out)
}

impl Machine<'_> {
    /// Time derivative of the state (displacements, then velocities) at dense sample `at`.
    fn rates(&self, y: &[f64], at: usize, out: &mut [f64]) {
        let m = self.n_state;
        let (velocity, force) = out.split_at_mut(m);
        velocity.copy_from_slice(&y[m..]);
        force.fill(0.0);
        for f in &self.free {
            force[f.at] += self.constant.get(f.body).copied().unwrap_or(0.0);
        }
        for (ends, terms) in self.ends.iter().zip(&self.terms) {
            let (mut d, mut v) = (0.0, 0.0);
            for &(i, w, given) in ends {
                if given {
                    d += w * self.given[i][0][at];
                    v += w * self.given[i][1][at];
                } else {
                    d += w * y[i];
                    v += w * y[m + i];
                }
            }
            let pull: f64 = terms.iter().map(|(t, c)| c * t.basis(d, v)).sum();
            ends.iter()
                .filter(|e| !e.2)
                .for_each(|&(i, w, _)| force[i] -= w * pull);
        }
        for (phi, history) in &self.wheels {
            phi.iter().for_each(|&(i, p)| force[i] += p * history[at]);
        }
        for f in &self.free {
            if let [row] = f.inverse.as_slice() {
                force[f.at] *= row[0];
                continue;
            }
            let load = [
                force[f.at],
                force[f.at + 1],
                if f.n > 2 { force[f.at + 2] } else { 0.0 },
            ];
            for (j, row) in f.inverse.iter().enumerate() {
                force[f.at + j] = row.iter().zip(&load).map(|(a, b)| a * b).sum();
            }
        }
    }
}
