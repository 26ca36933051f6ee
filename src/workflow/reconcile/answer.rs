//! What `reconcile` answers: one type, whether strain, motion or causes were compared. What one of them alone has is `None` for the others.

use super::added::Added;
use super::extended::ExtendedModel;
use super::marked::MarkedStiffness;
use crate::host::outcome::Answer;
use crate::job::Job;
use crate::reconcile::motion::gap::Proof;
use crate::reconcile::motion::sits::GapSits;
use crate::reconcile::motion::{MotionFrame, MotionOutcome, SimulatedGap};
use crate::reconcile::strain::StrainFrame;
use crate::reconcile::{
    CauseOutcome, GapNumbers, Misfit, Outcome as StrainOutcome, SmoothAt, Verdict,
};
use crate::strain_chain::Fields;
use crate::vehicle::identify::Identification;
use crate::vehicle::motion::Motion;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::path::Path;

/// Where simulation and measurement disagree, which effect is missing, and the model with the effect in it.
#[derive(Serialize)]
pub struct Reconciled {
    /// The verdict.
    #[serde(serialize_with = "as_word")]
    pub verdict: Verdict,
    /// Ids of the named effects or causes.
    pub named: Vec<String>,
    /// Named effects; empty unless named.
    pub effects: Vec<EffectFound>,
    /// What came closest; `None` for causes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best_attempt: Option<Vec<EffectFound>>,
    /// Other explanations, nearest first.
    pub rivals: Vec<RivalFound>,
    /// How far apart they are on what was not fitted.
    pub gap: GapFound,
    /// Log evidence of the named set (or best attempt) less that of no effect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub evidence: Option<f64>,
    /// Squared residual over what is allowed for, by number of readings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reduced_chi2: Option<ReducedChi2>,
    /// What remains, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remains: Option<String>,
    /// What would separate the first two explanations.
    pub next_measurement: String,
    /// Smallest sizes that would have been seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detectable: Option<Vec<DetectableSize>>,
    /// What only strain has.
    #[serde(flatten)]
    pub strain: Option<StrainPart>,
    /// What only motion has.
    #[serde(flatten)]
    pub motion: Option<MotionPart>,
    /// Causes measured in every run, weighed.
    #[serde(skip)]
    pub causes: Option<CauseOutcome>,
    /// What was added to the model: path, old and new value.
    pub added: Vec<Added>,
    /// The job with the named effects in it; `None` where nothing was named or an effect can't be put into it.
    pub extended_model: Option<ExtendedModel>,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for Reconciled {
    const COMMAND: &'static str = "reconcile";
    const RESULT: &'static str = "The comparison";

    fn verdict(&self) -> String {
        self.sentence()
    }
}

impl Reconciled {
    /// Tells the extended model into which folder the answer will be written: its path is then one from the folder of the caller.
    pub fn put_into(&mut self, folder: &Path) {
        if let Some(extended) = &mut self.extended_model {
            extended.put_into(folder);
        }
    }
}

/// A named effect or cause.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectFound {
    /// Id with place.
    pub id: String,
    /// Place alone.
    #[serde(rename = "where")]
    pub place: Option<String>,
    /// Its size; `None` for a cause.
    #[serde(flatten)]
    pub size: Option<SizeFound>,
    /// Is the size one that occurs?
    pub plausible: bool,
    /// By channel, what a cause does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channels: Option<BTreeMap<String, SlopeFound>>,
}

/// Size of an effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SizeFound {
    /// The first parameter; of a fault without one -1 for a turned sign, 0 for a channel that says nothing, 1 for an exchange.
    pub size: Option<f64>,
    /// One standard deviation of the first parameter.
    pub sigma: Option<f64>,
    /// Unit.
    pub unit: String,
    /// All parameters (of a kind of amplitude: its root mean square over runs).
    pub sizes: Vec<f64>,
    /// One standard deviation of each.
    pub sigmas: Vec<f64>,
}

/// What a channel does under a cause.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SlopeFound {
    /// Change of the reading per unit of the cause.
    pub per_unit: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// Another explanation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RivalFound {
    /// Ids with places, joined by ` + `.
    pub id: String,
    /// Places, joined by ` + `; `None` for causes.
    #[serde(rename = "where")]
    pub place: Option<String>,
    /// Log evidence of the named set less that of this one.
    pub evidence_difference: f64,
    /// Gap that it leaves.
    pub gap_after: f64,
    /// These data can't tell it from what was named.
    pub indistinguishable: bool,
}

/// The gap on what was not fitted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GapFound {
    /// What is measured by it.
    pub metric: String,
    /// Of the analyst's model.
    pub before: f64,
    /// With the named effects.
    pub after: f64,
    /// What noise and stated uncertainty leave.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor: Option<f64>,
    /// (before^2 - after^2) / (before^2 - floor^2); zero where there is nothing to close.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explained_share: Option<f64>,
    /// What only strain has.
    #[serde(flatten)]
    pub strain: Option<StrainGap>,
    /// What a gap of motion was judged on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub judged_by: Option<Proof>,
}

/// What a gap of strain has besides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StrainGap {
    /// Which runs it is judged on.
    pub basis: &'static str,
    /// What the mesh alone makes; `None` where no finer one was solved.
    pub mesh: Option<f64>,
    /// The same with the errors of the noted wheel loads found anew in every run.
    pub loads_found: Option<GapNumbers>,
}

/// Reduced chi-square.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReducedChi2 {
    /// What was fitted, the analyst's model.
    pub before: f64,
    /// What was fitted, effects in.
    pub after: f64,
    /// Held-out runs, effects in; strain alone, and only where runs were held out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held_out: Option<f64>,
}

/// The smallest size of an effect that these data would show.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DetectableSize {
    /// Id with place.
    pub id: String,
    /// Size.
    pub size: f64,
    /// Unit.
    pub unit: String,
}

/// What only strain has.
#[derive(Serialize)]
pub struct StrainPart {
    /// Of 100 drawings of the runs, those whose best set holds every name.
    pub wins_of_100: usize,
    /// Noise that the readings show over the stated one.
    pub noise_factor: f64,
    /// The curve of a smooth error of the model, where one explains these data as well as any names.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub smooth: Vec<SmoothAt>,
    /// Joint covariance of the parameters of the named set (or best attempt), by rows.
    pub covariance: Vec<Vec<f64>>,
    /// Where the gap sits, in words.
    pub sits: String,
    /// Gauges beyond their own floor before any effect, worst first.
    pub gauges_off_before: Vec<Misfit>,
    /// Gauges beyond their own floor after.
    pub gauges_off: Vec<Misfit>,
    /// Runs beyond the floor after.
    pub runs_off: Vec<Misfit>,
    /// All that was found.
    #[serde(skip)]
    pub outcome: StrainOutcome,
    /// What was given.
    #[serde(skip)]
    pub frame: StrainFrame,
    /// What the model predicts as it was given, microstrain, `n_runs x n_gauges`.
    #[serde(skip)]
    pub predicted: Vec<f64>,
    /// The same with the named effects (or best attempt) in, but for what differs from run to run.
    #[serde(skip)]
    pub predicted_after: Vec<f64>,
    /// Deck and strain fields; `None` where S was given.
    #[serde(skip)]
    pub fields: Option<Fields>,
    /// Where the stiffnesses of the named set (or best attempt) lie on the deck's model.
    #[serde(skip)]
    pub marked: Vec<MarkedStiffness>,
}

/// What only motion has.
#[derive(Serialize)]
pub struct MotionPart {
    /// Where the gap of the analyst's model is largest, in words.
    pub sits: String,
    /// By equation: in which band, when and at which size of the motion it is largest.
    pub sits_at: Vec<GapSits>,
    /// The same with the named effects (or best attempt) in.
    pub sits_after: Vec<GapSits>,
    /// Joint covariance of the sizes of the named set (or best attempt), by rows.
    pub covariance: Vec<Vec<f64>>,
    /// Measured wheel forces: what `identify` leaves over.
    pub wheel_force: Vec<WheelMisfit>,
    /// Both models simulated; `None` where nothing was named.
    pub simulation: Option<Simulation>,
    /// All that was found.
    #[serde(skip)]
    pub outcome: MotionOutcome,
    /// What was given.
    #[serde(skip)]
    pub frame: MotionFrame,
    /// The analyst's vehicle as identified, with its motion over the fitted record.
    #[serde(skip)]
    pub identified: Option<(Identification, Motion)>,
}

/// Misfit of a measured wheel force where `identify` judges it, as a share of its RMS.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WheelMisfit {
    /// Channel.
    pub channel: String,
    /// By the analyst's model.
    pub before: f64,
    /// With the named effects.
    pub after: Option<f64>,
}

/// Simulation of what was named.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Simulation {
    /// Both models over the record that judges.
    Done(SimulationFound),
    /// Why it can't be done.
    NotDone {
        /// A sentence.
        not_simulated: String,
    },
}

impl Simulation {
    /// What it gave.
    pub fn done(&self) -> Option<&SimulationFound> {
        match self {
            Self::Done(found) => Some(found),
            Self::NotDone { .. } => None,
        }
    }
}

/// Both models simulated over the held-out record, else over the fitted one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulationFound {
    /// What is measured by it.
    pub metric: String,
    /// What both models were simulated on.
    pub judged_by: Proof,
    /// By sensor.
    pub channels: Vec<SimulatedRow>,
    /// Parameters of the named model.
    pub parameters: Vec<SimulatedParameter>,
}

/// Error of simulation of one sensor, RMS in its unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulatedRow {
    /// Channel.
    pub channel: String,
    /// RMS of what was measured.
    pub measured_rms: f64,
    /// Of the analyst's model.
    pub before: f64,
    /// Of the named one.
    pub after: f64,
}

/// A parameter by both ways.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulatedParameter {
    /// Name.
    pub name: String,
    /// By regression.
    pub by_regression: f64,
    /// By simulation.
    pub by_simulation: f64,
}

impl From<SimulatedGap> for SimulationFound {
    fn from(found: SimulatedGap) -> Self {
        let row = |c: crate::reconcile::motion::SimulatedChannel| SimulatedRow {
            channel: c.channel,
            measured_rms: c.measured,
            before: c.before,
            after: c.after,
        };
        let parameter = |(name, by_regression, by_simulation)| SimulatedParameter {
            name,
            by_regression,
            by_simulation,
        };
        Self {
            metric: format!(
                "RMS of measured less simulated on {}, in the unit of the channel; both models fitted by simulation",
                found.judged_by.words()
            ),
            judged_by: found.judged_by,
            channels: found.channels.into_iter().map(row).collect(),
            parameters: found.parameters.into_iter().map(parameter).collect(),
        }
    }
}

/// The first of a list where it is a number.
pub(super) fn first(list: &[f64]) -> Option<f64> {
    list.first().copied().filter(|x| x.is_finite())
}

impl From<&crate::reconcile::Rival> for RivalFound {
    fn from(r: &crate::reconcile::Rival) -> Self {
        let place = |id: &String| id.split_once(':').map(|p| p.1.to_owned());
        let places: Vec<String> = r.ids.iter().filter_map(place).collect();
        Self {
            id: r.ids.join(" + "),
            place: Some(places.join(" + ")),
            evidence_difference: r.evidence_difference,
            gap_after: r.gap_after,
            indistinguishable: r.indistinguishable,
        }
    }
}

fn as_word<S: Serializer>(verdict: &Verdict, s: S) -> Result<S::Ok, S::Error> {
    s.serialize_str(verdict.word())
}
