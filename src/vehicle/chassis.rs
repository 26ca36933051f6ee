//! Forces on the chassis: by its inertia, by its springs, at the seats of leaf springs.

use super::identification::Identification;
use super::layout::Vehicle;
use super::loads::link_forces;
use super::motion::Motion;
use super::preset::COUPLINGS;
use crate::series::detrend::rms;

/// Force on one sprung body in the band, about its mean, upwards; samples as the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct ChassisForce {
    /// The body.
    pub body: String,
    /// Its inertia times its acceleration, M q'' in heave (thesis 5.8, 5.11).
    pub by_mass: Vec<f64>,
    /// Minus the sum of its link forces (thesis 5.9, 5.12).
    pub by_springs: Vec<f64>,
    /// The share of each spring by its link.
    pub springs: Vec<(String, Vec<f64>)>,
}

impl ChassisForce {
    /// RMS of the difference between the two ways: what either may be wrong by.
    pub fn difference(&self) -> f64 {
        let pairs = self.by_mass.iter().zip(&self.by_springs);
        rms(&pairs.map(|(a, b)| a - b).collect::<Vec<f64>>())
    }
}

/// Forces on every sprung body whose inertia and links were identified with the scale of forces.
pub fn chassis_forces(found: &Identification, motion: &Motion) -> Vec<ChassisForce> {
    let v = &found.vehicle;
    let links = link_forces(v, &found.values, motion);
    let told = |i: usize| found.scaled[i] && found.values[i].is_finite();
    let bodies = (0..v.bodies.len()).filter(|&b| v.bodies[b].sprung && !v.is_witness(b));
    bodies
        .filter_map(|b| {
            let inertias: Vec<usize> = (0..v.bodies[b].shape.n())
                .map(|i| v.inertia_index(b, i, 0))
                .collect();
            let own: Vec<(usize, f64)> = (0..v.links.len())
                .map(|l| (l, weight(v, l, b)))
                .filter(|(_, w)| *w != 0.0)
                .collect();
            let terms = own.iter().flat_map(|(l, _)| {
                let n = v.links[*l].terms.len();
                (0..n).map(move |t| v.term_index(*l, t))
            });
            if own.is_empty() || !inertias.iter().copied().chain(terms).all(told) {
                return None;
            }
            let mut out = ChassisForce {
                body: v.bodies[b].name.clone(),
                by_mass: vec![0.0; motion.n_samples()],
                by_springs: vec![0.0; motion.n_samples()],
                springs: vec![],
            };
            for (q, i) in motion.bodies[b].iter().zip(inertias) {
                let m = found.values[i];
                out.by_mass.iter_mut().zip(q).for_each(|(f, a)| *f += m * a);
            }
            for (l, w) in own {
                let force: Vec<f64> = links[l].iter().map(|f| -w * f).collect();
                let sum = out.by_springs.iter_mut().zip(&force);
                sum.for_each(|(s, f)| *s += f);
                if !COUPLINGS.contains(&v.links[l].name.as_str()) {
                    out.springs.push((v.links[l].name.clone(), force));
                }
            }
            Some(out)
        })
        .collect()
}

/// What a link's force does to the heave of a body.
fn weight(v: &Vehicle, link: usize, body: usize) -> f64 {
    let ends = v.links[link].ends.iter();
    ends.filter(|e| e.1.body == body).map(|e| e.0).sum()
}

/// Where a leaf spring stands on the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeafSeat {
    /// From the fixed hanger to the axle, along the spring.
    pub hanger_to_axle: f64,
    /// From the axle to the shackle.
    pub axle_to_shackle: f64,
    /// Angle of the shackle from the vertical, radians, positive when it pulls the spring's end away from the hanger.
    pub shackle_angle_rad: f64,
}

/// Vertical force at hanger and shackle and horizontal force at both, from the vertical force on the chassis: the leaf is a beam
/// on a hinge and a roller whose reaction is along the shackle.
pub fn split_leaf(force: f64, seat: LeafSeat) -> [f64; 3] {
    let length = seat.hanger_to_axle + seat.axle_to_shackle;
    let shackle = force * seat.hanger_to_axle / length;
    [
        force - shackle,
        shackle,
        shackle * seat.shackle_angle_rad.tan(),
    ]
}
