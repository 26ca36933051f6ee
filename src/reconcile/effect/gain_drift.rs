//! `gain_drift`: a gain that moves through the series of runs, of one channel or of all (supply voltage, bonding).

use super::channel_fault::{ChannelFault, FaultScope, OnGauges};
use super::{Correction, Extension, Parameter};
use crate::reconcile::strain::StrainFrame;

/// Reading = strain times `1 + size k / (n - 1)`, with k the number of the run from 0 and n the number of runs.
#[derive(Clone, Debug)]
pub struct GainDrift;

impl GainDrift {
    /// Returns one drift of all channels together, then one drift of each gauge separately.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        let n = frame.n_gauges();
        let all = OnGauges::new(frame, (0..n).collect(), Self, |_| "all".into());
        std::iter::once(all)
            .chain((0..n).map(|g| OnGauges::with_gauge(frame, g, Self)))
            .collect()
    }
}

impl ChannelFault for GainDrift {
    fn id(&self) -> &'static str {
        "gain_drift"
    }
    fn parameters(&self) -> Vec<Parameter> {
        let unit = "of the gain, from the first run to the last";
        vec![Parameter {
            unit,
            neutral: 0.0,
            prior_sd: 0.2,
            step: 0.005,
            starts: vec![0.0],
            plausible: 2.0,
        }]
    }
    fn read(&self, at: FaultScope<'_>, parameters: &[f64], row: &mut [f64]) {
        let Some(size) = parameters.first() else {
            return;
        };
        let steps = at.frame.n_runs().saturating_sub(1).max(1);
        let gain = 1.0 + size * at.run as f64 / steps as f64;
        for &g in at.gauges {
            if let Some(cell) = row.get_mut(g) {
                *cell *= gain;
            }
        }
    }
    fn extension(&self, names: &[String], _parameters: &[f64]) -> Extension {
        // The gain in other runs is unknown.
        Extension::channel(names, Correction::Ignore)
    }
    fn separate_by(&self, place: &str) -> String {
        format!(
            "repeat the first run at the end, and shunt-calibrate {place} before and after: the shunt shows a gain that drifts"
        )
    }
}
