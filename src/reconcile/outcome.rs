//! What the workflow has to say, for strain and acceleration alike.

use crate::finding::Finding;
use crate::reconcile::effect::Extension;
use serde::Serialize;

/// The verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Effects are named: decisive, at the floor, plausible.
    Named,
    /// Model and measurement agree within noise and stated uncertainty.
    None,
    /// There is a gap, and nothing in the library closes it.
    Unknown,
    /// There is a hint of an effect, too small for these data to name.
    BelowDetectability,
}

impl Verdict {
    /// The word in results.
    pub fn word(self) -> &'static str {
        match self {
            Self::Named => "named",
            Self::None => "none",
            Self::Unknown => "unknown",
            Self::BelowDetectability => "below-detectability",
        }
    }
}

/// A named effect.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedEffect {
    /// Id with place.
    pub id: String,
    /// Place alone.
    pub place: Option<String>,
    /// Sizes, one a parameter (or a kind of amplitude: its root mean square over runs).
    pub size: Vec<f64>,
    /// One standard deviation of each.
    pub sigma: Vec<f64>,
    /// Their unit.
    pub unit: &'static str,
    /// Is the size one that occurs?
    pub plausible: bool,
    /// What the model must be given.
    pub extension: Extension,
}

/// Another explanation.
#[derive(Clone, Debug, PartialEq)]
pub struct Rival {
    /// Ids with places.
    pub ids: Vec<String>,
    /// Log evidence of the named set less that of this one.
    pub evidence_difference: f64,
    /// Gap that it leaves on held-out runs.
    pub gap_after: f64,
    /// These data can't tell it from what was named.
    pub indistinguishable: bool,
}

/// Which runs the gap is judged on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GapBasis {
    /// Runs that were never used for fitting.
    HeldOut,
    /// No run was held out: every run in turn, with sizes and amplitudes found from the others.
    CrossValidated,
    /// Nothing was held out, and what is judged was fitted.
    Fitted,
}

impl GapBasis {
    /// The word in results and on reports.
    pub fn words(self) -> &'static str {
        match self {
            Self::HeldOut => "held-out",
            Self::CrossValidated => "cross-validated",
            Self::Fitted => "fitted",
        }
    }
}

/// RMS(reading - model) / RMS(reading): before, after, and what a right model would leave, made alike.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GapNumbers {
    /// The analyst's model.
    pub before: f64,
    /// With the named effects.
    pub after: f64,
    /// What noise, stated model uncertainty and the mesh leave.
    pub floor: f64,
}

/// The gap on runs that were not fitted: RMS(reading - model) / RMS(reading).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// The analyst's model.
    pub before: f64,
    /// With the named effects; amplitudes of a run found from one half of the channels and judged on the other.
    pub after: f64,
    /// What noise, stated model uncertainty and the mesh leave.
    pub floor: f64,
    /// What the mesh alone makes: the difference from a mesh half as wide; `None` where none was solved.
    pub mesh: Option<f64>,
    /// Which runs it is judged on.
    pub basis: GapBasis,
    /// The same with the errors of the noted wheel loads found anew in every run, before, after and in the floor.
    pub loads_found: Option<GapNumbers>,
    /// Whether the gap falls by more than its own sampling error.
    pub falls: bool,
}

impl Gap {
    /// Returns (before^2 - after^2) / (before^2 - floor^2) within 0 and 1; zero where there is nothing to close.
    pub fn explained_share(&self) -> f64 {
        let closable = self.before * self.before - self.floor * self.floor;
        if closable > 0.0 {
            let closed = self.before * self.before - self.after * self.after;
            (closed / closable).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }

    /// Whether the analyst's model leaves more than a right one would, with the loads as recorded or found again.
    pub fn is_above_floor(&self) -> bool {
        let found = self.loads_found;
        self.before > self.floor || found.is_some_and(|f| f.before > f.floor)
    }
}

/// The gap at one channel, in the channel's unit.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelGap {
    /// Channel.
    pub channel: String,
    /// RMS residual on held-out runs before.
    pub before: f64,
    /// After.
    pub after: f64,
    /// Floor.
    pub floor: f64,
    /// RMS reading.
    pub reading: f64,
}

/// A load recovered from held-out strain without and with the named effects.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadShift {
    /// Run.
    pub run: String,
    /// Load.
    pub load: String,
    /// Unit of what follows: kN, kN m for a moment.
    pub unit: &'static str,
    /// As measured or computed for the run.
    pub stated: f64,
    /// Recovered by the analyst's model.
    pub before: f64,
    /// Recovered with the effects in.
    pub after: f64,
    /// One standard deviation of `after`.
    pub sigma: f64,
}

impl LoadShift {
    /// Has it moved by more than two standard deviations?
    pub fn moved(&self) -> bool {
        (self.after - self.before).abs() > 2.0 * self.sigma
    }
}

/// Smallest size of an effect that these data would show.
#[derive(Clone, Debug, PartialEq)]
pub struct Detectable {
    /// Id with place.
    pub id: String,
    /// Size.
    pub size: f64,
    /// Unit.
    pub unit: &'static str,
}

/// How far something lies from its floor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Misfit {
    /// Gauge or run.
    pub name: String,
    /// Chi-square by number of readings: 1 at the floor.
    pub reduced_chi2: f64,
    /// The same as a standard normal deviate.
    pub deviate: f64,
}

/// The factor by which a smooth error of the model is off at a gauge.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SmoothAt {
    /// Gauge.
    pub gauge: String,
    /// Its place, metres.
    pub place_m: [f64; 3],
    /// The load; `None` where all loads share the factor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<String>,
    /// Strain over what the model predicts.
    pub factor: f64,
    /// One standard deviation of it.
    pub sd: f64,
}

/// Everything.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Verdict.
    pub verdict: Verdict,
    /// Named effects; empty unless named.
    pub effects: Vec<NamedEffect>,
    /// What would have been named, had it reached the floor, been decisive or plausible.
    pub best_attempt: Vec<NamedEffect>,
    /// The names that a smooth error of the model explains as well as; empty where none does.
    pub replaced: Vec<NamedEffect>,
    /// Other explanations, nearest first.
    pub rivals: Vec<Rival>,
    /// Log evidence of the named set (or best attempt) less that of no effect.
    pub evidence: f64,
    /// Of 100 drawings of the runs, those whose best set holds every one of its names.
    pub wins: usize,
    /// Joint covariance of the parameters of the named set (or best attempt), effects in order, by rows.
    pub covariance: Vec<f64>,
    /// Noise that the readings show over the stated one; 1 where the stated one holds.
    pub noise_factor: f64,
    /// The curve of a smooth error of the model, where one explains these data as well as any names; empty otherwise.
    pub smooth: Vec<SmoothAt>,
    /// Gap.
    pub gap: Gap,
    /// Where the gap sits, in words.
    pub sits: String,
    /// By channel.
    pub channels: Vec<ChannelGap>,
    /// Loads before and after.
    pub loads: Vec<LoadShift>,
    /// Reduced chi-square: fit runs before, fit runs after, held-out runs after.
    pub reduced_chi2: [f64; 3],
    /// Gauges beyond their own floor before any effect, worst first.
    pub gauges_off_before: Vec<Misfit>,
    /// Gauges beyond their own floor after: the second pass.
    pub gauges_off: Vec<Misfit>,
    /// Runs beyond the floor after.
    pub runs_off: Vec<Misfit>,
    /// What remains, in words; where it sits and how it grows.
    pub remains: String,
    /// What the model predicts with the named set (or best attempt) in it, channels as they read, microstrain, `n_runs x n_gauges`; what
    /// differs from run to run is not in it.
    pub predicted: Vec<f64>,
    /// What would separate the first two explanations.
    pub next_measurement: String,
    /// Smallest sizes that would have been seen.
    pub detectable: Vec<Detectable>,
    /// Findings on recorded loads that are wrong themselves; no effect is looked for then.
    pub input_faults: Vec<Finding>,
}
