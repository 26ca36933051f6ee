//! Area and volume of a shell by pairs of corners: what its mass takes, without forming the element.

use super::quad4::quad_points;
use super::tria3::tria_points;
use crate::model::Vec3;

/// Integrals of products of shape functions, with weight one and with the thickness as weight. For a triangle, the fourth row and column are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct CornerProducts {
    pub(crate) area: [[f64; 4]; 4],
    pub(crate) volume: [[f64; 4]; 4],
}

/// Returns the integrals over the mid-surface through three or four corners.
pub(crate) fn corner_products(x: &[Vec3], thickness: &[f64; 4]) -> CornerProducts {
    let mut out = CornerProducts::default();
    let mut add = |h: [f64; 4], hr: [f64; 4], hs: [f64; 4], weight: f64| {
        let along = |d: &[f64; 4]| {
            x.iter()
                .zip(d)
                .fold(Vec3::zeros(), |sum, (x, d)| sum + x * *d)
        };
        let area = weight * along(&hr).cross(&along(&hs)).norm();
        let t: f64 = h.iter().zip(thickness).map(|(h, t)| h * t).sum();
        for k in 0..4 {
            for l in 0..4 {
                out.area[k][l] += h[k] * h[l] * area;
                out.volume[k][l] += h[k] * h[l] * area * t;
            }
        }
    };
    if x.len() == 4 {
        for s in quad_points() {
            add(s.h, s.hr, s.hs, 1.0);
        }
    } else {
        for (s, weight) in tria_points() {
            let four = |v: [f64; 3]| [v[0], v[1], v[2], 0.0];
            add(four(s.h), four(s.hr), four(s.hs), weight);
        }
    }
    out
}
