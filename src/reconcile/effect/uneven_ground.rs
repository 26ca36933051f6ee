//! `uneven_ground`: the wheels stand on ground that is not flat, so the forces differ from those computed for flat ground.

use super::{Amplitudes, Extension, Nuisance, Stage, StrainEffect};
use crate::reconcile::strain::{StrainFrame, WheelForces};

/// Strain = strain + influence times a self-balanced change of the wheel forces, unknown in every run.
#[derive(Clone, Debug)]
pub struct UnevenGround;

/// Usual change of a wheel force, of a usual wheel force.
const USUAL: f64 = 0.25;

impl UnevenGround {
    /// Itself where the wheel forces are computed, not measured, and the job has no ground of its own.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        let warps = frame.n_loads() > constraints(frame).len();
        let missing = frame.wheel_forces == WheelForces::FlatGroundModel && frame.ground == 0.0;
        if missing && warps {
            vec![Self]
        } else {
            Vec::new()
        }
    }
}

/// What a change of wheel forces can't alter: their sum and moments, as far as the wheels' places are known.
fn constraints(frame: &StrainFrame) -> Vec<Vec<f64>> {
    let n = frame.n_loads();
    let mut out = vec![vec![1.0; n]];
    if let Some(places) = &frame.load_positions {
        out.push(places.iter().map(|p| p[0]).collect());
        out.push(places.iter().map(|p| p[1]).collect());
    } else if frame
        .load_names
        .iter()
        .all(|name| name.starts_with(['L', 'R']))
    {
        // Named by side, as LF and RF are: the moment about the long axis is all that is known.
        out.push(
            frame
                .load_names
                .iter()
                .map(|name| if name.starts_with('L') { 1.0 } else { -1.0 })
                .collect(),
        );
    }
    out
}

/// An orthonormal basis of the forces that satisfy the constraints (Gram-Schmidt).
fn warps(frame: &StrainFrame) -> Vec<Vec<f64>> {
    /// Below this length a vector is what the basis already holds.
    const NEGLIGIBLE: f64 = 1e-9;
    let n = frame.n_loads();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let fixed = constraints(frame);
    let n_fixed_given = fixed.len();
    let mut n_fixed = 0;
    let units = (0..n).map(|i| {
        (0..n)
            .map(|j| if i == j { 1.0 } else { 0.0 })
            .collect::<Vec<f64>>()
    });
    for (k, mut v) in fixed.into_iter().chain(units).enumerate() {
        let before = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        for b in &basis {
            let along: f64 = b.iter().zip(&v).map(|(x, y)| x * y).sum();
            v.iter_mut().zip(b).for_each(|(x, y)| *x -= along * y);
        }
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > NEGLIGIBLE * before.max(1.0) {
            v.iter_mut().for_each(|x| *x /= length);
            basis.push(v);
            n_fixed += usize::from(k < n_fixed_given);
        }
    }
    basis.split_off(n_fixed)
}

/// Strain of a self-balanced change of the wheel forces of 1 kN, microstrain by gauge: one for each that their sum and moments leave free.
pub fn ground_patterns(frame: &StrainFrame) -> Vec<Vec<f64>> {
    let pattern = |w: &Vec<f64>| {
        let rows = frame.influence.chunks_exact(frame.n_columns());
        rows.map(|row| row.iter().zip(w).map(|(a, b)| a * b).sum())
            .collect()
    };
    warps(frame).iter().map(pattern).collect()
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
            unit: "kN",
            plausible: 4.0 * frame.usual_load(),
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
        "weigh every wheel where it stands, or turn the truck end for end on the same ground".into()
    }
}
