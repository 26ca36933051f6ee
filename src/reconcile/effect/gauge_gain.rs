//! `gauge_gain`: a wrong gauge factor, amplifier gain or bridge factor.

use super::channel_fault::{ChannelFault, FaultScope, OnGauges, on_every_gauge};
use super::{Correction, Extension, Parameter};
use crate::reconcile::strain::StrainFrame;

/// Reading = gain times strain.
#[derive(Clone, Debug)]
pub struct GaugeGain;

impl GaugeGain {
    /// Returns one effect for every gauge.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        on_every_gauge(frame, &Self)
    }
}

/// Returns the parameter of a gain. A gain may be wrong by a bridge factor of 1/4 to 4, which is a common mistake. It may also be wrong by some
/// tenths because of a wrong gauge factor.
pub(super) fn gain_parameter() -> Parameter {
    Parameter {
        unit: "1",
        neutral: 1.0,
        prior_sd: 0.5,
        step: 0.01,
        starts: vec![1.0],
        plausible: 4.0,
    }
}

impl ChannelFault for GaugeGain {
    fn id(&self) -> &'static str {
        "gauge_gain"
    }
    fn parameters(&self) -> Vec<Parameter> {
        vec![gain_parameter()]
    }
    fn read(&self, at: FaultScope<'_>, parameters: &[f64], row: &mut [f64]) {
        scale(at, parameters, row);
    }
    fn extension(&self, names: &[String], parameters: &[f64]) -> Extension {
        Extension::channel(
            names,
            Correction::Gain(parameters.first().copied().unwrap_or(1.0)),
        )
    }
    fn separate_by(&self, place: &str) -> String {
        format!(
            "shunt-calibrate gauge {place}: the shunt shows a wrong gain, and does not show a wrong angle or position"
        )
    }
}

/// Multiplies the entries of the gauges by the first parameter.
pub(super) fn scale(at: FaultScope<'_>, parameters: &[f64], row: &mut [f64]) {
    let Some(gain) = parameters.first() else {
        return;
    };
    for &g in at.gauges {
        if let Some(cell) = row.get_mut(g) {
            *cell *= gain;
        }
    }
}
