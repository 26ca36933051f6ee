//! `wheel_scale`: the scale or transducer under one wheel reads a factor of the true force.

use super::{Extension, Parameter, Stage, StrainEffect};
use crate::reconcile::strain::{StrainFrame, StrainState, WheelForces};

/// Noted load = (1 + size / 100) times the load that acts.
#[derive(Clone, Debug)]
pub struct WheelScale {
    /// Index of the load.
    pub load: usize,
    /// Its name.
    pub name: String,
    /// Its place: the name without the component, where that is still unique.
    pub place: String,
}

impl WheelScale {
    /// One on every load that was measured.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        if frame.wheel_forces != WheelForces::Measured {
            return Vec::new();
        }
        let one = |(load, name): (usize, &String)| Self {
            load,
            name: name.clone(),
            place: stem(&frame.load_names, name),
        };
        frame.load_names.iter().enumerate().map(one).collect()
    }
}

/// `LF` of `LF.FZ`, where no other load has that stem.
pub(super) fn stem(names: &[String], name: &str) -> String {
    let cut = |n: &str| n.split_once('.').map_or(n.to_owned(), |p| p.0.to_owned());
    let own = cut(name);
    if names.iter().filter(|n| cut(n) == own).count() == 1 {
        own
    } else {
        name.to_owned()
    }
}

impl StrainEffect for WheelScale {
    fn id(&self) -> &str {
        "wheel_scale"
    }
    fn place(&self) -> Option<String> {
        Some(self.place.clone())
    }
    fn stage(&self) -> Stage {
        Stage::Loads
    }
    fn parameters(&self) -> Vec<Parameter> {
        // Scales are calibrated to a percent; one that is wrong is wrong by some.
        vec![Parameter {
            unit: "percent",
            neutral: 0.0,
            prior_sd: 10.0,
            step: 0.1,
            starts: vec![0.0],
            plausible: 60.0,
        }]
    }
    fn alter(&self, _frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let factor = 1.0 + parameters.first().copied().unwrap_or(0.0) / 100.0;
        let n_c = state.shape[2];
        for row in state.columns.chunks_exact_mut(n_c.max(1)) {
            if let Some(cell) = row.get_mut(self.load) {
                *cell /= factor;
            }
        }
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        let factor = 1.0 + parameters.first().copied().unwrap_or(0.0) / 100.0;
        Extension::LoadScale {
            load: self.name.clone(),
            factor,
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!(
            "exchange the scale under {} with that of another wheel and repeat: the factor goes with the scale",
            self.place
        )
    }
}
