//! What the dynamic workflow has to say.

use super::change::Change;
use super::gap::{Proof, RecordGap};
use crate::finding::Finding;
use crate::reconcile::outcome::{Gap, Rival, Verdict};
use crate::vehicle::adjustment::Adjustment;

/// A named effect of motion.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionEffect {
    /// Id with place.
    pub id: String,
    /// Place alone.
    pub place: Option<String>,
    /// What it changes.
    pub change: Change,
    /// Sizes of its parameters.
    pub size: Vec<f64>,
    /// One sd of each.
    pub sigma: Vec<f64>,
    /// Unit of the first.
    pub unit: String,
    /// Whether the size is one that occurs.
    pub plausible: bool,
}

/// The smallest size of an effect that a record would have shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Smallest {
    /// Id with place.
    pub id: String,
    /// Size.
    pub size: f64,
    /// Unit.
    pub unit: String,
}

/// Everything.
#[derive(Clone, Debug)]
pub struct MotionOutcome {
    /// Verdict.
    pub verdict: Verdict,
    /// Named effects; empty unless named.
    pub effects: Vec<MotionEffect>,
    /// What came closest.
    pub best_attempt: Vec<MotionEffect>,
    /// Joint covariance of the sizes of what came closest, effects in order, by rows; empty where the channel itself says what is wrong.
    pub covariance: Vec<Vec<f64>>,
    /// Corrections of channels with the named effects in: those of the job and those found.
    pub corrections: Vec<Adjustment>,
    /// Other explanations, nearest first.
    pub rivals: Vec<Rival>,
    /// Log evidence of the best set less that of no effect.
    pub evidence: f64,
    /// Log evidence that names.
    pub decisive: f64,
    /// Gap on what judges.
    pub gap: Gap,
    /// What that was.
    pub judged_by: Proof,
    /// Gap there of the analyst's model by equation.
    pub before: Option<RecordGap>,
    /// With the best attempt in.
    pub after: Option<RecordGap>,
    /// Squared residual over noise alone, by number of rows: analyst's model, best attempt.
    pub reduced_chi2: [f64; 2],
    /// Share of the measured quantity left on the fitted record: analyst's model, best attempt, floor.
    pub left: [f64; 3],
    /// Smallest sizes that would have been seen.
    pub smallest: Vec<Smallest>,
    /// What remains, in words.
    pub remains: String,
    /// What would separate the first two explanations.
    pub next_measurement: String,
}

impl MotionOutcome {
    /// Withdraws the effects: a wrong input explains the gap, and no effect is looked for on top of it.
    pub fn refuse(&mut self, wrong: &Finding) {
        self.verdict = Verdict::Unknown;
        self.effects.clear();
        self.remains = format!(
            "An input is wrong. {}.",
            wrong.message.trim_end_matches('.')
        );
        self.next_measurement.clone_from(&wrong.remedy);
    }
}
