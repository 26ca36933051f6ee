//! Forces on the chassis: by its inertia, by its springs, at the seats of leaf springs.

use super::identification::{Identification, IdentifyTask};
use super::layout::Vehicle;
use super::loads::link_forces;
use super::motion::Motion;
use super::preset::COUPLINGS;
use crate::linalg::tall::left_inverse;
use crate::series::detrend::rms;

/// Force on one sprung body in the band, about its mean, upwards. It has one value for each sample of the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct ChassisForce {
    /// The body.
    pub body: String,
    /// Inertia of the body times its acceleration, M q'' in heave (thesis 5.8, 5.11).
    pub by_mass: Vec<f64>,
    /// Half width of the 95 % interval of `by_mass`: the inertia, noise and gains of the accelerometers.
    pub by_mass_half: Vec<f64>,
    /// Minus the sum of the link forces (thesis 5.9, 5.12). Empty if no link was identified.
    pub by_springs: Vec<f64>,
    /// Force of each spring, by its link.
    pub springs: Vec<SpringForce>,
}

/// Force of one spring and damper on a body, upwards.
#[derive(Clone, Debug, PartialEq)]
pub struct SpringForce {
    /// The link.
    pub link: String,
    /// Samples of the force.
    pub force: Vec<f64>,
    /// Half width of the 95 % interval of `force`. It includes the uncertainty of the parameters and the residual of the body's balance.
    pub half: Vec<f64>,
}

impl ChassisForce {
    /// Returns the RMS of the difference between the two methods, an estimate of the error of either. The result is `None` if only one method is
    /// available.
    pub fn difference(&self) -> Option<f64> {
        let pairs = self.by_mass.iter().zip(&self.by_springs);
        let is_known = !self.by_springs.is_empty();
        is_known.then(|| rms(&pairs.map(|(a, b)| a - b).collect::<Vec<f64>>()))
    }
}

/// Returns the forces on every sprung body whose inertia, and links as far as there are any, were identified with the scale of forces. `motion`
/// is at the rate of the record.
pub fn chassis_forces(
    task: &IdentifyTask,
    found: &Identification,
    motion: &Motion,
) -> Vec<ChassisForce> {
    let v = &found.vehicle;
    let links = link_forces(v, &found.values, motion);
    let is_determined = |i: usize| found.scaled[i] && found.values[i].is_finite();
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
            let has_links = own.is_empty() == v.links.is_empty();
            if !has_links || !inertias.iter().copied().chain(terms).all(is_determined) {
                return None;
            }
            let n = motion.n_samples();
            let mut out = ChassisForce {
                body: v.bodies[b].name.clone(),
                by_mass: vec![0.0; n],
                by_mass_half: half_widths_by_mass(task, found, motion, b),
                by_springs: vec![0.0; if own.is_empty() { 0 } else { n }],
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
                    out.springs.push(SpringForce {
                        link: v.links[l].name.clone(),
                        half: half_widths_of_link(found, motion, l, w),
                        force,
                    });
                }
            }
            let balance = found.coverage_factor * out.difference().unwrap_or(0.0);
            let halves = out.springs.iter_mut().flat_map(|s| &mut s.half);
            halves.for_each(|h| *h = h.hypot(balance));
            Some(out)
        })
        .collect()
}

/// Returns the half width of `sum_j M_0j q_j''` by sample.
///
/// The heave force is `sum_s c_s a_s` over the accelerometers of the body, with `c = M_0 pinv(phi)`. A gain error of an accelerometer counts with
/// `c_s a_s`. White noise counts with `c_s` times its share in the band, `sqrt(2 (high - low) / rate)`.
fn half_widths_by_mass(
    task: &IdentifyTask,
    found: &Identification,
    motion: &Motion,
    body: usize,
) -> Vec<f64> {
    let v = &found.vehicle;
    let own: Vec<usize> = (0..v.sensors.len())
        .filter(|s| v.sensors[*s].at.body == body)
        .collect();
    let inertias: Vec<usize> = (0..v.bodies[body].shape.n())
        .map(|i| v.inertia_index(body, i, 0))
        .collect();
    let functions: Vec<Vec<f64>> = own.iter().map(|s| v.functions(&v.sensors[*s].at)).collect();
    let inverse = left_inverse(&functions).unwrap_or_default();
    let shares: Vec<f64> = (0..own.len())
        .map(|s| {
            let rows = inertias.iter().zip(&inverse);
            rows.map(|(i, row)| found.values[*i] * row[s]).sum()
        })
        .collect();
    let width_hz = task.band.high_hz - task.band.low_hz;
    let in_band = (2.0 * width_hz / motion.rate_hz).min(1.0);
    let squares: f64 = shares.iter().map(|c| c * c).sum();
    let noise = task.noise_acc.unwrap_or(0.0).powi(2) * in_band * squares;
    let variance = |t: usize| {
        let of_gains = own.iter().zip(&shares);
        let gains =
            of_gains.map(|(s, c)| (c * task.gain_tolerance * motion.sensors[*s][t]).powi(2));
        noise + gains.sum::<f64>() + quadratic_form(found, &inertias, |k| motion.bodies[body][k][t])
    };
    (0..motion.n_samples())
        .map(|t| found.coverage_factor * variance(t).max(0.0).sqrt())
        .collect()
}

fn half_widths_of_link(found: &Identification, motion: &Motion, l: usize, w: f64) -> Vec<f64> {
    let columns = &motion.terms[l];
    let terms: Vec<usize> = (0..columns.len())
        .map(|t| found.vehicle.term_index(l, t))
        .collect();
    (0..motion.n_samples())
        .map(|t| {
            let variance = quadratic_form(found, &terms, |k| w * columns[k][t]);
            found.coverage_factor * variance.max(0.0).sqrt()
        })
        .collect()
}

/// Returns `x' C x` with the covariance of parameters.
fn quadratic_form(found: &Identification, parameters: &[usize], x: impl Fn(usize) -> f64) -> f64 {
    let mut sum = 0.0;
    for (a, i) in parameters.iter().enumerate() {
        for (b, j) in parameters.iter().enumerate() {
            sum += x(a) * x(b) * found.covariance[*i][*j];
        }
    }
    sum
}

/// Returns the weight of a link's force in the heave equation of a body.
fn weight(v: &Vehicle, link: usize, body: usize) -> f64 {
    let ends = v.links[link].ends.iter();
    ends.filter(|e| e.1.body == body).map(|e| e.0).sum()
}

/// Position of a leaf spring on the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeafSeat {
    /// Distance from the fixed hanger to the axle, along the spring.
    pub hanger_to_axle: f64,
    /// Distance from the axle to the shackle.
    pub axle_to_shackle: f64,
    /// Angle of the shackle from the vertical, radians. It is positive if the shackle pulls the end of the spring away from the hanger.
    pub shackle_angle_rad: f64,
}

/// Returns the vertical force at hanger and shackle and the horizontal force at both, from the vertical force on the chassis.
///
/// The leaf is a beam on a hinge and a roller whose reaction is along the shackle.
///
/// # Example
/// ```
/// use strainbridge::vehicle::chassis::{LeafSeat, split_leaf};
///
/// let seat = LeafSeat { hanger_to_axle: 0.6, axle_to_shackle: 0.9, shackle_angle_rad: 0.2 };
/// let [hanger, shackle, horizontal] = split_leaf(10_000.0, seat);
/// // Equilibrium: sum of forces, and moments about the axle.
/// assert!((hanger + shackle - 10_000.0).abs() < 1e-9);
/// assert!((hanger * seat.hanger_to_axle - shackle * seat.axle_to_shackle).abs() < 1e-9);
/// // The reaction at the shackle is along the shackle.
/// assert!((horizontal / shackle - 0.2_f64.tan()).abs() < 1e-12);
/// ```
pub fn split_leaf(force: f64, seat: LeafSeat) -> [f64; 3] {
    let length = seat.hanger_to_axle + seat.axle_to_shackle;
    let shackle = force * seat.hanger_to_axle / length;
    [
        force - shackle,
        shackle,
        shackle * seat.shackle_angle_rad.tan(),
    ]
}
