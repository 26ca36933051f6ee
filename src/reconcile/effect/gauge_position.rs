//! `gauge_position`: a gauge glued some way off along its axis.

use super::{Extension, Parameter, Stage, StrainEffect, gauge_name};
use crate::reconcile::strain::{StrainFrame, StrainState};

/// Influence = influence + size times its gradient along the gauge axis.
#[derive(Clone, Debug)]
pub struct GaugePosition {
    /// Gauge.
    pub gauge: usize,
    /// Its name.
    pub name: String,
}

impl GaugePosition {
    /// One on every gauge whose gradient is known.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        let Some(per_mm) = &frame.per_mm else {
            return Vec::new();
        };
        let n_c = frame.n_columns();
        let known = |g: &usize| {
            per_mm
                .get(g * n_c..(g + 1) * n_c)
                .is_some_and(|r| r.iter().any(|v| *v != 0.0))
        };
        (0..frame.n_gauges())
            .filter(known)
            .map(|gauge| Self {
                gauge,
                name: gauge_name(frame, gauge),
            })
            .collect()
    }
}

impl StrainEffect for GaugePosition {
    fn id(&self) -> &'static str {
        "gauge_position"
    }
    fn place(&self) -> Option<String> {
        Some(self.name.clone())
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
    fn alter(&self, frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let (Some(mm), Some(per_mm)) = (parameters.first(), &frame.per_mm) else {
            return;
        };
        let n_c = state.shape[2];
        let at = self.gauge * n_c..(self.gauge + 1) * n_c;
        if let Some(gradient) = per_mm.get(at.clone()) {
            for (cell, d) in state.influence[at].iter_mut().zip(gradient) {
                *cell += mm * d;
            }
        }
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        let size = parameters.first().copied().unwrap_or(0.0);
        Extension::Channel {
            id: self.id(),
            gauge: self.name.clone(),
            size,
            unit: "mm",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!("measure where gauge {} sits", self.name)
    }
    fn gauges(&self) -> Vec<usize> {
        vec![self.gauge]
    }
}
