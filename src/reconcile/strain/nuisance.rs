//! Loads that are estimated separately in every run: nuisance loads of the model, and ground that is not flat.

use super::frame::StrainFrame;
use crate::reconcile::effect::{Amplitudes, SizedAmplitudes};

impl StrainFrame {
    /// Returns the nuisance loads and the ground of the model as amplitudes of their stated sizes. The part that repeats in all runs may be as large
    /// as the part that differs from run to run.
    pub fn nuisance_amplitudes(&self) -> Option<SizedAmplitudes> {
        let mut sizes: Vec<f64> = self.nuisance.iter().map(|n| n.size).collect();
        let mut patterns: Vec<Vec<f64>> =
            self.nuisance.iter().map(|n| n.per_unit.clone()).collect();
        let mut kinds: Vec<usize> = (0..sizes.len()).collect();
        if self.ground > 0.0 {
            let ground = ground_patterns(self);
            kinds.extend(ground.iter().map(|_| sizes.len()));
            // Usual size of all ground patterns together, since a road rarely changes all of them at once.
            sizes.push(self.ground * (ground.len() as f64).sqrt());
            patterns.extend(ground);
        }
        if patterns.is_empty() {
            return None;
        }
        let amplitudes = Amplitudes {
            patterns,
            kinds,
            usual: sizes.clone(),
            steady: sizes.clone(),
            correlation: 0.0,
            unit: "1",
            plausible: vec![f64::INFINITY; sizes.len()],
        };
        Some(SizedAmplitudes {
            amplitudes,
            sizes: [sizes.as_slice(), &sizes].concat(),
        })
    }
}

/// Returns the constraints on a change of wheel forces: it leaves their sum unchanged, and their moments as far as the wheel positions are known.
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
        // If the names only state the side (LF, RF), the only pattern is the moment about the longitudinal axis.
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

/// Returns an orthonormal basis of the forces that satisfy the constraints (Gram-Schmidt).
fn warps(frame: &StrainFrame) -> Vec<Vec<f64>> {
    /// Length below which a vector depends linearly on the basis, relative to the larger of its original length and 1.
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

/// Returns the strain of each independent self-balanced change of the wheel forces of 1 kN, microstrain by gauge.
pub fn ground_patterns(frame: &StrainFrame) -> Vec<Vec<f64>> {
    let pattern = |w: &Vec<f64>| {
        let rows = frame.influence.chunks_exact(frame.n_columns());
        rows.map(|row| row.iter().zip(w).map(|(a, b)| a * b).sum())
            .collect()
    };
    warps(frame).iter().map(pattern).collect()
}
