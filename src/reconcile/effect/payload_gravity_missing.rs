//! `payload_gravity_missing`: the payload's weight acts nowhere in the model, since gravity as a body force cancels under inertia relief.

use super::{Extension, Stage, StrainEffect};
use crate::reconcile::strain::{PayloadWeight, StrainFrame, StrainState};

/// The weight acts as a point load at the payload's place.
#[derive(Clone, Debug)]
pub struct PayloadGravityMissing;

impl PayloadGravityMissing {
    /// Returns the effect if the analyst's model lacks the weight.
    pub fn list_effects(frame: &StrainFrame) -> Vec<Self> {
        let carries = frame.payload.iter().any(|p| p[0] > 0.0);
        if frame.payload_weight == PayloadWeight::Missing && carries {
            vec![Self]
        } else {
            Vec::new()
        }
    }
}

impl StrainEffect for PayloadGravityMissing {
    fn id(&self) -> &str {
        "payload_gravity_missing"
    }
    fn stage(&self) -> Stage {
        Stage::Loads
    }
    fn alter(&self, frame: &StrainFrame, _parameters: &[f64], state: &mut StrainState) {
        state.set_payload(frame, 0.0, 0.0);
    }
    fn extension(&self, _frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        Extension::PayloadWeight
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        "repeat a run without payload: the gap of a missing payload weight vanishes".into()
    }
}
