//! `uneven_ground`: the ground under the wheels is not flat, so the forces differ from those computed for flat ground.

use super::{Amplitudes, Extension, Nuisance, Stage, StrainEffect};
use crate::reconcile::strain::{StrainFrame, WheelForces, ground_patterns};

/// Self-balanced change of the wheel forces, unknown in every run: strain = strain + influence times the change.
#[derive(Clone, Debug)]
pub struct UnevenGround;

/// Usual change of a wheel force, relative to a usual wheel force.
const USUAL: f64 = 0.25;

impl UnevenGround {
    /// Returns the effect if the wheel forces are computed, not measured, and the job does not state uneven ground; otherwise an empty list.
    pub fn list_effects(frame: &StrainFrame) -> Vec<Self> {
        let warps = !ground_patterns(frame).is_empty();
        let missing = frame.wheel_forces == WheelForces::FlatGroundModel && frame.ground == 0.0;
        if missing && warps {
            vec![Self]
        } else {
            Vec::new()
        }
    }
}

impl StrainEffect for UnevenGround {
    fn id(&self) -> &str {
        "uneven_ground"
    }
    fn stage(&self) -> Stage {
        Stage::Loads
    }
    fn amplitudes(&self, frame: &StrainFrame) -> Option<Amplitudes> {
        let patterns = ground_patterns(frame);
        Some(Amplitudes {
            kinds: vec![0; patterns.len()],
            patterns,
            usual: vec![USUAL * frame.usual_load()],
            steady: vec![USUAL * frame.usual_load()],
            correlation: 0.0,
            unit: "kN",
            plausible: vec![4.0 * frame.usual_load()],
        })
    }
    fn extension(&self, frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        let loads = frame
            .load_names
            .iter()
            .map(|n| (n.clone(), USUAL * frame.usual_load()))
            .collect();
        Extension::NuisanceLoads {
            source: Nuisance::Ground,
            loads,
            unit: "kN",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        "weigh every wheel at its place, or turn the truck end for end on the same ground".into()
    }
}
