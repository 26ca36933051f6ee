//! `lateral_wheel_loads`: side and longitudinal forces and moments at the wheels (scrubbing axles, brakes, camber).

use super::{Amplitudes, Extension, Nuisance, Stage, StrainEffect};
use crate::reconcile::strain::StrainFrame;

/// Strain = strain + every component at every wheel, of unknown size in every run.
#[derive(Clone, Debug)]
pub struct LateralWheelLoads;

/// Components with their usual sizes as shares of a usual wheel force, moments per metre.
///
/// A scrubbing tyre pushes sideways with a quarter of its load, a third of the force at which it slides. Rolling resistance and brakes left on cause
/// a tenth of the load. The side force acts half a metre below the hub, and the other forces act a few centimetres off it.
const USUAL: [(&str, f64); 5] = [
    ("FX", 0.1),
    ("FY", 0.25),
    ("MX", 0.12),
    ("MY", 0.04),
    ("MZ", 0.04),
];

/// Returns the usual size of each component in `frame`, kN and kN m.
fn usual_sizes(frame: &StrainFrame) -> Vec<f64> {
    USUAL.iter().map(|u| u.1 * frame.usual_load()).collect()
}

fn component(name: &str) -> Option<usize> {
    let has = |c: &str| name.starts_with(c) || name.ends_with(c);
    USUAL.iter().position(|(c, _)| has(c))
}

impl LateralWheelLoads {
    /// Returns the effect if the frame contains such loads.
    pub fn list_effects(frame: &StrainFrame) -> Vec<Self> {
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
    fn id(&self) -> &str {
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
            usual: usual_sizes(frame),
            steady: usual_sizes(frame),
            correlation: 0.0,
            unit: "kN",
            plausible: usual_sizes(frame)
                .iter()
                .map(|u| frame.rules.side_load * u)
                .collect(),
        })
    }
    fn extension(&self, frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        let usual = usual_sizes(frame);
        let sized = |n: &String| {
            component(n)
                .and_then(|k| usual.get(k))
                .map(|u| (n.clone(), *u))
        };
        let loads = frame
            .other_loads
            .iter()
            .filter_map(|(n, _)| sized(n))
            .collect();
        Extension::NuisanceLoads {
            source: Nuisance::SideLoads,
            loads,
            unit: "kN",
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        "put the wheels on turntables or greased plates and repeat a run: side forces vanish, all other effects remain".into()
    }
}
