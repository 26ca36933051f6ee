//! Pseudo-damage of the stress at a place over a history of loads.

use super::envelope::LoadState;
use super::rows::ResponseRow;
use crate::estimate::NORMAL_95;
use crate::series::rainflow::{Cycle, MeanStress, Point, Rainflow};
use rayon::prelude::*;

/// Number of planes, evenly over half a turn. The stress on the nearest plane is at least `cos^2 2.5 deg` = .998 of a uniaxial stress.
const PLANES: usize = 36;

/// Pseudo-damage of a place, unit of the stress to the power of the slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaceDamage {
    /// Damage on the plane where it is largest.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of this interval.
    pub high: f64,
    /// Direction normal to the plane, from the x axis of the stress, degree.
    pub angle_deg: f64,
}

/// Damage law of stress: the power of the range, and the correction for mean stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StressLaw {
    /// Power m of the range.
    pub slope: f64,
    /// Correction for the mean of a cycle, in the report unit of stress.
    pub mean_stress: MeanStress,
    /// Report units of stress in one unit of the rows.
    pub unit: f64,
    /// Stress range that the detail endures for two million cycles, in the report unit of stress.
    pub class: Option<f64>,
}

/// Cycles at the stress range of a fatigue class (A. Hobbacher, Recommendations for Fatigue Design of Welded Joints, IIW).
const CLASS_CYCLES: f64 = 2e6;

impl StressLaw {
    /// Returns the share of the life that a pseudo-damage uses: `damage / (2e6 class^m)`, the sum of n / N over the cycles. `None` without a class.
    pub fn life_share(&self, damage: f64) -> Option<f64> {
        let class = self.class?;
        Some(damage / (CLASS_CYCLES * class.powf(self.slope)))
    }
}

/// Returns, by row, the pseudo-damage of the normal stress on the plane where it is largest.
///
/// The damage is `sum of n R^m` over rainflow cycles of the stress `s(a) = sxx cos^2 a + syy sin^2 a + 2 sxy sin a cos a`, times `unit`. With a
/// correction for mean stress, R is the range of the fully reversed cycle that does the same damage. The interval changes every range by its own 95 %
/// interval, from the added standard deviations of both ends, and every mean by half of this.
pub fn fatigue(rows: &[&ResponseRow], states: &[LoadState], law: StressLaw) -> Vec<PlaceDamage> {
    let on_plane = |row: &ResponseRow, plane: usize| {
        let angle_deg = plane as f64 * 180.0 / PLANES as f64;
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let per_load = row.stress.iter();
        let g: Vec<f64> = per_load
            .map(|[x, y, s]| (x * cos * cos + y * sin * sin + 2.0 * s * sin * cos) * law.unit)
            .collect();
        let [low, value, high] = damage_along(&g, states, law);
        PlaceDamage {
            value,
            low,
            high,
            angle_deg,
        }
    };
    let worst = |row: &&ResponseRow| {
        let first = on_plane(row, 0);
        (1..PLANES).fold(first, |worst, plane| {
            let found = on_plane(row, plane);
            if found.value > worst.value {
                found
            } else {
                worst
            }
        })
    };
    rows.par_iter().map(worst).collect()
}

/// Returns low end, value and high end of the damage of `g . loads` over the states. The errors of both ends of a cycle add up, as errors of S do in
/// a reversed cycle.
fn damage_along(g: &[f64], states: &[LoadState], law: StressLaw) -> [f64; 3] {
    let mut damage = [0.0; 3];
    let sigma = |p: Point| {
        states
            .get(p.at)
            .map_or(0.0, |s| s.spread.sd_of_combination(g))
    };
    let mut add = |cycle: Cycle| {
        let half = NORMAL_95 * (sigma(cycle.from) + sigma(cycle.to));
        for (sum, sign) in damage.iter_mut().zip([-1.0, 0.0, 1.0]) {
            let range = (cycle.range() + sign * half).max(0.0);
            let mean = cycle.mean() + 0.5 * sign * half;
            let reversed = law.mean_stress.reversed_range(range, mean);
            *sum += cycle.count * reversed.powf(law.slope);
        }
    };
    let mut count = Rainflow::default();
    for (at, state) in states.iter().enumerate() {
        let value = g.iter().zip(&state.values).map(|(g, f)| g * f).sum();
        count.push(Point { at, value }, &mut add);
    }
    count.finish(&mut add);
    damage
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fe::strain_tensor::Surface;
    use crate::model::ShellIx;
    use crate::respond::{Place, Spread};

    /// Ten cycles of a load between -3 and 3, stress 2 along one direction: `10 (2 * 6)^m`. A standard deviation of .1 of the load at both ends
    /// changes the range by `1.96 * 2 * (.1 + .1)`.
    #[test]
    fn damage_is_that_of_the_plane_across_the_stress() {
        let states: Vec<LoadState> = (0..21)
            .map(|i| LoadState {
                label: String::new(),
                values: vec![if i % 2 == 0 { 3.0 } else { -3.0 }],
                spread: Spread::Sigma(vec![0.1]),
            })
            .collect();
        for angle in [0.0_f64, 30.0, 135.0] {
            let (s, c) = angle.to_radians().sin_cos();
            let row = ResponseRow {
                place: Place::Shell {
                    shell: ShellIx(0),
                    surface: Surface::Top,
                },
                element: 1,
                stress: vec![[2.0 * c * c, 2.0 * s * s, 2.0 * s * c]],
                strain: vec![[0.0; 3]],
            };
            let law = StressLaw {
                slope: 4.0,
                mean_stress: MeanStress::None,
                unit: 1.0,
                class: Some(12.0),
            };
            let [found] = fatigue(&[&row], &states, law)[..] else {
                panic!("one row");
            };
            let damage = |range: f64| 10.0 * range.powi(4);
            let half = 1.959_963_984_540_054 * 0.2 * 2.0;
            let expected = [12.0, 12.0 - half, 12.0 + half].map(damage);
            for (v, e) in [found.value, found.low, found.high].iter().zip(expected) {
                assert!(
                    (v / e - 1.0).abs() < 1e-9,
                    "{angle}: {found:?} {expected:?}"
                );
            }
            assert_eq!(found.angle_deg, angle);
            // The range is that of the class: ten of two million cycles.
            let share = law.life_share(found.value).unwrap();
            assert!((share / 5e-6 - 1.0).abs() < 1e-9, "{share}");
        }
    }

    /// Ten cycles of stress between 0 and 12 MPa, mean 6. With M = 0.3 the reversed range is `2 (6 + 1.8)`. With Goodman and an ultimate strength
    /// of 24 it is `12 / (1 - 6 / 24)`, and by Smith, Watson and Topper `2 sqrt(12 * 6)`. A compressive mean of -6 gives 2 (6 - 1.8), 12 and 0.
    #[test]
    fn mean_stress_is_corrected_as_by_hand() {
        for (sign, by_rule) in [
            (1.0, [15.6, 16.0, 2.0 * 72f64.sqrt()]),
            (-1.0, [8.4, 12.0, 0.0]),
        ] {
            let states: Vec<LoadState> = (0..21)
                .map(|i| LoadState {
                    label: String::new(),
                    values: vec![if i % 2 == 0 { 0.0 } else { sign * 6.0 }],
                    spread: Spread::Sigma(vec![0.0]),
                })
                .collect();
            let row = ResponseRow {
                place: Place::Shell {
                    shell: ShellIx(0),
                    surface: Surface::Top,
                },
                element: 1,
                stress: vec![[2e6, 0.0, 0.0]],
                strain: vec![[0.0; 3]],
            };
            let rules = [
                MeanStress::Sensitivity { m: 0.3 },
                MeanStress::Goodman { ultimate: 24.0 },
                MeanStress::SmithWatsonTopper,
            ];
            for (mean_stress, range) in rules.into_iter().zip(by_rule) {
                let law = StressLaw {
                    slope: 5.0,
                    mean_stress,
                    unit: 1e-6,
                    class: None,
                };
                let found = fatigue(&[&row], &states, law)[0];
                let expected = 10.0 * f64::powi(range, 5);
                assert!(
                    (found.value - expected).abs() <= 1e-9 * expected,
                    "{mean_stress:?} {found:?}"
                );
                assert!((found.low, found.high) == (found.value, found.value));
            }
        }
    }
}
