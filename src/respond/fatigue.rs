//! Pseudo-damage of the stress at a place over a history of loads.

use super::envelope::LoadState;
use super::rows::ResponseRow;
use crate::series::rainflow::{Cycle, Damage, Point, Rainflow};
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

/// Returns, by row, the pseudo-damage of the normal stress on the plane where it is largest.
///
/// The damage is `sum of n R^m` over rainflow cycles of the stress `s(a) = sxx cos^2 a + syy sin^2 a + 2 sxy sin a cos a`, times `unit`. The interval
/// changes every range by its own 95 % interval, from the added standard deviations of both ends.
pub fn fatigue(
    rows: &[&ResponseRow],
    states: &[LoadState],
    (slope, unit): (f64, f64),
) -> Vec<PlaceDamage> {
    let on_plane = |row: &ResponseRow, plane: usize| {
        let angle_deg = plane as f64 * 180.0 / PLANES as f64;
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let per_load = row.stress.iter();
        let g: Vec<f64> = per_load
            .map(|[x, y, s]| (x * cos * cos + y * sin * sin + 2.0 * s * sin * cos) * unit)
            .collect();
        let damage = damage_along(&g, states, slope);
        PlaceDamage {
            value: damage.value,
            low: damage.low,
            high: damage.high,
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

/// Counts the cycles of `g . loads` over the states. The errors of both ends of a cycle add up, as errors of S do in a reversed cycle.
fn damage_along(g: &[f64], states: &[LoadState], slope: f64) -> Damage {
    let mut damage = Damage::new(slope, 0.0);
    let sigma = |p: Point| {
        states
            .get(p.at)
            .map_or(0.0, |s| s.spread.sd_of_combination(g))
    };
    let mut add = |cycle: Cycle| damage.add(&cycle, sigma(cycle.from) + sigma(cycle.to));
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
            let [found] = fatigue(&[&row], &states, (4.0, 1.0))[..] else {
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
        }
    }
}
