//! Answer of `reconcile`: one type for strain, motion and causes. Fields of one kind only are `None` for the other kinds.

use super::extended_model::ExtendedModel;
use super::marked_stiffness::MarkedStiffness;
use super::model_changes::ModelChange;
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

/// Places where simulation and measurement disagree, the missing effects, and the model with these effects.
#[derive(Serialize)]
pub struct Reconciliation {
    /// The verdict.
    #[serde(serialize_with = "as_word")]
    pub verdict: Verdict,
    /// Ids of the named effects or causes.
    pub named: Vec<String>,
    /// Named effects; empty unless named.
    pub effects: Vec<EffectFound>,
    /// Closest explanation that was tried; `None` for causes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best_attempt: Option<Vec<EffectFound>>,
    /// Other explanations, nearest first.
    pub rivals: Vec<AlternativeSummary>,
    /// Difference between model and measurement on data that were not fitted.
    pub gap: GapFound,
    /// Log evidence of the named set (or best attempt) minus the log evidence of no effect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub evidence: Option<f64>,
    /// Squared residual over the allowed variance, per reading.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reduced_chi2: Option<ReducedChi2>,
    /// Description of the residual after the named effects.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remains: Option<String>,
    /// Measurement that would separate the first two explanations.
    pub next_measurement: String,
    /// Smallest sizes that would have been seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detectable: Option<Vec<DetectableSize>>,
    /// Results for strain only.
    #[serde(flatten)]
    pub strain: Option<StrainPart>,
    /// Results for motion only.
    #[serde(flatten)]
    pub motion: Option<MotionPart>,
    /// Comparison of the causes that are measured in every run.
    #[serde(skip)]
    pub causes: Option<CauseOutcome>,
    /// Changes of the model: path, old and new value.
    pub added: Vec<ModelChange>,
    /// The job with the named effects; `None` if no effect was named or an effect can't be added to it.
    pub extended_model: Option<ExtendedModel>,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for Reconciliation {
    const COMMAND: &'static str = "reconcile";
    const RESULT: &'static str = "The comparison";

    fn verdict(&self) -> String {
        self.sentence()
    }
}

impl Reconciliation {
    /// Sets the folder into which the answer is written. The path of the extended model is then given from the folder of the caller.
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
    /// Place without the id.
    #[serde(rename = "where")]
    pub place: Option<String>,
    /// Size of the effect; `None` for a cause.
    #[serde(flatten)]
    pub size: Option<SizeFound>,
    /// Whether such a size occurs in practice.
    pub plausible: bool,
    /// Response to a cause, by channel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channels: Option<BTreeMap<String, SlopeFound>>,
}

/// Size of an effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SizeFound {
    /// First parameter. For a fault without a parameter: -1 for reversed polarity, 0 for a dead channel, 1 for an exchange.
    pub size: Option<f64>,
    /// One standard deviation of the first parameter.
    pub sigma: Option<f64>,
    /// Unit.
    pub unit: String,
    /// All parameters. For a kind of amplitude it is the root mean square over runs.
    pub sizes: Vec<f64>,
    /// One standard deviation of each parameter.
    pub sigmas: Vec<f64>,
}

/// Response of a channel to a cause.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SlopeFound {
    /// Change of the reading per unit of the cause.
    pub per_unit: f64,
    /// Standard deviation of `per_unit`.
    pub sigma: f64,
}

/// Another explanation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlternativeSummary {
    /// Ids with places, joined by ` + `.
    pub id: String,
    /// Places, joined by ` + `; `None` for causes.
    #[serde(rename = "where")]
    pub place: Option<String>,
    /// Log evidence of the named set minus the log evidence of this explanation.
    pub evidence_difference: f64,
    /// Gap with this explanation.
    pub gap_after: f64,
    /// Whether these data can't distinguish this explanation from the named one.
    pub indistinguishable: bool,
}

/// Gap on data that were not fitted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GapFound {
    /// Definition of the gap.
    pub metric: String,
    /// Gap of the analyst's model.
    pub before: f64,
    /// Gap with the named effects.
    pub after: f64,
    /// Expected gap from noise and stated uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor: Option<f64>,
    /// (before^2 - after^2) / (before^2 - floor^2); zero if there is no gap to close.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explained_share: Option<f64>,
    /// Results for strain only.
    #[serde(flatten)]
    pub strain: Option<StrainGap>,
    /// Kind of data on which a gap of motion was tested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub judged_by: Option<Proof>,
}

/// Further numbers on a gap of strain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StrainGap {
    /// Kind of runs on which the gap is tested.
    pub basis: &'static str,
    /// Gap from the mesh alone; `None` if no finer mesh was solved.
    pub mesh: Option<f64>,
    /// Gaps with the errors of the recorded wheel loads estimated again in every run.
    pub loads_found: Option<GapNumbers>,
}

/// Reduced chi-square.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReducedChi2 {
    /// Fitted data, analyst's model.
    pub before: f64,
    /// Fitted data, model with the effects.
    pub after: f64,
    /// Gap on held-out runs, for the model with the effects. Only for strain, and only if runs were held out.
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

/// Results for strain only.
#[derive(Serialize)]
pub struct StrainPart {
    /// Number of resampled run sets, out of 100, whose best explanation contains every named effect.
    pub wins_of_100: usize,
    /// Noise of the readings over the stated noise.
    pub noise_factor: f64,
    /// Curve of a smooth error of the model, if one explains these data as well as any named effects.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub smooth: Vec<SmoothAt>,
    /// Joint covariance of the parameters of the named set (or best attempt), by rows.
    pub covariance: Vec<Vec<f64>>,
    /// Description of where the gap is.
    pub sits: String,
    /// Gauges beyond their own floor before any effect, worst first.
    pub gauges_off_before: Vec<Misfit>,
    /// Gauges beyond their own floor after the effects.
    pub gauges_off: Vec<Misfit>,
    /// Runs beyond the floor after the effects.
    pub runs_off: Vec<Misfit>,
    /// Complete outcome of the comparison.
    #[serde(skip)]
    pub outcome: StrainOutcome,
    /// Inputs of the comparison.
    #[serde(skip)]
    pub frame: StrainFrame,
    /// Predictions of the given model, microstrain, `n_runs x n_gauges`.
    #[serde(skip)]
    pub predicted: Vec<f64>,
    /// Predictions with the named effects (or best attempt), without their parts that differ from run to run, microstrain, `n_runs x n_gauges`.
    #[serde(skip)]
    pub predicted_after: Vec<f64>,
    /// Deck and strain fields. `None` if S was given.
    #[serde(skip)]
    pub fields: Option<Fields>,
    /// Positions of the stiffnesses of the named set (or best attempt) on the deck's model.
    #[serde(skip)]
    pub marked: Vec<MarkedStiffness>,
}

/// Results for motion only.
#[derive(Serialize)]
pub struct MotionPart {
    /// Description of where the gap of the analyst's model is largest.
    pub sits: String,
    /// Band, time and size of the motion at which the gap is largest, for each equation.
    pub sits_at: Vec<GapSits>,
    /// Band, time and size of the motion at which the gap is largest, for each equation, with the named effects (or best attempt).
    pub sits_after: Vec<GapSits>,
    /// Joint covariance of the sizes of the named set (or best attempt), by rows.
    pub covariance: Vec<Vec<f64>>,
    /// Measured wheel forces: residual of `identify`.
    pub wheel_force: Vec<WheelMisfit>,
    /// Simulation of both models; `None` if no effect was named.
    pub simulation: Option<Simulation>,
    /// Complete outcome of the comparison.
    #[serde(skip)]
    pub outcome: MotionOutcome,
    /// Inputs of the comparison.
    #[serde(skip)]
    pub frame: MotionFrame,
    /// The analyst's vehicle as identified, with its motion over the fitted record.
    #[serde(skip)]
    pub identified: Option<(Identification, Motion)>,
}

/// Misfit of a measured wheel force under `identify`, as a share of its RMS.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WheelMisfit {
    /// Channel.
    pub channel: String,
    /// Misfit with the analyst's model.
    pub before: f64,
    /// Misfit with the named effects.
    pub after: Option<f64>,
}

/// Simulation of the named effects.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Simulation {
    /// Errors of both models over the simulated record.
    Done(SimulationFound),
    /// Why it can't be done.
    NotDone {
        /// A sentence.
        not_simulated: String,
    },
}

impl Simulation {
    /// Returns the result of the simulation, if it was possible.
    pub fn result(&self) -> Option<&SimulationFound> {
        match self {
            Self::Done(found) => Some(found),
            Self::NotDone { .. } => None,
        }
    }
}

/// Result of simulating both models over the held-out record, else over the fitted record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulationFound {
    /// Definition of the error.
    pub metric: String,
    /// Kind of data on which both models were simulated.
    pub judged_by: Proof,
    /// Result for each sensor.
    pub channels: Vec<SimulatedRow>,
    /// Parameters of the named model.
    pub parameters: Vec<SimulatedParameter>,
}

/// Error of simulation of one sensor, RMS in its unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulatedRow {
    /// Channel.
    pub channel: String,
    /// RMS of the measured signal.
    pub measured_rms: f64,
    /// Error of the analyst's model.
    pub before: f64,
    /// Error of the named model.
    pub after: f64,
}

/// A parameter, estimated by regression and by simulation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulatedParameter {
    /// Name.
    pub name: String,
    /// Value from the regression.
    pub by_regression: f64,
    /// Value from the simulation.
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
                "RMS of measured minus simulated on {}, in the unit of the channel; both models fitted by simulation",
                found.judged_by.words()
            ),
            judged_by: found.judged_by,
            channels: found.channels.into_iter().map(row).collect(),
            parameters: found.parameters.into_iter().map(parameter).collect(),
        }
    }
}

/// Returns the first entry of a list, if it is a number.
pub(super) fn first_finite(list: &[f64]) -> Option<f64> {
    list.first().copied().filter(|x| x.is_finite())
}

impl From<&crate::reconcile::AlternativeExplanation> for AlternativeSummary {
    fn from(r: &crate::reconcile::AlternativeExplanation) -> Self {
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
