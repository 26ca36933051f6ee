//! `gauge_gain`: a wrong gauge factor, amplifier gain or bridge factor.

use super::{Extension, Parameter, Stage, StrainEffect, gauge_name};
use crate::reconcile::strain::{Part, StrainFrame};

/// Reading = gain times strain.
#[derive(Clone, Debug)]
pub struct GaugeGain {
    /// Gauge.
    pub gauge: usize,
    /// Its name.
    pub name: String,
}

impl GaugeGain {
    /// One on every gauge.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        (0..frame.n_gauges())
            .map(|gauge| Self {
                gauge,
                name: gauge_name(frame, gauge),
            })
            .collect()
    }
}

impl StrainEffect for GaugeGain {
    fn id(&self) -> &'static str {
        "gauge_gain"
    }
    fn place(&self) -> Option<String> {
        Some(self.name.clone())
    }
    fn stage(&self) -> Stage {
        Stage::Reading
    }
    fn parameters(&self) -> Vec<Parameter> {
        // Bridge factors of 1/4 to 4 are common mistakes; a few tenths, a wrong gauge factor.
        vec![Parameter {
            unit: "1",
            neutral: 1.0,
            prior_sd: 0.5,
            step: 0.01,
            starts: vec![1.0],
            plausible: 4.0,
        }]
    }
    fn read(
        &self,
        _frame: &StrainFrame,
        parameters: &[f64],
        _run: usize,
        row: &mut [f64],
        _part: Part,
    ) {
        if let (Some(cell), [gain, ..]) = (row.get_mut(self.gauge), parameters) {
            *cell *= gain;
        }
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        let size = parameters.first().copied().unwrap_or(1.0);
        Extension::Channel {
            id: self.id(),
            gauge: self.name.clone(),
            size,
            unit: "1",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!(
            "shunt-calibrate gauge {}: a wrong gain shows, a wrong angle or place does not",
            self.name
        )
    }
    fn gauges(&self) -> Vec<usize> {
        vec![self.gauge]
    }
}
