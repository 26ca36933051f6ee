//! Effects that can part simulation and measurement of static strain.
//!
//! Each effect is a file of its own: physics, parameters with plausible sizes, what it does to the prediction, what it adds to the model.
//! The search never asks which one it is. To add one: write its file, name it in [`library`]. A fault of channels says what it does to a
//! reading as a [`channel_fault::ChannelFault`]; everything else implements [`StrainEffect`].

mod amplitude;
mod card_gain;
pub mod channel_fault;
mod cross_sensitivity;
mod dead_channel;
mod extension;
mod gain_drift;
mod gauge_angle;
mod gauge_gain;
mod gauge_position;
mod gauge_swap;
mod global_scale;
mod intermittent_channel;
mod lateral_wheel_loads;
mod library;
mod model_discrepancy;
mod payload_gravity_missing;
mod payload_offset;
mod rosette_legs;
mod run_exchange;
mod run_record;
mod saturated_channel;
mod sign_flip;
mod smooth_error;
mod stiffness;
mod thermal;
mod unaccounted_mass;
mod uneven_ground;
mod wheel_scale;
mod zero_drift;

pub use amplitude::{Amplitudes, SizedAmplitudes};
pub use extension::{Correction, Extension, Noted, Nuisance};
pub use library::{Candidate, library};
pub use model_discrepancy::ModelDiscrepancy;
pub use smooth_error::SmoothError;

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

/// Whether two effects may sit on one gauge: two faults there are told as one, but a zero may drift besides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// It changes how the channel reads strain.
    Whole,
    /// It adds to what the channel reads.
    Zero,
    /// Nothing else shows through it.
    Silent,
}

impl FaultKind {
    /// Can the two be told apart on one gauge?
    pub fn besides(self, other: Self) -> bool {
        matches!(
            (self, other),
            (Self::Zero, Self::Whole) | (Self::Whole, Self::Zero)
        )
    }
}

/// What a general form of discrepancy says of the gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Discrepancy {
    /// Noise alike at all gauges: the stated noise is too small.
    Noise(&'static str),
    /// A form that is in no model and no channel of the library.
    Form(&'static str),
    /// A smooth error of the model: it joins no set while names are searched, and competes with the best of them.
    Smooth(&'static str),
}

impl Discrepancy {
    /// Its words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Noise(words) | Self::Form(words) | Self::Smooth(words) => words,
        }
    }
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
    fn id(&self) -> &str;
    /// The place: a gauge, a zone, `a+b`.
    fn place(&self) -> Option<String> {
        None
    }
    /// For a general form of discrepancy that is no effect of the library: what it says of the gap.
    fn discrepancy(&self) -> Option<Discrepancy> {
        None
    }
    /// The effect where it is a smooth error of the model.
    fn smooth(&self) -> Option<&SmoothError> {
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
    /// The runs it touches, where it touches only some.
    fn runs(&self) -> Vec<usize> {
        Vec::new()
    }
    /// Whether another fault may sit on the same gauge.
    fn kind(&self) -> FaultKind {
        FaultKind::Whole
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
