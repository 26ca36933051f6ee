//! `wheel_scale`: the scale or transducer under one wheel, or under all, reads the true force times a factor.

use super::{Extension, Parameter, Stage, StrainEffect};
use crate::reconcile::strain::{StrainFrame, StrainState, WheelForces};

/// Recorded load = (1 + size / 100) times the load that acts.
#[derive(Clone, Debug)]
pub struct WheelScale {
    /// Indices of the loads: one, or all.
    pub loads: Vec<usize>,
    /// Names of the loads.
    pub name: String,
    /// Place: the name of the load without its component, if that is still unique.
    pub place: String,
}

impl WheelScale {
    /// Returns one effect for every measured load, and one for all loads together (a wrong unit, scales calibrated against one weight).
    pub fn list_effects(frame: &StrainFrame) -> Vec<Self> {
        if frame.wheel_forces != WheelForces::Measured {
            return Vec::new();
        }
        let names = &frame.load_names;
        let one = |(load, name): (usize, &String)| Self {
            loads: vec![load],
            name: name.clone(),
            place: stem(names, name),
        };
        let all = (names.len() > 1).then(|| Self {
            loads: (0..names.len()).collect(),
            name: names.join(", "),
            place: ALL.into(),
        });
        names.iter().enumerate().map(one).chain(all).collect()
    }
}

/// The place of a scale that is common to all loads.
const ALL: &str = "all";
/// Readings in pounds-force or kilograms-force where newtons are meant, and the reverse, as percent above the true load.
const UNITS: [f64; 4] = [-77.52, 344.8, -89.8, 880.7];

/// Returns the stem of a load name, such as `LF` of `LF.FZ`, if no other load has that stem; otherwise the whole name.
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
        // Scales are calibrated to one percent, and a wrong scale is off by several percent.
        let units = if self.loads.len() > 1 {
            &UNITS[..]
        } else {
            &[]
        };
        vec![Parameter {
            unit: "percent",
            neutral: 0.0,
            prior_sd: 10.0,
            step: 0.1,
            starts: [&[0.0][..], units].concat(),
            plausible: 60.0,
        }]
    }
    fn alter(&self, _frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let factor = 1.0 + parameters.first().copied().unwrap_or(0.0) / 100.0;
        let n_c = state.shape[2];
        for row in state.columns.chunks_exact_mut(n_c.max(1)) {
            for &load in &self.loads {
                if let Some(cell) = row.get_mut(load) {
                    *cell /= factor;
                }
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
        if self.loads.len() > 1 {
            return "weigh a known mass on one of the scales, and check the unit of the recorded wheel loads".into();
        }
        format!(
            "exchange the scale under {} with the scale of another wheel and repeat: the factor follows the scale",
            self.place
        )
    }
}
