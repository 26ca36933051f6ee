//! `saturated_channel`: a channel that stops at the end of its range.

use super::channel_fault::{ChannelFault, FaultScope, OnGauges};
use super::{Correction, Extension, Parameter};
use crate::reconcile::strain::{Part, StrainFrame, predict};

/// Reading = strain, held between -limit and +limit.
#[derive(Clone, Debug)]
pub struct SaturatedChannel {
    /// Largest reading of the channel. It is the limit of the range if the channel is saturated.
    pub largest: f64,
}

impl SaturatedChannel {
    /// Returns one effect for every gauge with two or more readings at its largest magnitude for which the model predicts more.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        /// Readings held at a limit differ by noise only: five standard deviations.
        const AT_LIMIT_SD: f64 = 5.0;
        let predicted = predict(frame, &[]);
        let mut out = Vec::new();
        for gauge in 0..frame.n_gauges() {
            let near = AT_LIMIT_SD * frame.noise_of(gauge);
            let read: Vec<f64> = (0..frame.n_runs())
                .map(|r| frame.observations.value(r, gauge).abs())
                .filter(|v| v.is_finite())
                .collect();
            let largest = read.iter().copied().fold(0.0, f64::max);
            let at_limit = read.iter().filter(|v| **v > largest - near).count();
            let expected =
                (0..frame.n_runs()).filter_map(|r| predicted.get(r * frame.n_gauges() + gauge));
            let beyond = expected.filter(|p| p.abs() > largest + near).count();
            if largest > near && at_limit >= 2 && beyond >= 1 {
                out.push(OnGauges::with_gauge(frame, gauge, Self { largest }));
            }
        }
        out
    }
}

impl ChannelFault for SaturatedChannel {
    fn id(&self) -> &'static str {
        "saturated_channel"
    }
    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter {
            unit: "microstrain",
            neutral: self.largest,
            prior_sd: 0.2 * self.largest,
            step: 0.01 * self.largest,
            starts: vec![self.largest],
            plausible: f64::INFINITY,
        }]
    }
    fn read(&self, at: FaultScope<'_>, parameters: &[f64], row: &mut [f64]) {
        let (Part::Whole, [limit, ..]) = (at.part, parameters) else {
            return;
        };
        for &g in at.gauges {
            if let Some(cell) = row.get_mut(g) {
                *cell = cell.clamp(-limit.abs(), limit.abs());
            }
        }
    }
    fn extension(&self, names: &[String], _parameters: &[f64]) -> Extension {
        Extension::channel(names, Correction::Ignore)
    }
    fn separate_by(&self, place: &str) -> String {
        format!("lower the amplifier gain of gauge {place} and repeat the heaviest run")
    }
}
