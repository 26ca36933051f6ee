//! `lateral_wheel_loads`: side and longitudinal forces and moments at the wheels (scrubbing axles, brakes, camber).

use super::{Amplitudes, Extension, Stage, StrainEffect};
use crate::reconcile::strain::StrainFrame;

/// Strain = strain + every component at every wheel, of unknown size in every run.
#[derive(Clone, Debug)]
pub struct LateralWheelLoads;

/// Components with their usual sizes on scrubbing tyres: side forces of 2 kN, the rest follows.
const USUAL: [(&str, f64); 5] = [
    ("FX", 0.8),
    ("FY", 2.0),
    ("MX", 0.9),
    ("MY", 0.3),
    ("MZ", 0.3),
];

fn component(name: &str) -> Option<usize> {
    let has = |c: &str| name.starts_with(c) || name.ends_with(c);
    USUAL.iter().position(|(c, _)| has(c))
}

impl LateralWheelLoads {
    /// Itself where the frame knows such loads.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        if frame
            .other_loads
            .iter()
            .any(|(n, _)| component(n).is_some())
        {
            vec![Self]
        } else {
            Vec::new()
        }
    }
}

impl StrainEffect for LateralWheelLoads {
    fn id(&self) -> &'static str {
        "lateral_wheel_loads"
    }
    fn stage(&self) -> Stage {
        Stage::Loads
    }
    fn amplitudes(&self, frame: &StrainFrame) -> Option<Amplitudes> {
        let known = || {
            frame
                .other_loads
                .iter()
                .filter_map(|(n, p)| component(n).map(|k| (k, p)))
        };
        Some(Amplitudes {
            patterns: known().map(|(_, p)| p.clone()).collect(),
            kinds: known().map(|(k, _)| k).collect(),
            usual: USUAL.iter().map(|u| u.1).collect(),
            unit: "kN",
            plausible: 30.0,
        })
    }
    fn extension(&self, frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        let sized = |n: &String| {
            component(n)
                .and_then(|k| USUAL.get(k))
                .map(|u| (n.clone(), u.1))
        };
        let loads = frame
            .other_loads
            .iter()
            .filter_map(|(n, _)| sized(n))
            .collect();
        Extension::NuisanceLoads {
            id: self.id(),
            loads,
            unit: "kN",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        "put the wheels on turntables or greased plates and repeat a run: side forces vanish, everything else stays".into()
    }
}
