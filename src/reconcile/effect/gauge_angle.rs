//! `gauge_angle`: a gauge whose installed angle differs from its nominal angle.

use super::channel_fault::{ChannelFault, OnGauges};
use super::{Correction, Extension, Parameter, Stage};
use crate::reconcile::strain::{StrainFrame, Wiring};

/// Influence = exx cos^2 + eyy sin^2 + gxy sin cos at angle + size; in a bending bridge the shear of both sides cancels.
#[derive(Clone, Debug)]
pub struct GaugeAngle;

impl GaugeAngle {
    /// Returns one effect for every gauge whose in-plane strain is known.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        let known = |g: &usize| frame.tensors.get(*g).is_some_and(|t| !t.is_empty());
        (0..frame.n_gauges())
            .filter(known)
            .map(|g| OnGauges::with_gauge(frame, g, Self))
            .collect()
    }
}

/// Returns the reading of a gauge at `angle_rad` from the x axis of the in-plane strain.
fn gauge_reading([exx, eyy, gxy]: [f64; 3], angle_rad: f64, wiring: Wiring) -> f64 {
    let (s, c) = angle_rad.sin_cos();
    match wiring {
        Wiring::Quarter => exx * c * c + eyy * s * s + gxy * s * c,
        Wiring::Bending => exx * c * c + eyy * s * s,
        Wiring::Shear => gxy * (c * c - s * s) - 2.0 * (exx - eyy) * s * c,
    }
}

/// Returns the change of one gauge's influence, by column, if its angle exceeds the nominal angle by `degrees`.
pub fn angle_change(frame: &StrainFrame, gauge: usize, degrees: f64) -> Vec<f64> {
    let (Some(facts), Some(tensors)) = (frame.gauges.get(gauge), frame.tensors.get(gauge)) else {
        return Vec::new();
    };
    let (drawn, glued) = (
        facts.angle_deg.to_radians(),
        (facts.angle_deg + degrees).to_radians(),
    );
    let change = |&t: &[f64; 3]| {
        gauge_reading(t, glued, facts.wiring) - gauge_reading(t, drawn, facts.wiring)
    };
    tensors.iter().map(change).collect()
}

impl ChannelFault for GaugeAngle {
    fn id(&self) -> &'static str {
        "gauge_angle"
    }
    fn stage(&self) -> Stage {
        Stage::Structure
    }
    fn parameters(&self) -> Vec<Parameter> {
        // The first-order step is zero for a gauge along a principal direction, so the search starts on both sides. A gauge installed across is as
        // usual a mistake as a gauge installed askew, so the prior is wide.
        let starts = vec![-75.0, -30.0, -8.0, 8.0, 30.0, 75.0];
        vec![Parameter {
            unit: "degree",
            neutral: 0.0,
            prior_sd: 30.0,
            step: 0.25,
            starts,
            plausible: 95.0,
        }]
    }
    fn influence_change(&self, frame: &StrainFrame, gauge: usize, parameters: &[f64]) -> Vec<f64> {
        angle_change(frame, gauge, parameters.first().copied().unwrap_or(0.0))
    }
    fn extension(&self, names: &[String], parameters: &[f64]) -> Extension {
        Extension::channel(
            names,
            Correction::AngleDeg(parameters.first().copied().unwrap_or(0.0)),
        )
    }
    fn separate_by(&self, place: &str) -> String {
        format!(
            "photograph gauge {place} with a protractor. A load that shears the member there distinguishes a wrong angle from a wrong gain"
        )
    }
}
