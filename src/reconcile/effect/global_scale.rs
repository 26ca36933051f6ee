//! `global_scale`: all strain too large or too small by one factor: the modulus, a common gain.

use super::{Extension, Parameter, Stage, StrainEffect};
use crate::reconcile::strain::{StrainFrame, StrainState};

/// Influence = (1 + size / 100) times influence.
#[derive(Clone, Debug)]
pub struct GlobalScale;

impl StrainEffect for GlobalScale {
    fn id(&self) -> &str {
        "global_scale"
    }
    fn stage(&self) -> Stage {
        Stage::Structure
    }
    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter {
            unit: "percent",
            neutral: 0.0,
            prior_sd: 8.0,
            step: 0.5,
            starts: vec![0.0],
            plausible: 50.0,
        }]
    }
    fn alter(&self, _frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let factor = 1.0 + parameters.first().copied().unwrap_or(0.0) / 100.0;
        state.influence.iter_mut().for_each(|v| *v *= factor);
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        Extension::Scale(1.0 + parameters.first().copied().unwrap_or(0.0) / 100.0)
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        "shunt-calibrate any gauge: the shunt shows a common gain, and does not show a wrong modulus or a wrong scale of the forces".into()
    }
}
