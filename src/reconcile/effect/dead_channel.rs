//! `dead_channel`: a channel that reads nothing but noise.

use super::{Extension, Stage, StrainEffect, gauge_name};
use crate::reconcile::strain::{Part, StrainFrame};

/// Reading = 0.
#[derive(Clone, Debug)]
pub struct DeadChannel {
    /// Gauge.
    pub gauge: usize,
    /// Its name.
    pub name: String,
}

impl DeadChannel {
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

impl StrainEffect for DeadChannel {
    fn id(&self) -> &'static str {
        "dead_channel"
    }
    fn place(&self) -> Option<String> {
        Some(self.name.clone())
    }
    fn stage(&self) -> Stage {
        Stage::Reading
    }
    fn read(
        &self,
        _frame: &StrainFrame,
        _parameters: &[f64],
        _run: usize,
        row: &mut [f64],
        _part: Part,
    ) {
        if let Some(cell) = row.get_mut(self.gauge) {
            *cell = 0.0;
        }
    }
    fn extension(&self, _frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        Extension::Channel {
            id: self.id(),
            gauge: self.name.clone(),
            size: 0.0,
            unit: "1",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!(
            "check the leads and the insulation of gauge {}; a shunt moves a live channel",
            self.name
        )
    }
    fn gauges(&self) -> Vec<usize> {
        vec![self.gauge]
    }
}
