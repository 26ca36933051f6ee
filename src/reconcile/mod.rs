//! Find where simulation and measurement disagree, name the missing effect, judge, add it, show the gap shrink.
//!
//! One frame for strain and acceleration: observations by run and channel, a prediction that can be evaluated again with any effect
//! on, a covariance of what noise and stated model uncertainty leave, a library of effects, evidence, a verdict.

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

pub use cause::{Cause, CauseOutcome, CauseSet, weigh_causes};
pub use observation::Observations;
pub use outcome::{
    ChannelGap, DetectionLimit, Gap, GapBasis, GapNumbers, LoadShift, Misfit, NamedEffect, Outcome,
    Rival, SmoothAt, Verdict,
};
pub use rules::{MotionRules, Rule, StrainRules};
pub use search::{Addition, Breadth, ScoredSet, Scorer, search, search_near, settle};
