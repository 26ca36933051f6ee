//! Outcome of the dynamic workflow.

use super::change::Change;
use super::gap::{Proof, RecordGap};
use crate::finding::Finding;
use crate::reconcile::outcome::{AlternativeExplanation, Gap, Verdict};
use crate::vehicle::adjustment::Adjustment;

/// A named effect of motion.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionEffect {
    /// Id with place.
    pub id: String,
    /// Place without the id.
    pub place: Option<String>,
    /// Change of the vehicle or of a channel.
    pub change: Change,
    /// Sizes of the parameters of the effect.
    pub size: Vec<f64>,
    /// One sd of each size.
    pub sigma: Vec<f64>,
    /// Unit of the first size.
    pub unit: String,
    /// Whether the size is plausible.
    pub plausible: bool,
}

/// The smallest size of an effect that a record would have shown.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionDetectionLimit {
    /// Id with place.
    pub id: String,
    /// Size.
    pub size: f64,
    /// Unit.
    pub unit: String,
}

/// Outcome of the dynamic workflow: verdict, effects, gaps and the next measurement.
#[derive(Clone, Debug)]
pub struct MotionOutcome {
    /// Verdict.
    pub verdict: Verdict,
    /// Named effects. Empty unless the verdict is `named`.
    pub effects: Vec<MotionEffect>,
    /// Effects of the best attempt.
    pub best_attempt: Vec<MotionEffect>,
    /// Joint covariance of the sizes of the best attempt, effects in order, by rows; empty if the readings of a channel show its fault.
    pub covariance: Vec<Vec<f64>>,
    /// Corrections of channels with the named effects included: corrections of the job and corrections found.
    pub corrections: Vec<Adjustment>,
    /// Other explanations, nearest first.
    pub rivals: Vec<AlternativeExplanation>,
    /// Log evidence of the best set minus the log evidence without effects.
    pub evidence: f64,
    /// Log evidence needed to name an effect.
    pub decisive: f64,
    /// Gap on the test data.
    pub gap: Gap,
    /// Test data of the gap.
    pub judged_by: Proof,
    /// Gap of the analyst's model on the test data, by equation.
    pub before: Option<RecordGap>,
    /// Gap of the best attempt on the test data, by equation.
    pub after: Option<RecordGap>,
    /// Squared residual over noise alone, by number of rows: analyst's model, best attempt.
    pub reduced_chi2: [f64; 2],
    /// Residual share of the measured quantity on the fitted record: analyst's model, best attempt, expected residual.
    pub left: [f64; 3],
    /// Smallest sizes that the record would have shown.
    pub smallest: Vec<MotionDetectionLimit>,
    /// Text on the remaining gap.
    pub remains: String,
    /// Instruction that separates the first two explanations.
    pub next_measurement: String,
}

impl MotionOutcome {
    /// Removes the effects. A wrong input explains the gap, and no further effect is searched for.
    pub fn refuse(&mut self, wrong: &Finding) {
        self.verdict = Verdict::Unknown;
        self.effects.clear();
        self.remains = format!("An input is wrong. {}.", wrong.clause());
        self.next_measurement.clone_from(&wrong.remedy);
    }
}
