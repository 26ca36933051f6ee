//! `gauge_position`: a gauge installed some way off its nominal position, along its axis.

use super::channel_fault::{ChannelFault, OnGauges};
use super::{Correction, Extension, Parameter, Stage};
use crate::reconcile::strain::StrainFrame;

/// Influence = influence + size times its gradient along the gauge axis.
#[derive(Clone, Debug)]
pub struct GaugePosition;

impl GaugePosition {
    /// Returns one effect for every gauge whose gradient is known.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        let known = |g: &usize| gradient(frame, *g).iter().any(|v| *v != 0.0);
        (0..frame.n_gauges())
            .filter(known)
            .map(|g| OnGauges::with_gauge(frame, g, Self))
            .collect()
    }
}

fn gradient(frame: &StrainFrame, gauge: usize) -> &[f64] {
    let n_c = frame.n_columns();
    let row = frame
        .per_mm
        .as_ref()
        .and_then(|m| m.get(gauge * n_c..(gauge + 1) * n_c));
    row.unwrap_or(&[])
}

impl ChannelFault for GaugePosition {
    fn id(&self) -> &'static str {
        "gauge_position"
    }
    fn stage(&self) -> Stage {
        Stage::Structure
    }
    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter {
            unit: "mm",
            neutral: 0.0,
            prior_sd: 15.0,
            step: 0.5,
            starts: vec![0.0],
            plausible: 60.0,
        }]
    }
    fn influence_change(&self, frame: &StrainFrame, gauge: usize, parameters: &[f64]) -> Vec<f64> {
        let mm = parameters.first().copied().unwrap_or(0.0);
        gradient(frame, gauge).iter().map(|d| mm * d).collect()
    }
    fn extension(&self, names: &[String], parameters: &[f64]) -> Extension {
        Extension::channel(
            names,
            Correction::PositionMm(parameters.first().copied().unwrap_or(0.0)),
        )
    }
    fn separate_by(&self, place: &str) -> String {
        format!("measure the installed position of gauge {place}")
    }
}
