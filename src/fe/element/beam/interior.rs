//! Loads between the ends of a beam: loads along it (PLOAD1) and temperature.

use super::flexibility::{LocalBeam, section_at};
use crate::linalg::{SMatrix, SVector, Vector3, Vector6};
use crate::model::Vec3;

/// Three-point Gauss rule on 0..1.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Force or moment along a beam, element axes. It is concentrated if `from` equals `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LineLoad {
    /// Begin and end of the load, as shares of the length.
    pub(crate) span: [f64; 2],
    /// Force and moment per length at both ends of the span. For a concentrated load the first entry is the force.
    pub(crate) force: [Vec3; 2],
    pub(crate) moment: [Vec3; 2],
}

/// Free thermal strain of a beam at both ends: along the axis, and per height along y and z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LineStrain {
    pub(crate) axial: [f64; 2],
    pub(crate) per_y: [f64; 2],
    pub(crate) per_z: [f64; 2],
}

/// Loads between the ends of a beam.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Interior {
    pub(crate) loads: Vec<LineLoad>,
    pub(crate) thermal: Option<LineStrain>,
    /// End forces equivalent to the inertia of the coupled mass, element frame. The inertia forces along the beam are not in `loads`.
    pub(crate) inertia: Option<[f64; 12]>,
}

impl LineStrain {
    fn strain_at(&self, xi: f64) -> Vector3<f64> {
        let mix = |v: [f64; 2]| v[0] + (v[1] - v[0]) * xi;
        // Strain at (y, z) is e0 + z ky - y kz.
        Vector3::new(mix(self.axial), mix(self.per_z), -mix(self.per_y))
    }
}

/// Returns the section forces N, Vy, Vz, T, My, Mz at `xi` from the loads beyond it.
pub(super) fn sum_loads_beyond(loads: &[LineLoad], xi: f64, length: f64) -> Vector6<f64> {
    let mut sum = Vector6::zeros();
    let mut add = |x: f64, f: Vec3, m: Vec3| {
        let arm = length * (x - xi);
        sum += Vector6::new(f.x, f.y, f.z, m.x, m.y - arm * f.z, m.z + arm * f.y);
    };
    for load in loads {
        let [a, b] = load.span;
        if a == b {
            if a >= xi {
                add(a, load.force[0], load.moment[0]);
            }
            continue;
        }
        let low = a.max(xi);
        if low >= b {
            continue;
        }
        for (s, w) in GAUSS {
            let x = low + s * (b - low);
            let share = (x - a) / (b - a);
            let mix = |v: [Vec3; 2]| (v[0] + (v[1] - v[0]) * share) * (w * (b - low) * length);
            add(x, mix(load.force), mix(load.moment));
        }
    }
    sum
}

impl Interior {
    pub(crate) fn is_empty(&self) -> bool {
        self.loads.is_empty() && self.thermal.is_none()
    }

    /// Returns the places at which a section or a load begins or ends. Section forces are smooth between these places.
    fn breaks(&self, beam: &LocalBeam<'_>) -> Vec<f64> {
        let mut all: Vec<f64> = beam.sections.iter().map(|s| s.0).collect();
        all.extend(self.loads.iter().flat_map(|l| l.span));
        all.retain(|x| (0.0..=1.0).contains(x));
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// Displacement of end B with end A held: u v w and rotations.
    fn displacement(&self, beam: &LocalBeam<'_>) -> Vector6<f64> {
        let l = beam.length;
        let mut d = Vector6::zeros();
        for w in self.breaks(beam).windows(2) {
            let span = w[1] - w[0];
            for (x, weight) in GAUSS {
                let xi = w[0] + span * x;
                let s = section_at(beam.sections, xi);
                let arm = l * (1.0 - xi);
                let dx = weight * span * l;
                let b = SMatrix::<f64, 3, 6>::from_row_slice(&[
                    1.0, 0.0, 0.0, 0.0, 0.0, 0.0, //
                    0.0, 0.0, -arm, 0.0, 1.0, 0.0, //
                    0.0, arm, 0.0, 0.0, 0.0, 1.0,
                ]);
                let q = sum_loads_beyond(&self.loads, xi, l);
                let mut strain = beam.compliance(&s) * Vector3::new(q[0], q[4], q[5]);
                if let Some(t) = &self.thermal {
                    strain += t.strain_at(xi);
                }
                d += b.transpose() * strain * dx;
                for (i, k) in beam.k.iter().enumerate() {
                    if *k > 0.0 && s.area > 0.0 {
                        d[1 + i] += q[1 + i] * dx / (k * beam.g * s.area);
                    }
                }
                if s.j > 0.0 {
                    d[3] += q[3] * dx / (beam.g * s.j);
                }
            }
        }
        d
    }

    /// Returns the end forces, A then B, equivalent to the loads between the ends: the end forces of the clamped beam with reversed sign.
    pub(super) fn end_forces(&self, beam: &LocalBeam<'_>) -> Option<SVector<f64, 12>> {
        let (kb, g) = beam.basic()?;
        let held = kb * self.displacement(beam);
        let at_a = sum_loads_beyond(&self.loads, 0.0, beam.length) - g * held;
        let mut f = SVector::<f64, 12>::zeros();
        f.fixed_rows_mut::<6>(0).copy_from(&at_a);
        f.fixed_rows_mut::<6>(6).copy_from(&held);
        Some(f)
    }
}
