//! `unaccounted_mass`: a mass was added after the zero was taken.

use super::{Extension, Parameter, Stage, StrainEffect};
use crate::reconcile::strain::{StrainFrame, StrainState};

/// Strain = strain + size times the signature of a mass at the place.
#[derive(Clone, Debug)]
pub struct UnaccountedMass {
    /// Index into the frame's masses.
    pub mass: usize,
    /// Place.
    pub name: String,
}

impl UnaccountedMass {
    /// Returns one effect for every place.
    pub fn list_effects(frame: &StrainFrame) -> Vec<Self> {
        frame
            .masses
            .iter()
            .enumerate()
            .map(|(mass, m)| Self {
                mass,
                name: m.place.clone(),
            })
            .collect()
    }
}

impl StrainEffect for UnaccountedMass {
    fn id(&self) -> &str {
        "unaccounted_mass"
    }
    fn place(&self) -> Option<String> {
        Some(self.name.clone())
    }
    fn stage(&self) -> Stage {
        Stage::Loads
    }
    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter {
            unit: "kg",
            neutral: 0.0,
            prior_sd: 400.0,
            step: 5.0,
            starts: vec![0.0],
            plausible: 5000.0,
        }]
    }
    fn alter(&self, frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let (Some(kg), Some(signature)) = (parameters.first(), frame.masses.get(self.mass)) else {
            return;
        };
        for row in state.extra.chunks_exact_mut(frame.n_gauges().max(1)) {
            for (cell, per_kg) in row.iter_mut().zip(&signature.per_kg) {
                *cell += kg * per_kg;
            }
        }
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        Extension::Mass {
            place: self.name.clone(),
            kilogram: parameters.first().copied().unwrap_or(0.0),
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!(
            "weigh the empty truck axle by axle, or put a known mass at {} and repeat",
            self.name
        )
    }
}
