//! `rosette_legs`: the legs of a rosette connected in another order.

use super::channel_fault::{ChannelFault, FaultScope, OnGauges};
use super::{Correction, Extension};
use crate::reconcile::strain::StrainFrame;

/// Channel i of the rosette reads leg `order[i]`.
#[derive(Clone, Debug)]
pub struct RosetteLegs {
    /// Gauge that each channel, in file order, reads, as an index into the rosette.
    pub order: Vec<usize>,
}

impl RosetteLegs {
    /// Returns every other order of two or three legs at one place. The rosette has the name of its first leg.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        const ORDERS: [&[usize]; 6] = [
            &[1, 0],
            &[1, 0, 2],
            &[0, 2, 1],
            &[2, 1, 0],
            &[1, 2, 0],
            &[2, 0, 1],
        ];
        let mut out = Vec::new();
        for first in 0..frame.n_gauges() {
            let legs = frame.rosette(first);
            if legs.first() != Some(&first) {
                continue;
            }
            for order in ORDERS.iter().filter(|o| o.len() == legs.len()) {
                let fault = Self {
                    order: order.to_vec(),
                };
                let by_first = |names: &[String]| names.first().cloned().unwrap_or_default();
                out.push(OnGauges::new(frame, legs.clone(), fault, by_first));
            }
        }
        out
    }
}

impl ChannelFault for RosetteLegs {
    fn id(&self) -> &'static str {
        "rosette_legs"
    }
    fn read(&self, at: FaultScope<'_>, _parameters: &[f64], row: &mut [f64]) {
        let felt: Vec<f64> = at
            .gauges
            .iter()
            .map(|&g| row.get(g).copied().unwrap_or(f64::NAN))
            .collect();
        for (&channel, &leg) in at.gauges.iter().zip(&self.order) {
            if let (Some(cell), Some(v)) = (row.get_mut(channel), felt.get(leg)) {
                *cell = *v;
            }
        }
    }
    fn extension(&self, names: &[String], _parameters: &[f64]) -> Extension {
        // A cyclic exchange of three legs is two exchanges of two legs in sequence.
        let mut now: Vec<usize> = self.order.clone();
        let mut steps = Vec::new();
        for leg in 0..now.len() {
            let Some(at) = now.iter().position(|l| *l == leg).filter(|at| *at != leg) else {
                continue;
            };
            now.swap(leg, at);
            if let (Some(a), Some(b)) = (names.get(leg), names.get(at)) {
                steps.push((a.clone(), Correction::ExchangedWith(b.clone())));
            }
        }
        Extension::Channels(steps)
    }
    fn separate_by(&self, place: &str) -> String {
        format!(
            "trace the leads of the rosette at {place}, or shunt one leg and check which channel changes"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::RosetteLegs;
    use crate::reconcile::effect::channel_fault::ChannelFault;
    use crate::reconcile::effect::{Correction, Extension};

    /// Tests that the exchanges, in sequence, return every channel to its own leg.
    #[test]
    fn the_exchanges_undo_every_order_of_the_legs() {
        let names: Vec<String> = ["A", "B", "C"].map(String::from).to_vec();
        let orders: [&[usize]; 6] = [
            &[1, 0],
            &[1, 0, 2],
            &[0, 2, 1],
            &[2, 1, 0],
            &[1, 2, 0],
            &[2, 0, 1],
        ];
        for order in orders {
            let legs = RosetteLegs {
                order: order.to_vec(),
            };
            let Extension::Channels(steps) = legs.extension(&names, &[]) else {
                panic!("{order:?}: no corrections");
            };
            let mut read = order.to_vec();
            for (a, correction) in steps {
                let Correction::ExchangedWith(b) = correction else {
                    panic!("{order:?}: {correction:?}");
                };
                let at = |name: &String| names.iter().position(|n| n == name).expect("a leg");
                read.swap(at(&a), at(&b));
            }
            assert!(
                read.iter().enumerate().all(|(k, leg)| k == *leg),
                "{order:?}"
            );
        }
    }
}
