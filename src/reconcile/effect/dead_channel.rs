//! `dead_channel`: a channel that reads nothing but noise.

use super::channel_fault::{ChannelFault, FaultScope, OnGauges, on_every_gauge};
use super::{Correction, Extension, FaultKind};
use crate::reconcile::strain::StrainFrame;

/// Dead channel: the reading is 0.
#[derive(Clone, Debug)]
pub struct DeadChannel;

impl DeadChannel {
    /// Returns one effect for every gauge.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        on_every_gauge(frame, &Self)
    }
}

impl ChannelFault for DeadChannel {
    fn id(&self) -> &'static str {
        "dead_channel"
    }
    fn kind(&self) -> FaultKind {
        FaultKind::Silent
    }
    fn read(&self, at: FaultScope<'_>, _parameters: &[f64], row: &mut [f64]) {
        for &g in at.gauges {
            if let Some(cell) = row.get_mut(g) {
                *cell = 0.0;
            }
        }
    }
    fn extension(&self, names: &[String], _parameters: &[f64]) -> Extension {
        Extension::channel(names, Correction::Ignore)
    }
    fn separate_by(&self, place: &str) -> String {
        format!(
            "check the leads and the insulation of gauge {place}: a shunt changes the reading of a working channel"
        )
    }
}
