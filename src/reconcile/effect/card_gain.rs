//! `card_gain`: one amplifier or module with a wrong gain for several consecutive channels.

use super::channel_fault::{ChannelFault, FaultScope, OnGauges};
use super::gauge_gain::{gain_parameter, scale};
use super::{Correction, Extension, Parameter};
use crate::reconcile::strain::StrainFrame;

/// Reading = gain times strain at every channel from the first to the last.
#[derive(Clone, Debug)]
pub struct CardGain;

impl CardGain {
    /// Returns one effect for every range of two or more channels in file order, up to half of all channels. A wrong gain of more channels is
    /// equivalent to a wrong gain of the other channels, or of all channels.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        /// Largest number of channels of an amplifier card.
        const MOST: usize = 16;
        let n = frame.n_gauges();
        let place = |names: &[String]| match names {
            [first, .., last] => format!("{first}-{last}"),
            other => other.join("-"),
        };
        let mut out = Vec::new();
        for length in 2..=MOST.min(n / 2) {
            for first in 0..=n - length {
                out.push(OnGauges::new(
                    frame,
                    (first..first + length).collect(),
                    Self,
                    place,
                ));
            }
        }
        out
    }
}

impl ChannelFault for CardGain {
    fn id(&self) -> &'static str {
        "card_gain"
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
            "shunt-calibrate one gauge of {place} and one gauge outside it: a wrong amplifier gain shows in the first gauge alone"
        )
    }
}
