//! The library: one file per effect, with its physics, its parameters and a plausible size.
//!
//! An effect is known by what it does to the prediction; the search never asks which one it is. Others may add theirs: implement
//! [`StrainEffect`] and push it to the list of [`library`].

mod amplitude;
mod dead_channel;
mod extension;
mod gauge_angle;
mod gauge_gain;
mod gauge_position;
mod gauge_swap;
mod global_scale;
mod lateral_wheel_loads;
mod library;
mod payload_gravity_missing;
mod payload_offset;
mod rosette_legs;
mod saturated_channel;
mod sign_flip;
mod stiffness;
mod stranger;
mod thermal;
mod unaccounted_mass;
mod uneven_ground;
mod zero_drift;

pub use amplitude::Amplitudes;
pub use extension::Extension;
pub use library::{Candidate, library};

use crate::reconcile::strain::{Part, StrainFrame, StrainState};

/// Where in the chain from structure to number an effect sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// It changes the influence matrix.
    Structure,
    /// It changes what acts.
    Loads,
    /// It changes what a channel says of the strain.
    Reading,
}

/// A parameter of an effect, with its plausible size.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Unit for reports.
    pub unit: &'static str,
    /// Value without the effect.
    pub neutral: f64,
    /// Prior standard deviation about the neutral value.
    pub prior_sd: f64,
    /// A step for numerical derivatives, small against the prior.
    pub step: f64,
    /// Values to start from: where the prediction is far from linear, several.
    pub starts: Vec<f64>,
    /// Beyond this distance from neutral a value is not plausible.
    pub plausible: f64,
}

/// A discrepancy with its physics.
pub trait StrainEffect: Send + Sync {
    /// Id without the place, as in results.
    fn id(&self) -> &'static str;
    /// The place: a gauge, a zone, `a+b`.
    fn place(&self) -> Option<String> {
        None
    }
    /// For a general form that is no effect of the library: what it says of the gap.
    fn outside(&self) -> Option<&'static str> {
        None
    }
    /// Where it acts.
    fn stage(&self) -> Stage;
    /// Parameters common to all runs.
    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }
    /// Changes structure or loads.
    fn alter(&self, _frame: &StrainFrame, _parameters: &[f64], _state: &mut StrainState) {}
    /// Changes the readings of one run, a row of gauges.
    fn read(
        &self,
        _frame: &StrainFrame,
        _parameters: &[f64],
        _run: usize,
        _row: &mut [f64],
        _part: Part,
    ) {
    }
    /// Amplitudes that differ from run to run.
    fn amplitudes(&self, _frame: &StrainFrame) -> Option<Amplitudes> {
        None
    }
    /// What the model must be given for the effect to be in it.
    fn extension(&self, frame: &StrainFrame, parameters: &[f64]) -> Extension;
    /// What separates it from another explanation, as an instruction.
    fn separate_by(&self, frame: &StrainFrame) -> String;
    /// The gauges it touches, where it touches only some.
    fn gauges(&self) -> Vec<usize> {
        Vec::new()
    }
}

/// An effect with values for its parameters.
#[derive(Clone, Copy)]
pub struct Member<'a> {
    /// The effect.
    pub effect: &'a dyn StrainEffect,
    /// Its parameters.
    pub parameters: &'a [f64],
}

/// Full id, with the place.
pub fn full_id(effect: &dyn StrainEffect) -> String {
    match effect.place() {
        Some(place) => format!("{}:{place}", effect.id()),
        None => effect.id().to_string(),
    }
}

fn gauge_name(frame: &StrainFrame, gauge: usize) -> String {
    frame
        .gauges
        .get(gauge)
        .map(|g| g.name.clone())
        .unwrap_or_default()
}
