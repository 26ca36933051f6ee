//! `sign_flip`: a channel with its polarity turned.

use super::channel_fault::{ChannelFault, FaultScope, OnGauges, on_every_gauge};
use super::{Correction, Extension};
use crate::reconcile::strain::StrainFrame;

/// Reading = -strain.
#[derive(Clone, Debug)]
pub struct SignFlip;

impl SignFlip {
    /// Returns one effect for every gauge.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        on_every_gauge(frame, &Self)
    }
}

impl ChannelFault for SignFlip {
    fn id(&self) -> &'static str {
        "sign_flip"
    }
    fn read(&self, at: FaultScope<'_>, _parameters: &[f64], row: &mut [f64]) {
        for &g in at.gauges {
            if let Some(cell) = row.get_mut(g) {
                *cell = -*cell;
            }
        }
    }
    fn extension(&self, names: &[String], _parameters: &[f64]) -> Extension {
        Extension::channel(names, Correction::Sign)
    }
    fn separate_by(&self, place: &str) -> String {
        format!(
            "press or warm the structure at gauge {place} and check the sign of its reading, or shunt one arm"
        )
    }
}
