//! `intermittent_channel`: a channel that reads nothing in some runs (a loose contact).

use super::channel_fault::{ChannelFault, FaultScope, OnGauges};
use super::{Correction, Extension};
use crate::reconcile::strain::{StrainFrame, predict};

/// Effect of a loose contact: the channel reads zero in some runs, and strain in the other runs.
#[derive(Clone, Debug)]
pub struct IntermittentChannel {
    /// Whether the contact is open, by run.
    pub open: Vec<bool>,
}

impl IntermittentChannel {
    /// Returns one effect for every gauge that loses its signal. It reads only noise in a run with a clearly larger prediction, and reads strain in
    /// another run.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        /// Limits in units of the noise: a smaller reading counts as absent, and a larger one as present (`CLEAR`).
        const NOTHING: f64 = 3.0;
        const CLEAR: f64 = 6.0;
        let predicted = predict(frame, &[]);
        let mut out = Vec::new();
        for g in 0..frame.n_gauges() {
            let at = |r: usize| {
                (
                    frame.observations.value(r, g),
                    predicted.get(r * frame.n_gauges() + g),
                )
            };
            let runs = 0..frame.n_runs();
            // The reading is nearer to zero than to the prediction, so a lost weak reading counts as well.
            let noise = frame.noise_of(g);
            let silent = |r: usize| matches!(at(r), (y, Some(p)) if y.abs() < NOTHING * noise && y.abs() < (y - p).abs());
            let clear = |r: usize| matches!(at(r), (_, Some(p)) if p.abs() > CLEAR * noise);
            let open: Vec<bool> = runs.clone().map(silent).collect();
            let lost = runs.clone().any(|r| silent(r) && clear(r));
            let reads = runs
                .clone()
                .any(|r| matches!(at(r), (y, Some(_)) if y.abs() > CLEAR * noise));
            if reads && lost {
                out.push(OnGauges::with_gauge(frame, g, Self { open }));
            }
        }
        out
    }
}

impl ChannelFault for IntermittentChannel {
    fn id(&self) -> &'static str {
        "intermittent_channel"
    }
    fn read(&self, at: FaultScope<'_>, _parameters: &[f64], row: &mut [f64]) {
        if !self.open.get(at.run).copied().unwrap_or(false) {
            return;
        }
        for &g in at.gauges {
            if let Some(cell) = row.get_mut(g) {
                *cell = 0.0;
            }
        }
    }
    fn runs(&self) -> Vec<usize> {
        let runs = self.open.iter().enumerate();
        runs.filter(|(_, open)| **open).map(|(r, _)| r).collect()
    }
    fn extension(&self, names: &[String], _parameters: &[f64]) -> Extension {
        Extension::channel(names, Correction::Ignore)
    }
    fn separate_by(&self, place: &str) -> String {
        format!(
            "move the leads of gauge {place} while it is read: the reading of a loose contact jumps"
        )
    }
}
