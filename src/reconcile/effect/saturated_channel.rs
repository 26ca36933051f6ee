//! `saturated_channel`: a channel that stops at the end of its range.

use super::{Extension, Parameter, Stage, StrainEffect, gauge_name};
use crate::reconcile::strain::{Part, StrainFrame, predict};

/// Reading = strain, held between -limit and +limit.
#[derive(Clone, Debug)]
pub struct SaturatedChannel {
    /// Gauge.
    pub gauge: usize,
    /// Its name.
    pub name: String,
    /// Largest reading of the channel: the limit is there or it did not act.
    pub largest: f64,
}

impl SaturatedChannel {
    /// One on every gauge with two or more readings at its largest size, where the model predicts more.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        let predicted = predict(frame, &[]);
        let mut out = Vec::new();
        for gauge in 0..frame.n_gauges() {
            let read: Vec<f64> = (0..frame.n_runs())
                .map(|r| frame.observations.value(r, gauge).abs())
                .filter(|v| v.is_finite())
                .collect();
            let largest = read.iter().copied().fold(0.0, f64::max);
            // Readings held at a limit differ by noise only.
            let at_limit = read
                .iter()
                .filter(|v| **v > largest - 5.0 * frame.noise)
                .count();
            let expected =
                (0..frame.n_runs()).filter_map(|r| predicted.get(r * frame.n_gauges() + gauge));
            let beyond = expected
                .filter(|p| p.abs() > largest + 5.0 * frame.noise)
                .count();
            if largest > 4.0 * frame.noise && at_limit >= 2 && beyond >= 1 {
                out.push(Self {
                    gauge,
                    name: gauge_name(frame, gauge),
                    largest,
                });
            }
        }
        out
    }
}

impl StrainEffect for SaturatedChannel {
    fn id(&self) -> &'static str {
        "saturated_channel"
    }
    fn place(&self) -> Option<String> {
        Some(self.name.clone())
    }
    fn stage(&self) -> Stage {
        Stage::Reading
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
    fn read(
        &self,
        _frame: &StrainFrame,
        parameters: &[f64],
        _run: usize,
        row: &mut [f64],
        part: Part,
    ) {
        let (Part::Whole, [limit, ..]) = (part, parameters) else {
            return;
        };
        if let Some(cell) = row.get_mut(self.gauge) {
            *cell = cell.clamp(-limit.abs(), limit.abs());
        }
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        let size = parameters.first().copied().unwrap_or(0.0);
        Extension::Channel {
            id: self.id(),
            gauge: self.name.clone(),
            size,
            unit: "microstrain",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!(
            "lower the amplifier's gain of gauge {} and repeat the heaviest run",
            self.name
        )
    }
    fn gauges(&self) -> Vec<usize> {
        vec![self.gauge]
    }
}
