//! `card_gain`: one amplifier or module with a wrong gain for several channels that follow each other.

use super::channel_fault::{ChannelFault, FaultScope, OnGauges};
use super::gauge_gain::{gain_parameter, scale};
use super::{Correction, Extension, Parameter};
use crate::reconcile::strain::StrainFrame;

/// Reading = gain times strain at every channel from the first to the last.
#[derive(Clone, Debug)]
pub struct CardGain;

impl CardGain {
    /// Every stretch of two or more channels in file order, up to half of them (a wrong gain of more is one of the rest, or of all).
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        /// Amplifier cards hold at most this many channels.
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
