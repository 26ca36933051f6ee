//! `cross_sensitivity`: a channel that reads a share of its neighbour (a common lead, a multiplexer that does not settle).

use super::channel_fault::{ChannelFault, FaultScope, OnGauges};
use super::{Correction, Extension, Parameter};
use crate::reconcile::strain::StrainFrame;

/// Reading = strain + share times the strain at the neighbour in file order.
#[derive(Clone, Debug)]
pub struct CrossSensitivity {
    /// Gauge whose strain contributes to the reading.
    pub neighbour: usize,
}

impl CrossSensitivity {
    /// Returns one effect for every gauge with its predecessor, and one with its successor.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        let n = frame.n_gauges();
        let mut out = Vec::new();
        for g in 0..n {
            let before = g.checked_sub(1);
            let after = Some(g + 1).filter(|h| *h < n);
            let each = before.into_iter().chain(after);
            out.extend(each.map(|neighbour| OnGauges::with_gauge(frame, g, Self { neighbour })));
        }
        out
    }
}

impl ChannelFault for CrossSensitivity {
    fn id(&self) -> &'static str {
        "cross_sensitivity"
    }
    fn parameters(&self) -> Vec<Parameter> {
        let unit = "of its neighbour";
        vec![Parameter {
            unit,
            neutral: 0.0,
            prior_sd: 0.2,
            step: 0.005,
            starts: vec![0.0],
            plausible: 1.0,
        }]
    }
    fn read(&self, at: FaultScope<'_>, parameters: &[f64], row: &mut [f64]) {
        let (Some(share), Some(leaks)) = (parameters.first(), row.get(self.neighbour).copied())
        else {
            return;
        };
        for &g in at.gauges {
            if let Some(cell) = row.get_mut(g) {
                *cell += share * leaks;
            }
        }
    }
    fn extension(&self, names: &[String], _parameters: &[f64]) -> Extension {
        Extension::channel(names, Correction::Ignore)
    }
    fn separate_by(&self, place: &str) -> String {
        format!("shunt the channels next to gauge {place} and check whether its reading changes")
    }
}
