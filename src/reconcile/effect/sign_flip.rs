//! `sign_flip`: a channel with its polarity turned.

use super::{Extension, Stage, StrainEffect, gauge_name};
use crate::reconcile::strain::{Part, StrainFrame};

/// Reading = -strain.
#[derive(Clone, Debug)]
pub struct SignFlip {
    /// Gauge.
    pub gauge: usize,
    /// Its name.
    pub name: String,
}

impl SignFlip {
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

impl StrainEffect for SignFlip {
    fn id(&self) -> &'static str {
        "sign_flip"
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
            *cell = -*cell;
        }
    }
    fn extension(&self, _frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        Extension::Channel {
            id: self.id(),
            gauge: self.name.clone(),
            size: -1.0,
            unit: "1",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!(
            "press or warm the structure by hand at gauge {} and look at the sign, or shunt one arm",
            self.name
        )
    }
    fn gauges(&self) -> Vec<usize> {
        vec![self.gauge]
    }
}
