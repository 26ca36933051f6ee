//! Effects that explain a difference between simulated and measured static strain.
//!
//! Each effect has its own file: physics, parameters with plausible sizes, change of the prediction, extension of the model. The search treats all
//! effects in the same way. To add an effect, write its file and name it in [`library`]. A channel fault defines its change of a reading as a
//! [`channel_fault::ChannelFault`]; every other effect implements [`StrainEffect`].

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
pub use extension::{Correction, Extension, Nuisance, RecordedQuantity};
pub use library::{Candidate, library};
pub use model_discrepancy::ModelDiscrepancy;
pub use smooth_error::SmoothError;

use crate::reconcile::strain::{Part, StrainFrame, StrainState};

/// Stage between structure and reading at which an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Change of the influence matrix.
    Structure,
    /// Change of the loads that act.
    Loads,
    /// Change of the reading that a channel gives for a strain.
    Reading,
}

/// Kind of fault, which determines whether two faults may be at one gauge. Only a zero drift can be distinguished from another fault at the same
/// gauge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// Change of how the channel reads strain.
    Whole,
    /// Addition to the reading of the channel.
    Zero,
    /// Fault that hides every other fault of the channel.
    Silent,
}

impl FaultKind {
    /// Returns whether faults of the two kinds can be distinguished at one gauge.
    pub fn is_distinguishable_from(self, other: Self) -> bool {
        matches!(
            (self, other),
            (Self::Zero, Self::Whole) | (Self::Whole, Self::Zero)
        )
    }
}

/// General form of discrepancy, with the text that describes the gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Discrepancy {
    /// Noise with the same factor at all gauges: the stated noise is too small.
    Noise(&'static str),
    /// A form that is in no model and no channel of the library.
    Form(&'static str),
    /// A smooth error of the model: it is in no set while the search runs, and competes with the best set afterwards.
    Smooth(&'static str),
}

impl Discrepancy {
    /// Returns the text that describes the gap.
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
    /// Start values; several if the prediction is far from linear.
    pub starts: Vec<f64>,
    /// Largest plausible distance from the neutral value.
    pub plausible: f64,
}

/// A discrepancy with its physics.
pub trait StrainEffect: Send + Sync {
    /// Returns the id without the place, as in results.
    fn id(&self) -> &str;
    /// Returns the place: a gauge, a zone, `a+b`.
    fn place(&self) -> Option<String> {
        None
    }
    /// Returns the general form of discrepancy; `None` for an effect of the library.
    fn discrepancy(&self) -> Option<Discrepancy> {
        None
    }
    /// Returns the effect if it is a smooth error of the model.
    fn as_smooth_error(&self) -> Option<&SmoothError> {
        None
    }
    /// Returns the stage at which the effect acts.
    fn stage(&self) -> Stage;
    /// Returns the parameters common to all runs.
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
    /// Returns the amplitudes that differ from run to run.
    fn amplitudes(&self, _frame: &StrainFrame) -> Option<Amplitudes> {
        None
    }
    /// Returns the extension of the model that includes the effect.
    fn extension(&self, frame: &StrainFrame, parameters: &[f64]) -> Extension;
    /// Returns an instruction that separates the effect from another explanation.
    fn separate_by(&self, frame: &StrainFrame) -> String;
    /// Returns the gauges that the effect changes; empty unless it is limited to some gauges.
    fn gauges(&self) -> Vec<usize> {
        Vec::new()
    }
    /// Returns the runs that the effect changes; empty unless it is limited to some runs.
    fn runs(&self) -> Vec<usize> {
        Vec::new()
    }
    /// Returns the kind of fault, which determines whether another fault may be at the same gauge.
    fn kind(&self) -> FaultKind {
        FaultKind::Whole
    }
}

/// An effect with values for its parameters.
#[derive(Clone, Copy)]
pub struct Member<'a> {
    /// The effect.
    pub effect: &'a dyn StrainEffect,
    /// Parameters of the effect.
    pub parameters: &'a [f64],
}

/// Returns the full id, with the place.
pub fn full_id(effect: &dyn StrainEffect) -> String {
    match effect.place() {
        Some(place) => format!("{}:{place}", effect.id()),
        None => effect.id().to_string(),
    }
}
