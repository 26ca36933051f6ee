//! `thermal_uniform`, `thermal_gradient`: the structure is warmer than in the installation state, evenly or on one side.

use super::{Amplitudes, Extension, Nuisance, Stage, StrainEffect};
use crate::reconcile::strain::StrainFrame;

/// The two patterns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// Equal temperature change of the whole structure.
    Uniform,
    /// One side warmer.
    Gradient,
}

/// Strain = strain + temperature of the run times the pattern.
#[derive(Clone, Debug)]
pub struct ThermalStrain {
    /// Pattern of the temperature.
    pub pattern: Pattern,
}

impl ThermalStrain {
    /// Returns the effect of an even temperature if the frame contains its strain.
    pub fn list_uniform_effects(frame: &StrainFrame) -> Vec<Self> {
        Self::list_pattern_effects(frame, Pattern::Uniform)
    }

    /// Returns the effect of a gradient if the frame contains its strain.
    pub fn gradient(frame: &StrainFrame) -> Vec<Self> {
        Self::list_pattern_effects(frame, Pattern::Gradient)
    }

    fn list_pattern_effects(frame: &StrainFrame, pattern: Pattern) -> Vec<Self> {
        let one = Self { pattern };
        let strains = one
            .signature(frame)
            .is_some_and(|s| s.iter().any(|v| *v != 0.0));
        if strains { vec![one] } else { Vec::new() }
    }

    fn signature<'a>(&self, frame: &'a StrainFrame) -> Option<&'a Vec<f64>> {
        match self.pattern {
            Pattern::Uniform => frame.thermal_uniform.as_ref(),
            Pattern::Gradient => frame.thermal_gradient.as_ref(),
        }
    }

    /// Returns the usual size, degrees: change during a day outdoors, and difference from sun on one side.
    fn usual_degrees(&self) -> f64 {
        match self.pattern {
            Pattern::Uniform => 12.0,
            Pattern::Gradient => 5.0,
        }
    }
}

impl StrainEffect for ThermalStrain {
    fn id(&self) -> &str {
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
            steady: vec![self.usual_degrees()],
            correlation: 0.0,
            unit: "degC",
            plausible: vec![60.0],
        })
    }
    fn extension(&self, _frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        Extension::NuisanceLoads {
            source: match self.pattern {
                Pattern::Uniform => Nuisance::UniformTemperature,
                Pattern::Gradient => Nuisance::TemperatureGradient,
            },
            loads: vec![(self.id().into(), self.usual_degrees())],
            unit: "degC",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        match self.pattern {
            Pattern::Uniform => "record the temperature of the frame in every run, or add a dummy gauge on a free plate next to it".into(),
            Pattern::Gradient => "record the temperature on both sides of the rails in every run".into(),
        }
    }
}
