//! `zero_drift`: a channel's zero has moved since the installation state.

use super::channel_fault::{ChannelFault, FaultScope, OnGauges};
use super::{Amplitudes, Correction, Extension, FaultKind, Parameter};
use crate::reconcile::strain::{Part, StrainFrame};

/// Way in which the zero changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZeroDrift {
    /// Drift by an equal amount in all runs.
    Step,
    /// Creep in proportion to the number of the run. The size is the drift at the last run.
    Creep,
    /// Linear drift from the value at the first run. The size is the change from the first run to the last.
    Line,
    /// A constant offset with scatter about it from run to run.
    Wander,
}

/// Usual drift of a zero, microstrain: a bridge balanced to some hundredths of a millivolt per volt.
const USUAL: f64 = 40.0;
/// Usual scatter of a zero that wanders, microstrain.
const USUAL_SCATTER: f64 = 10.0;
/// Largest plausible drift, microstrain. A bridge with a larger offset cannot be balanced.
const PLAUSIBLE: f64 = 1000.0;

impl ZeroDrift {
    /// Returns one effect of each kind for every gauge.
    pub fn list_effects(frame: &StrainFrame) -> Vec<OnGauges<Self>> {
        let kinds = [Self::Step, Self::Creep, Self::Line, Self::Wander];
        (0..frame.n_gauges())
            .flat_map(|g| kinds.map(|k| OnGauges::with_gauge(frame, g, k)))
            .collect()
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Creep => "microstrain at the last run",
            Self::Line => "microstrain from the first run to the last",
            Self::Step | Self::Wander => "microstrain",
        }
    }
}

impl ChannelFault for ZeroDrift {
    fn id(&self) -> &'static str {
        "zero_drift"
    }
    fn kind(&self) -> FaultKind {
        FaultKind::Zero
    }
    fn parameters(&self) -> Vec<Parameter> {
        let of = |unit| Parameter {
            unit,
            neutral: 0.0,
            prior_sd: USUAL,
            step: 0.5,
            starts: vec![0.0],
            plausible: PLAUSIBLE,
        };
        let mut all = vec![of(self.unit())];
        if *self == Self::Line {
            all.push(of("microstrain at the first run"));
        }
        all
    }
    fn read(&self, at: FaultScope<'_>, parameters: &[f64], row: &mut [f64]) {
        let (Part::Whole, [size, ..]) = (at.part, parameters) else {
            return;
        };
        let n = at.frame.n_runs();
        let moved = match self {
            Self::Creep => size * (at.run + 1) as f64 / n.max(1) as f64,
            Self::Line => {
                let first = parameters.get(1).copied().unwrap_or(0.0);
                first + size * at.run as f64 / n.saturating_sub(1).max(1) as f64
            }
            Self::Step | Self::Wander => *size,
        };
        for &g in at.gauges {
            if let Some(cell) = row.get_mut(g) {
                *cell += moved;
            }
        }
    }
    fn amplitudes(&self, frame: &StrainFrame, gauges: &[usize]) -> Option<Amplitudes> {
        if *self != Self::Wander {
            return None;
        }
        let own = |g: &usize| {
            (0..frame.n_gauges())
                .map(|h| if h == *g { 1.0 } else { 0.0 })
                .collect()
        };
        Some(Amplitudes {
            patterns: gauges.iter().map(own).collect(),
            kinds: vec![0; gauges.len()],
            usual: vec![USUAL_SCATTER],
            steady: vec![0.0],
            correlation: 0.0,
            unit: self.unit(),
            plausible: vec![PLAUSIBLE],
        })
    }
    fn extension(&self, names: &[String], parameters: &[f64]) -> Extension {
        let size = parameters.first().copied().unwrap_or(0.0);
        match self {
            Self::Step => Extension::channel(names, Correction::Offset(size)),
            // The zero in other runs is unknown.
            Self::Creep | Self::Line | Self::Wander => {
                Extension::channel(names, Correction::Ignore)
            }
        }
    }
    fn separate_by(&self, place: &str) -> String {
        format!(
            "read gauge {place} in the installation state again (empty, level, reference temperature): a drifted zero stays"
        )
    }
}
