//! `thermal_uniform`, `thermal_gradient`: the structure is warmer than in the installation state, evenly or on one side.

use super::{Amplitudes, Extension, Stage, StrainEffect};
use crate::reconcile::strain::StrainFrame;

/// The two patterns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// All the structure alike.
    Uniform,
    /// One side warmer.
    Gradient,
}

/// Strain = strain + temperature of the run times the pattern.
#[derive(Clone, Debug)]
pub struct Thermal {
    /// Which pattern.
    pub pattern: Pattern,
}

impl Thermal {
    /// Every pattern the frame knows.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        let both = [Pattern::Uniform, Pattern::Gradient].map(|pattern| Self { pattern });
        both.into_iter()
            .filter(|t| {
                t.signature(frame)
                    .is_some_and(|s| s.iter().any(|v| *v != 0.0))
            })
            .collect()
    }

    fn signature<'a>(&self, frame: &'a StrainFrame) -> Option<&'a Vec<f64>> {
        match self.pattern {
            Pattern::Uniform => frame.thermal_uniform.as_ref(),
            Pattern::Gradient => frame.thermal_gradient.as_ref(),
        }
    }

    fn usual_degrees(&self) -> f64 {
        match self.pattern {
            Pattern::Uniform => 12.0,
            Pattern::Gradient => 5.0,
        }
    }
}

impl StrainEffect for Thermal {
    fn id(&self) -> &'static str {
        match self.pattern {
            Pattern::Uniform => "thermal_uniform",
            Pattern::Gradient => "thermal_gradient",
        }
    }
    fn stage(&self) -> Stage {
        Stage::Loads
    }
    fn amplitudes(&self, frame: &StrainFrame) -> Option<Amplitudes> {
        let signature = self.signature(frame)?;
        Some(Amplitudes {
            patterns: vec![signature.clone()],
            kinds: vec![0],
            usual: vec![self.usual_degrees()],
            unit: "degC",
            plausible: 60.0,
        })
    }
    fn extension(&self, _frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        Extension::NuisanceLoads {
            id: self.id(),
            loads: vec![(self.id().into(), self.usual_degrees())],
            unit: "degC",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        match self.pattern {
            Pattern::Uniform => "log the frame's temperature in every run, or glue a dummy gauge on a free plate beside".into(),
            Pattern::Gradient => "log the temperature on both sides of the rails in every run".into(),
        }
    }
}
