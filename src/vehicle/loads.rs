//! Wheel forces from a fitted vehicle and measured motion.

use super::identification::Identification;
use super::layout::Vehicle;
use super::motion::Motion;
use crate::estimate::LoadEstimate;
use crate::linalg::tall::{left_inverse, solve, triangle};

/// Shares of the signals that are added to the spring path of each wheel force: `share[wheel][signal]` over `signals`. Missing shares are 0.
pub type Blend = Vec<Vec<f64>>;

/// A history of recovered loads, each with one standard deviation for all samples.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadHistory {
    /// Samples per second.
    pub rate_hz: f64,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Load names.
    pub names: Vec<String>,
    /// Samples, one list for each load.
    pub values: Vec<Vec<f64>>,
    /// One standard deviation of a sample of each load.
    pub sigma: Vec<f64>,
}

/// Computes the force of each link: the sum of its terms, positive in tension.
pub fn link_forces(vehicle: &Vehicle, values: &[f64], motion: &Motion) -> Vec<Vec<f64>> {
    let mut out = Vec::new();
    for (l, terms) in motion.terms.iter().enumerate() {
        let mut force = vec![0.0; motion.n_samples()];
        for (t, column) in terms.iter().enumerate() {
            let c = values
                .get(vehicle.term_index(l, t))
                .copied()
                .unwrap_or(f64::NAN);
            force.iter_mut().zip(column).for_each(|(f, x)| *f += c * x);
        }
        out.push(force);
    }
    out
}

/// Returns the outside force that each motion of a body needs: M q'' + sum of link forces. It is 0 for a sprung body in a perfect model.
pub fn needed_forces(
    vehicle: &Vehicle,
    values: &[f64],
    motion: &Motion,
    links: &[Vec<f64>],
    body: usize,
) -> Vec<Vec<f64>> {
    let motions = &motion.bodies[body];
    (0..motions.len())
        .map(|j| {
            let mut g = vec![0.0; motion.n_samples()];
            for (i, q) in motions.iter().enumerate() {
                let m = values
                    .get(vehicle.inertia_index(body, i, j))
                    .copied()
                    .unwrap_or(f64::NAN);
                g.iter_mut().zip(q).for_each(|(g, a)| *g += m * a);
            }
            for (link, force) in vehicle.links.iter().zip(links) {
                let w: f64 = link
                    .ends
                    .iter()
                    .filter(|e| e.1.body == body)
                    .map(|(w, p)| w * vehicle.functions(p)[j])
                    .sum();
                if w != 0.0 {
                    g.iter_mut().zip(force).for_each(|(g, f)| *g += w * f);
                }
            }
            g
        })
        .collect()
}

/// Returns the residuals of the equations of bodies without wheels.
pub fn sprung_residuals(
    vehicle: &Vehicle,
    values: &[f64],
    motion: &Motion,
    links: &[Vec<f64>],
) -> Vec<Vec<f64>> {
    let free = |b: usize| !vehicle.is_witness(b) && vehicle.wheels.iter().all(|w| w.at.body != b);
    (0..vehicle.bodies.len())
        .filter(|b| free(*b))
        .flat_map(|b| needed_forces(vehicle, values, motion, links, b))
        .collect()
}

/// Returns the force of each wheel in the band. It is unsprung inertia plus link forces (thesis 5.7), plus the blended share of the residuals of the
/// sprung equations.
///
/// With a blend of 0 the force is from the spring path. With shares that sum to 1 it is from total momentum (sum of m a). It is NaN if a body carries
/// more wheels than it has motions.
pub fn wheel_forces(
    vehicle: &Vehicle,
    values: &[f64],
    motion: &Motion,
    blend: &Blend,
) -> Vec<Vec<f64>> {
    let links = link_forces(vehicle, values, motion);
    let mut out = vec![vec![f64::NAN; motion.n_samples()]; vehicle.wheels.len()];
    for b in 0..vehicle.bodies.len() {
        let own: Vec<usize> = (0..vehicle.wheels.len())
            .filter(|&w| vehicle.wheels[w].at.body == b)
            .collect();
        if own.is_empty() {
            continue;
        }
        let needed = needed_forces(vehicle, values, motion, &links, b);
        let columns: Vec<Vec<f64>> = own
            .iter()
            .map(|&w| vehicle.functions(&vehicle.wheels[w].at))
            .collect();
        let rows: Vec<Vec<f64>> = (0..needed.len())
            .map(|j| columns.iter().map(|c| c[j]).collect())
            .collect();
        let Some(inverse) = left_inverse(&rows) else {
            continue;
        };
        for (row, &w) in inverse.iter().zip(&own) {
            out[w] = (0..motion.n_samples())
                .map(|t| row.iter().zip(&needed).map(|(r, g)| r * g[t]).sum())
                .collect();
        }
    }
    if blend.iter().flatten().any(|s| *s != 0.0) {
        let signals = signals(vehicle, values, motion, &links);
        for (force, shares) in out.iter_mut().zip(blend) {
            for (r, s) in signals.iter().zip(shares).filter(|(_, s)| **s != 0.0) {
                force.iter_mut().zip(r).for_each(|(f, r)| *f += s * r);
            }
        }
    }
    out
}

/// Returns the signals of a blend. These are residuals of the sprung equations, then the accelerations of all bodies, then all link terms for a
/// coefficient of one.
fn signals(
    vehicle: &Vehicle,
    values: &[f64],
    motion: &Motion,
    links: &[Vec<f64>],
) -> Vec<Vec<f64>> {
    let mut out = sprung_residuals(vehicle, values, motion, links);
    out.extend(motion.bodies.iter().flatten().cloned());
    out.extend(motion.terms.iter().flatten().cloned());
    out
}

/// Share of the physical blend's error below which a free combination of all signals replaces it.
const FREE_GAIN: f64 = 0.85;

/// Computes the blend that fits measured wheel forces best. The shares are empty if no wheel force is measured.
///
/// The first choice is shares of the sprung residuals. They weight the spring path against the momentum path and keep the physical parameters. The
/// model may lack an effect that the sensors measure, for example the other side of a beam axle, or friction. The blend is then a free combination of
/// all accelerations and link terms, a calibrated transfer from motion to force.
pub fn best_blend(vehicle: &Vehicle, values: &[f64], motion: &Motion) -> Blend {
    let links = link_forces(vehicle, values, motion);
    let signals = signals(vehicle, values, motion, &links);
    let n_residuals = sprung_residuals(vehicle, values, motion, &links).len();
    let spring_path = wheel_forces(vehicle, values, motion, &vec![vec![]; vehicle.wheels.len()]);
    let fitted = |gap: &[f64], range: std::ops::Range<usize>| -> Option<(Vec<f64>, f64)> {
        let n = range.len();
        let mut columns: Vec<(usize, &[f64])> = signals[range.clone()]
            .iter()
            .enumerate()
            .map(|(i, r)| (i, r.as_slice()))
            .collect();
        columns.push((n, gap));
        let t = triangle(&columns);
        let x = solve(&[(1.0, &t)], n).x;
        let mut all = x.clone();
        all.push(-1.0);
        let mut shares = vec![0.0; range.start];
        shares.extend(&x);
        x.iter()
            .all(|v| v.is_finite())
            .then(|| (shares, t.norm(&all)))
    };
    let share = |w: usize| -> Option<Vec<f64>> {
        let measured = motion.forces.get(w)?.as_ref()?;
        let gap: Vec<f64> = measured
            .iter()
            .zip(&spring_path[w])
            .map(|(m, s)| m - s)
            .collect();
        let (physical, error) = fitted(&gap, 0..n_residuals)?;
        match fitted(&gap, n_residuals..signals.len()) {
            Some((free, left)) if left < FREE_GAIN * error => Some(free),
            _ => Some(physical),
        }
    };
    (0..vehicle.wheels.len())
        .map(|w| share(w).unwrap_or_default())
        .collect()
}

/// Returns the wheel forces of a record in the band. The sigma of a sample is from the residual of the identification.
pub fn wheel_force_history(found: &Identification, motion: &Motion) -> LoadHistory {
    let v = &found.vehicle;
    LoadHistory {
        rate_hz: motion.rate_hz,
        start_s: motion.start_s,
        names: v.wheels.iter().map(|w| w.channel.clone()).collect(),
        values: scaled_wheel_forces(found, motion),
        sigma: (0..v.wheels.len())
            .map(|w| found.wheel_force_sigma[w].unwrap_or(f64::NAN))
            .collect(),
    }
}

/// Wheel forces where the identification carries the scale of forces; NaN elsewhere.
fn scaled_wheel_forces(found: &Identification, motion: &Motion) -> Vec<Vec<f64>> {
    let v = &found.vehicle;
    let all = v.parameters();
    let mut out = vec![vec![f64::NAN; motion.n_samples()]; v.wheels.len()];
    for bodies in v.components() {
        let part = v.part(&bodies);
        let index: Vec<usize> = part
            .parameters()
            .iter()
            .filter_map(|p| all.iter().position(|q| q.name == p.name))
            .collect();
        let values: Vec<f64> = index.iter().map(|&i| found.values[i]).collect();
        let wheels: Vec<usize> = (0..v.wheels.len())
            .filter(|&w| bodies.contains(&v.wheels[w].at.body))
            .collect();
        let blend: Blend = wheels.iter().map(|&w| found.blend[w].clone()).collect();
        if index.iter().any(|&i| !found.scaled[i]) {
            continue;
        }
        for (force, &w) in wheel_forces(&part, &values, &motion.part(v, &bodies), &blend)
            .into_iter()
            .zip(&wheels)
        {
            out[w] = force;
        }
    }
    out
}

/// Returns the mean load of each wheel that carries a part of the vehicle alone: (sprung + unsprung mass) g, from identified masses. The type equals
/// the type of loads recovered from strain, so that both can be compared. A part linked to the ground, or with a mass that changes during the record,
/// has no mean load.
pub fn static_loads(found: &Identification, gravity: f64, run: &str) -> LoadEstimate {
    let v = &found.vehicle;
    let mut loads: Vec<(String, f64, Vec<usize>)> = Vec::new();
    let parts = v.components().into_iter();
    for bodies in parts.filter(|b| v.rests_on_wheels(b)) {
        let wheels: Vec<&str> = v
            .wheels
            .iter()
            .filter(|w| bodies.contains(&w.at.body))
            .map(|w| w.channel.as_str())
            .collect();
        let masses = v.masses(&bodies);
        let is_determined = masses
            .iter()
            .all(|&i| found.scaled[i] && found.values[i].is_finite());
        if let ([wheel], true) = (wheels.as_slice(), is_determined) {
            let value = masses.iter().map(|&i| found.values[i]).sum::<f64>() * gravity;
            loads.push(((*wheel).to_owned(), value, masses));
        }
    }
    let mut covariance = Vec::new();
    for a in &loads {
        for b in &loads {
            let sum: f64 =
                a.2.iter()
                    .map(|&i| b.2.iter().map(|&j| found.covariance[i][j]).sum::<f64>())
                    .sum();
            covariance.push(sum * gravity * gravity);
        }
    }
    LoadEstimate {
        run: run.to_owned(),
        names: loads.iter().map(|l| l.0.clone()).collect(),
        values: loads.iter().map(|l| l.1).collect(),
        covariance,
        coverage_factor: found.coverage_factor,
        findings: found.findings.clone(),
    }
}
