//! Result types of reconcile, for strain and acceleration.

use crate::finding::Finding;
use crate::reconcile::effect::Extension;
use serde::Serialize;

/// Verdict of reconcile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Effects are identified: their evidence is decisive, the residual reaches its floor, and their sizes are plausible.
    Named,
    /// Model and measurement agree within noise and stated uncertainty.
    None,
    /// There is a gap, and no effect of the library closes it.
    Unknown,
    /// There is a hint of an effect that is too small for these data to identify.
    BelowDetectability,
}

impl Verdict {
    /// Returns the verdict as written in results.
    pub fn word(self) -> &'static str {
        match self {
            Self::Named => "named",
            Self::None => "none",
            Self::Unknown => "unknown",
            Self::BelowDetectability => "below-detectability",
        }
    }
}

/// Identified effect.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedEffect {
    /// Id with place.
    pub id: String,
    /// Place without the id.
    pub place: Option<String>,
    /// Size by parameter, or by kind of amplitude (root mean square over runs).
    pub size: Vec<f64>,
    /// Standard deviation of each size.
    pub sigma: Vec<f64>,
    /// Unit of size and standard deviation.
    pub unit: &'static str,
    /// Whether the size occurs in practice.
    pub plausible: bool,
    /// Change of the job or the deck that represents the effect.
    pub extension: Extension,
}

/// Alternative explanation.
#[derive(Clone, Debug, PartialEq)]
pub struct AlternativeExplanation {
    /// Ids with places.
    pub ids: Vec<String>,
    /// Log evidence of the identified set minus the log evidence of this explanation.
    pub evidence_difference: f64,
    /// Gap on held-out runs with this explanation.
    pub gap_after: f64,
    /// Whether these data cannot distinguish this explanation from the identified cause.
    pub indistinguishable: bool,
}

/// Runs that the gap is computed on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GapBasis {
    /// Runs that were never used for fitting.
    HeldOut,
    /// No run was held out. The gap is computed on each run in turn, with sizes and amplitudes estimated from the other runs.
    CrossValidated,
    /// No run was held out, and the gap is computed on fitted data.
    Fitted,
}

impl GapBasis {
    /// Returns the basis as written in results and reports.
    pub fn words(self) -> &'static str {
        match self {
            Self::HeldOut => "held-out",
            Self::CrossValidated => "cross-validated",
            Self::Fitted => "fitted",
        }
    }
}

/// Gap `RMS(reading - model) / RMS(reading)`: without the effects, with the effects, and expected for a correct model. All three are computed in the
/// same way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GapNumbers {
    /// Gap of the analyst's model.
    pub before: f64,
    /// Gap with the identified effects.
    pub after: f64,
    /// Gap expected from noise, stated model uncertainty and the mesh.
    pub floor: f64,
}

/// The gap on runs that were not fitted: RMS(reading - model) / RMS(reading).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Gap of the analyst's model.
    pub before: f64,
    /// Gap with the identified effects. Amplitudes of a run are estimated from one half of the channels and tested on the other.
    pub after: f64,
    /// Gap expected from noise, stated model uncertainty and the mesh.
    pub floor: f64,
    /// Gap from the mesh alone: the difference from a mesh half as wide. `None` if no such mesh was solved.
    pub mesh: Option<f64>,
    /// Runs that the gap is computed on.
    pub basis: GapBasis,
    /// Gap numbers with the errors of the recorded wheel loads estimated again in every run, for before, after and floor.
    pub loads_found: Option<GapNumbers>,
    /// Whether the gap falls by more than its own sampling error.
    pub falls: bool,
}

impl Gap {
    /// Returns (before^2 - after^2) / (before^2 - floor^2), limited to 0 .. 1; zero if the gap does not exceed its floor.
    pub fn explained_share(&self) -> f64 {
        let closable = self.before * self.before - self.floor * self.floor;
        if closable > 0.0 {
            let closed = self.before * self.before - self.after * self.after;
            (closed / closable).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }

    /// Returns whether the gap of the analyst's model exceeds its floor, with the loads as recorded or estimated again.
    pub fn is_above_floor(&self) -> bool {
        let found = self.loads_found;
        self.before > self.floor || found.is_some_and(|f| f.before > f.floor)
    }
}

/// Gap at one channel, in the unit of the channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelGap {
    /// Channel.
    pub channel: String,
    /// RMS residual on held-out runs before.
    pub before: f64,
    /// RMS residual on held-out runs after.
    pub after: f64,
    /// Expected RMS residual of a right model.
    pub floor: f64,
    /// RMS reading.
    pub reading: f64,
}

/// Load recovered from held-out strain, without and with the identified effects.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadShift {
    /// Run.
    pub run: String,
    /// Load.
    pub load: String,
    /// Unit of the values: kN, or kN m for a moment.
    pub unit: &'static str,
    /// Load measured or computed for the run.
    pub stated: f64,
    /// Load recovered with the analyst's model.
    pub before: f64,
    /// Load recovered with the identified effects.
    pub after: f64,
    /// Standard deviation of `after`.
    pub sigma: f64,
}

impl LoadShift {
    /// Returns whether the load changes by more than two standard deviations.
    pub fn is_significant(&self) -> bool {
        (self.after - self.before).abs() > 2.0 * self.sigma
    }
}

/// Smallest size of an effect that these data would show.
#[derive(Clone, Debug, PartialEq)]
pub struct DetectionLimit {
    /// Id with place.
    pub id: String,
    /// Size.
    pub size: f64,
    /// Unit.
    pub unit: &'static str,
}

/// Residual of a gauge or run compared with its floor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Misfit {
    /// Gauge or run.
    pub name: String,
    /// Chi-square divided by the number of readings. It is 1 at the floor.
    pub reduced_chi2: f64,
    /// Chi-square as a standard normal deviate.
    pub deviate: f64,
}

/// Factor of a smooth model error at a gauge.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SmoothAt {
    /// Gauge.
    pub gauge: String,
    /// Position of the gauge, metres.
    pub place_m: [f64; 3],
    /// Load that the factor applies to; `None` if all loads share the factor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<String>,
    /// Strain over the strain that the model predicts.
    pub factor: f64,
    /// Standard deviation of `factor`.
    pub sd: f64,
}

/// Result of reconcile for strain.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Verdict.
    pub verdict: Verdict,
    /// Identified effects; empty unless the verdict is [`Verdict::Named`].
    pub effects: Vec<NamedEffect>,
    /// Effects of the best set, even if the set is not decisive, not at the floor or not plausible.
    pub best_attempt: Vec<NamedEffect>,
    /// Effects replaced by a smooth model error that explains the data as well; empty if no such error exists.
    pub replaced: Vec<NamedEffect>,
    /// Alternative explanations, nearest first.
    pub rivals: Vec<AlternativeExplanation>,
    /// Log evidence of the identified set (or best attempt) minus the log evidence without effects.
    pub evidence: f64,
    /// Number of resampled run sets, out of 100, whose best set contains every effect of the identified set (or best attempt).
    pub wins: usize,
    /// Joint covariance of the parameters of the identified set (or best attempt), effects in order, by rows.
    pub covariance: Vec<f64>,
    /// Noise that the readings show over the stated noise; 1 if the stated noise is right.
    pub noise_factor: f64,
    /// Curve of a smooth model error if it explains these data as well as any identified effects; otherwise empty.
    pub smooth: Vec<SmoothAt>,
    /// Gap.
    pub gap: Gap,
    /// Gauges with the largest shares of the squared gap, and gauges above their floor, as text.
    pub sits: String,
    /// Gap by channel.
    pub channels: Vec<ChannelGap>,
    /// Recovered loads before and after.
    pub loads: Vec<LoadShift>,
    /// Reduced chi-square: fit runs before, fit runs after, held-out runs after.
    pub reduced_chi2: [f64; 3],
    /// Gauges above their own floor before any effect, worst first.
    pub gauges_off_before: Vec<Misfit>,
    /// Gauges above their own floor after the effects, worst first: the second pass.
    pub gauges_off: Vec<Misfit>,
    /// Runs above their own floor after the effects, worst first.
    pub runs_off: Vec<Misfit>,
    /// Residual after the best set, as text: gauges, runs and growth with the load.
    pub remains: String,
    /// Readings predicted with the identified set (or best attempt), microstrain, `n_runs x n_gauges`, as the channels read. Contributions that
    /// differ from run to run are excluded.
    pub predicted: Vec<f64>,
    /// Measurement that would separate the first two explanations, as text.
    pub next_measurement: String,
    /// Smallest sizes of effects that these data would show.
    pub detectable: Vec<DetectionLimit>,
    /// Findings on wrong recorded loads. If there are any, no effect is searched for.
    pub input_faults: Vec<Finding>,
}
