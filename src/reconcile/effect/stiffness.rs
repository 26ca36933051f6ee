//! `rail_stiffness`, `joint_stiffness`, `local_stiffness`: a zone, a joint or a small region stiffer or softer than modelled. Also changes of the
//! structure that the user described.

use super::{Extension, Parameter, Stage, StrainEffect};
use crate::reconcile::strain::{StiffnessOf, StiffnessSignature, StrainFrame, StrainState};

/// Influence = influence + change(size), from solutions of the changed model, interpolated between them.
#[derive(Clone, Debug)]
pub struct Stiffness {
    /// Index into the frame's signatures.
    pub signature: usize,
    /// Kind of change: zone, joint, small region, or change that the user described.
    pub of: StiffnessOf,
    /// Zone, joint, element or grid. For a described change it is the id of the change.
    pub name: String,
    /// Prior standard deviation of the size.
    pub prior: f64,
}

impl Stiffness {
    /// Returns one effect for every signature of zones, joints and regions.
    pub fn list_effects(frame: &StrainFrame) -> Vec<Self> {
        Self::where_it(frame, |of| of != StiffnessOf::Described)
    }

    /// Returns one effect for every change that the user described.
    pub fn list_described_effects(frame: &StrainFrame) -> Vec<Self> {
        Self::where_it(frame, |of| of == StiffnessOf::Described)
    }

    fn where_it(frame: &StrainFrame, wanted: impl Fn(StiffnessOf) -> bool) -> Vec<Self> {
        let one = |(signature, s): (usize, &StiffnessSignature)| Self {
            signature,
            of: s.of,
            name: s.place.clone(),
            prior: s.prior_percent,
        };
        frame
            .stiffness
            .iter()
            .enumerate()
            .filter(|(_, s)| wanted(s.of))
            .map(one)
            .collect()
    }
}

/// Returns the weights of the known sizes at `size`, by the polynomial through zero and all known sizes (Lagrange). Beyond the outermost known size,
/// the weights are on the straight line through zero and this size, since a polynomial is unreliable there.
fn weights(sizes: &[f64], size: f64) -> Vec<f64> {
    let outermost = sizes
        .iter()
        .copied()
        .filter(|s| s * size > 0.0)
        .max_by(|a, b| a.abs().total_cmp(&b.abs()));
    if let Some(last) = outermost.filter(|last| size.abs() > last.abs()) {
        return sizes
            .iter()
            .map(|s| if *s == last { size / last } else { 0.0 })
            .collect();
    }
    let weight = |i: usize| {
        let mut w = size / sizes[i];
        for (_, &other) in sizes.iter().enumerate().filter(|(j, _)| *j != i) {
            w *= (size - other) / (sizes[i] - other);
        }
        w
    };
    (0..sizes.len()).map(weight).collect()
}

impl StrainEffect for Stiffness {
    fn id(&self) -> &str {
        match self.of {
            StiffnessOf::Zone => "rail_stiffness",
            StiffnessOf::Joint => "joint_stiffness",
            StiffnessOf::Local => "local_stiffness",
            StiffnessOf::Described => &self.name,
        }
    }
    fn place(&self) -> Option<String> {
        (self.of != StiffnessOf::Described).then(|| self.name.clone())
    }
    fn stage(&self) -> Stage {
        Stage::Structure
    }
    fn parameters(&self) -> Vec<Parameter> {
        let (unit, step) = match self.of {
            StiffnessOf::Zone => ("percent", 0.5),
            StiffnessOf::Joint | StiffnessOf::Local => ("percent (natural log times 100)", 0.5),
            StiffnessOf::Described => ("1", 0.01 * self.prior),
        };
        // Four times the prior corresponds to a plate of half or one and a half times its thickness, or a joint twenty times as stiff.
        let plausible = 4.0 * self.prior;
        vec![Parameter {
            unit,
            neutral: 0.0,
            prior_sd: self.prior,
            step,
            starts: vec![0.0],
            plausible,
        }]
    }
    fn alter(&self, frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let (Some(&size), Some(signature)) =
            (parameters.first(), frame.stiffness.get(self.signature))
        else {
            return;
        };
        let sizes: Vec<f64> = signature.at_percent.iter().map(|p| p.0).collect();
        for (w, (_, change)) in weights(&sizes, size).iter().zip(&signature.at_percent) {
            for (cell, d) in state.influence.iter_mut().zip(change) {
                *cell += w * d;
            }
        }
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        let percent = parameters.first().copied().unwrap_or(0.0);
        let place = self.name.clone();
        match self.of {
            StiffnessOf::Zone => Extension::ZoneStiffness { place, percent },
            StiffnessOf::Joint => Extension::JointStiffness { place, percent },
            StiffnessOf::Local => Extension::LocalStiffness { place, percent },
            StiffnessOf::Described => Extension::Described {
                id: place,
                size: percent,
            },
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        match self.of {
            StiffnessOf::Zone => format!(
                "measure the thickness at {0}, or add one gauge inside and one gauge outside this zone",
                self.name
            ),
            StiffnessOf::Joint => {
                format!(
                    "measure the relative displacement of the two sides of joint {} under load",
                    self.name
                )
            }
            StiffnessOf::Local => format!(
                "inspect {} for a crack or a loose joint, and add a gauge on either side of it",
                self.name
            ),
            StiffnessOf::Described => format!("check whether {} exists", self.name),
        }
    }
}
