//! Installation tolerances of gauges as errors of the influence.

use super::frame::{Scatter, StrainFrame, Wiring};

/// Returns the change of the influence for an angle error of `degrees` (one standard deviation, each gauge separately), to first order.
///
/// With t the nominal angle of a quarter bridge, `d(reading)/dt = gxy (cos^2 t - sin^2 t) - 2 (exx - eyy) sin t cos t`. A bending bridge does not
/// have the shear term. Gauges with unknown in-plane strain, and shear bridges (their reading is largest at their angle), have no change.
pub fn angle_scatter(frame: &StrainFrame, degrees: f64) -> Scatter {
    let n_c = frame.n_columns();
    let mut out = vec![0.0; frame.n_gauges() * n_c];
    for ((row, tensors), facts) in out
        .chunks_exact_mut(n_c)
        .zip(&frame.tensors)
        .zip(&frame.gauges)
    {
        let (s, c) = facts.angle_deg.to_radians().sin_cos();
        let shear = match facts.wiring {
            Wiring::Quarter => 1.0,
            Wiring::Bending => 0.0,
            Wiring::Shear => continue,
        };
        for (cell, [exx, eyy, gxy]) in row.iter_mut().zip(tensors) {
            let slope = shear * gxy * (c * c - s * s) - 2.0 * (exx - eyy) * s * c;
            *cell = degrees.to_radians() * slope;
        }
    }
    Scatter::Together(out)
}
