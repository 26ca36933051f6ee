//! `gauge_swap`: two channels exchanged.

use super::channel_fault::{ChannelFault, FaultScope, OnGauges};
use super::{Correction, Extension};
use crate::reconcile::strain::StrainFrame;

/// Exchange of two gauges: channel a reads the strain of gauge b, and channel b reads the strain of gauge a.
#[derive(Clone, Debug)]
pub struct GaugeSwap;

impl GaugeSwap {
    /// Returns one effect for every pair of gauges that are not legs of the same rosette.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        let n = frame.n_gauges();
        let mut out = Vec::new();
        for a in 0..n {
            let legs = frame.rosette(a);
            let others = (a + 1..n).filter(|b| !legs.contains(b));
            out.extend(
                others.map(|b| OnGauges::new(frame, vec![a, b], Self, |names| names.join("+"))),
            );
        }
        out
    }
}

impl ChannelFault for GaugeSwap {
    fn id(&self) -> &'static str {
        "gauge_swap"
    }
    fn read(&self, at: FaultScope<'_>, _parameters: &[f64], row: &mut [f64]) {
        if let [a, b] = *at.gauges
            && a < row.len()
            && b < row.len()
        {
            row.swap(a, b);
        }
    }
    fn extension(&self, names: &[String], _parameters: &[f64]) -> Extension {
        match names {
            [a, b] => Extension::Channels(vec![(a.clone(), Correction::ExchangedWith(b.clone()))]),
            _ => Extension::Nothing,
        }
    }
    fn separate_by(&self, place: &str) -> String {
        format!(
            "warm one of the gauges {} by hand and check which channel changes",
            place.replace('+', " and ")
        )
    }
}
