//! `rail_stiffness`, `joint_stiffness`: a zone or a joint stiffer or softer than modelled.

use super::{Extension, Parameter, Stage, StrainEffect};
use crate::reconcile::strain::{StrainFrame, StrainState};

/// Influence = influence + change(size), from solutions of the changed model, interpolated between them.
#[derive(Clone, Debug)]
pub struct Stiffness {
    /// Index into the frame's signatures.
    pub signature: usize,
    /// `rail_stiffness` or `joint_stiffness`.
    pub id: &'static str,
    /// Zone or joint.
    pub name: String,
    /// Prior standard deviation of its size.
    pub prior_percent: f64,
}

impl Stiffness {
    /// One for every signature.
    pub fn all(frame: &StrainFrame) -> Vec<Self> {
        let named = frame.stiffness.iter().enumerate().map(|(signature, s)| {
            let (id, place) = s.id.split_once(':').unwrap_or((&s.id, ""));
            let id = if id == "joint_stiffness" {
                "joint_stiffness"
            } else {
                "rail_stiffness"
            };
            Self {
                signature,
                id,
                name: place.to_string(),
                prior_percent: s.prior_percent,
            }
        });
        named.collect()
    }
}

/// Weights of the known sizes at `percent`: the polynomial through zero and all of them (Lagrange).
fn weights(sizes: &[f64], percent: f64) -> Vec<f64> {
    let weight = |i: usize| {
        let mut w = percent / sizes[i];
        for (j, &other) in sizes.iter().enumerate().filter(|(j, _)| *j != i) {
            debug_assert!(i != j);
            w *= (percent - other) / (sizes[i] - other);
        }
        w
    };
    (0..sizes.len()).map(weight).collect()
}

impl StrainEffect for Stiffness {
    fn id(&self) -> &'static str {
        self.id
    }
    fn place(&self) -> Option<String> {
        Some(self.name.clone())
    }
    fn stage(&self) -> Stage {
        Stage::Structure
    }
    fn parameters(&self) -> Vec<Parameter> {
        // Four times the prior: a plate of half or one and a half times its thickness, a joint twenty times as stiff.
        vec![Parameter {
            unit: if self.id == "joint_stiffness" {
                "percent (natural log times 100)"
            } else {
                "percent"
            },
            neutral: 0.0,
            prior_sd: self.prior_percent,
            step: 0.5,
            starts: vec![0.0],
            plausible: 4.0 * self.prior_percent,
        }]
    }
    fn alter(&self, frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let (Some(&percent), Some(signature)) =
            (parameters.first(), frame.stiffness.get(self.signature))
        else {
            return;
        };
        let sizes: Vec<f64> = signature.at_percent.iter().map(|p| p.0).collect();
        for (w, (_, change)) in weights(&sizes, percent).iter().zip(&signature.at_percent) {
            for (cell, d) in state.influence.iter_mut().zip(change) {
                *cell += w * d;
            }
        }
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        let percent = parameters.first().copied().unwrap_or(0.0);
        Extension::Stiffness {
            id: self.id,
            place: self.name.clone(),
            percent,
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        if self.id == "joint_stiffness" {
            return format!(
                "measure how far the two sides of joint {} move against each other under load",
                self.name
            );
        }
        format!(
            "measure the thickness at {}, or add a gauge inside and one outside that zone",
            self.name
        )
    }
}
