//! Mass of beams.

use super::flexibility::section_at;
use super::interior::LineLoad;
use super::of_model::{length, to_element};
use crate::fe::element::{ElementMatrix, point_mass};
use crate::linalg::{Matrix6, SMatrix, SVector, Vector3, Vector4};
use crate::model::{Beam, Model, Section, Vec3};

const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Integrates f(share of the length, section, length element) along a beam.
fn integrate_along_beam(model: &Model, beam: &Beam, mut f: impl FnMut(f64, &Section, f64)) {
    let Some(property) = model.beam_properties.get(beam.property.us()) else {
        return;
    };
    let length = length(model, beam);
    for w in property.sections.windows(2) {
        let span = w[1].0 - w[0].0;
        if span > 0.0 {
            for (x, weight) in GAUSS {
                let xi = w[0].0 + span * x;
                f(
                    xi,
                    &section_at(&property.sections, xi),
                    weight * span * length,
                );
            }
        }
    }
}

fn density(model: &Model, beam: &Beam) -> f64 {
    let property = model.beam_properties.get(beam.property.us());
    property
        .and_then(|p| model.materials.get(p.material.us()))
        .map_or(0.0, |m| m.rho)
}

/// Returns the mass lumped at the two ends, 6 x 6 about each grid, basic frame, before WTMASS.
///
/// A CBAR puts half its mass at each offset end. A CBEAM puts structural mass on its neutral axis and non-structural mass at the centre of that mass.
/// It adds the polar inertia of the section and NSI about the beam's axis.
pub(crate) fn beam_lumped_mass(model: &Model, i: usize) -> [Matrix6<f64>; 2] {
    let beam = &model.beams[i];
    let rho = density(model, beam);
    let mut ends = [Matrix6::zeros(); 2];
    integrate_along_beam(model, beam, |xi, s, dx| {
        for (end, share) in [(0, 1.0 - xi), (1, xi)] {
            let at = |[y, z]: [f64; 2]| {
                beam.offsets[end] + beam.axes.transpose() * Vector3::new(0.0, y, z)
            };
            if beam.is_beam {
                ends[end] += point_mass(rho * s.area * share * dx, &at(s.neutral));
                ends[end] += point_mass(s.nsm * share * dx, &at(s.nsm_centre));
                let polar = (rho * (s.i1 + s.i2) + s.nsi) * share * dx;
                let x = beam.axes.row(0).transpose();
                let spin = x * x.transpose() * polar;
                let mut block = ends[end].fixed_view_mut::<3, 3>(3, 3);
                block += spin;
            } else {
                ends[end] += point_mass((rho * s.area + s.nsm) * share * dx, &beam.offsets[end]);
            }
        }
    });
    ends
}

/// Returns the coupled mass (PARAM,COUPMASS) with the cubic shape functions of a slender beam, basic frame, before WTMASS.
pub(crate) fn beam_coupled_mass(model: &Model, i: usize) -> ElementMatrix {
    let beam = &model.beams[i];
    let t = to_element(beam);
    let m = t.transpose() * local_mass(model, beam) * t;
    ElementMatrix {
        grids: beam.grids.to_vec(),
        values: m.transpose().as_slice().to_vec(),
    }
}

/// Shape functions of u, v, w at a share `x` of the length `l`: linear along the axis, cubic across it.
fn shapes(x: f64, l: f64) -> SMatrix<f64, 3, 12> {
    let (x2, x3) = (x * x, x * x * x);
    let (h1, h2, h3, h4) = (
        1.0 - 3.0 * x2 + 2.0 * x3,
        l * (x - 2.0 * x2 + x3),
        3.0 * x2 - 2.0 * x3,
        l * (x3 - x2),
    );
    let mut n = SMatrix::<f64, 3, 12>::zeros();
    (n[(0, 0)], n[(0, 6)]) = (1.0 - x, x);
    (n[(1, 1)], n[(1, 5)], n[(1, 7)], n[(1, 11)]) = (h1, h2, h3, h4);
    (n[(2, 2)], n[(2, 4)], n[(2, 8)], n[(2, 10)]) = (h1, -h2, h3, -h4);
    n
}

/// Mass per length, and polar inertia per length, of a section.
fn per_length(rho: f64, s: &Section) -> (f64, f64) {
    (rho * s.area + s.nsm, rho * (s.i1 + s.i2) + s.nsi)
}

/// Coupled mass in the element frame, before WTMASS.
fn local_mass(model: &Model, beam: &Beam) -> SMatrix<f64, 12, 12> {
    let (rho, l) = (density(model, beam), length(model, beam));
    let mut m = SMatrix::<f64, 12, 12>::zeros();
    // The integrand has degree six. The three-point rule on halves is accurate enough for uniform beams and exact for rigid motions.
    integrate_along_beam(model, beam, |xi, s, dx| {
        let (mass, polar) = per_length(rho, s);
        let n = shapes(xi, l);
        m += n.transpose() * n * (mass * dx);
        for (a, p) in [(3, 1.0 - xi), (9, xi)] {
            for (b, q) in [(3, 1.0 - xi), (9, xi)] {
                m[(a, b)] += polar * dx * p * q;
            }
        }
    });
    m
}

/// Returns the forces of the coupled mass of beam `i` in a field of acceleration (basic, by grid), before WTMASS. The forces point along the
/// acceleration. They are the forces along the beam, and the twelve equivalent forces at its ends, both in the element frame.
///
/// The forces along the beam are linear in each of four parts of a section interval. They have the resultant and the moment of the exact forces.
pub(crate) fn beam_inertia(
    model: &Model,
    i: usize,
    acceleration: &[[f64; 6]],
) -> (Vec<LineLoad>, [f64; 12]) {
    /// Parts of an interval between two sections.
    const PARTS: u32 = 4;
    let beam = &model.beams[i];
    let Some(property) = model.beam_properties.get(beam.property.us()) else {
        return (Vec::new(), [0.0; 12]);
    };
    let (rho, l) = (density(model, beam), length(model, beam));
    let grids: Vec<f64> = beam
        .grids
        .iter()
        .flat_map(|g| acceleration[g.us()])
        .collect();
    let a = to_element(beam) * SVector::<f64, 12>::from_column_slice(&grids);
    let at = |xi: f64| {
        let (mass, polar) = per_length(rho, &section_at(&property.sections, xi));
        let twist = a[3] + (a[9] - a[3]) * xi;
        (shapes(xi, l) * a * mass, polar * twist)
    };
    let mut loads = Vec::new();
    for w in property.sections.windows(2) {
        let part = (w[1].0 - w[0].0) / f64::from(PARTS);
        for k in (0..PARTS).map(f64::from).filter(|_| part > 0.0) {
            let span = [w[0].0 + part * k, w[0].0 + part * (k + 1.0)];
            // Means of the force and of its first moment about the middle, by the three-point rule, which is exact to degree five.
            let (mut mean, mut slope) = (Vector4::zeros(), Vector4::zeros());
            for (s, weight) in GAUSS {
                let (force, torque) = at(span[0] + part * s);
                let all = Vector4::new(force[0], force[1], force[2], torque);
                mean += all * weight;
                slope += all * (weight * 12.0 * (s - 0.5));
            }
            let ends = [mean - slope * 0.5, mean + slope * 0.5];
            loads.push(LineLoad {
                span,
                force: ends.map(|e| Vec3::new(e[0], e[1], e[2])),
                moment: ends.map(|e| Vec3::new(e[3], 0.0, 0.0)),
            });
        }
    }
    (loads, (local_mass(model, beam) * a).into())
}
