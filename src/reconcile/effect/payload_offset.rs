//! `payload_offset`: the place of the payload differs from the recorded place.

use super::{Extension, Parameter, Stage, StrainEffect};
use crate::reconcile::strain::{PayloadWeight, StrainFrame, StrainState};

/// Direction in which the payload may be off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Offset forward or back.
    Along,
    /// Offset to a side.
    Across,
    /// Offset in both directions.
    Both,
}

/// The payload acts at (x + dx, dy) in all runs.
#[derive(Clone, Debug)]
pub struct PayloadOffset {
    /// Direction of the offset.
    pub axis: Axis,
}

impl PayloadOffset {
    /// Returns one effect for each direction; none if the model lacks the payload or no run carries one.
    pub fn list_effects(frame: &StrainFrame) -> Vec<Self> {
        let carries = frame.payload.iter().any(|p| p[0] > 0.0);
        if frame.payload_weight == PayloadWeight::Missing || !carries {
            return Vec::new();
        }
        [Axis::Along, Axis::Across, Axis::Both]
            .map(|axis| Self { axis })
            .to_vec()
    }

    fn offset(&self, parameters: &[f64]) -> [f64; 2] {
        let first = parameters.first().copied().unwrap_or(0.0);
        match self.axis {
            Axis::Along => [first, 0.0],
            Axis::Across => [0.0, first],
            Axis::Both => [first, parameters.get(1).copied().unwrap_or(0.0)],
        }
    }
}

impl StrainEffect for PayloadOffset {
    fn id(&self) -> &str {
        "payload_offset"
    }
    fn stage(&self) -> Stage {
        Stage::Loads
    }
    fn parameters(&self) -> Vec<Parameter> {
        let one = Parameter {
            unit: "m",
            neutral: 0.0,
            prior_sd: 0.3,
            step: 0.01,
            starts: vec![0.0],
            plausible: 2.0,
        };
        match self.axis {
            Axis::Along | Axis::Across => vec![one],
            Axis::Both => vec![one.clone(), one],
        }
    }
    fn alter(&self, frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let [dx, dy] = self.offset(parameters);
        state.set_payload(frame, dx, dy);
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        let [dx, dy] = self.offset(parameters);
        Extension::PayloadOffset { dx, dy }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        "measure the position of the payload, or remove the payload and repeat the run: the gap of an offset vanishes".into()
    }
}
