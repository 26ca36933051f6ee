//! Reconciliation of simulation and measurement. It finds where they differ and identifies the missing effect. It then tests the effect, adds it to
//! the model and shows how much the gap falls.
//!
//! Strain and acceleration share one method. Observations are given by run and channel. The prediction can be evaluated with any set of active
//! effects. The covariance of the residual is from noise and stated model uncertainty. A library contains the effects. Their evidence leads to a
//! verdict.

mod cause;
mod checks;
pub mod effect;
mod effect_removal;
pub mod motion;
mod observation;
mod outcome;
mod rules;
mod search;
pub mod strain;

pub use cause::{Cause, CauseOutcome, CauseSet, evaluate_cause_sets};
pub use observation::Observations;
pub use outcome::{
    AlternativeExplanation, ChannelGap, DetectionLimit, Gap, GapBasis, GapNumbers, LoadShift,
    Misfit, NamedEffect, Outcome, SmoothAt, Verdict,
};
pub use rules::{MotionRules, Rule, StrainRules};
pub use search::{Addition, Breadth, ScoredSet, Scorer, search, search_near, settle};
