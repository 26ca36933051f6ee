//! Model discrepancy: general forms of a residual that no identified effect causes. If one of them explains most, the verdict is `unknown`
//! and the message describes that form. A flexible effect, such as side loads, must also explain more than plain scatter.

use super::{Amplitudes, Discrepancy, Extension, Parameter, Stage, StrainEffect};
use crate::reconcile::strain::{N_PAYLOAD_COLUMNS, Part, StrainFrame, StrainState};

/// Usual zero of a gauge that was taken in another state, microstrain.
const USUAL_ZERO: f64 = 20.0;

/// The general forms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelDiscrepancy {
    /// All strain grows more, or less, than in proportion to the load of the run.
    LoadDependent,
    /// Each gauge separately reads more, or less, than in proportion to its strain.
    StrainDependent,
    /// Strain depends in part on the load of the previous run.
    Memory,
    /// Channels leak into their neighbours in file order.
    CrossTalk,
    /// Scatter in proportion to the stated noise that no load explains.
    Scatter,
    /// Scatter in proportion to the root mean square reading of each gauge.
    RelativeScatter,
    /// Each gauge has a different zero error, since its zero was taken in another state than the reference state of the runs.
    Zeros,
    /// Noise that varies slowly from run to run, with the correlation between successive runs in percent. Its ratio to the stated noise is equal at
    /// all gauges.
    Wander(u8),
}

impl ModelDiscrepancy {
    /// Returns all general forms.
    pub fn list_effects() -> Vec<Self> {
        vec![
            Self::LoadDependent,
            Self::StrainDependent,
            Self::Memory,
            Self::CrossTalk,
            Self::Scatter,
            Self::RelativeScatter,
            Self::Zeros,
            Self::Wander(50),
            Self::Wander(80),
            Self::Wander(95),
        ]
    }

    /// Returns the description of the gap in messages.
    fn words(self) -> &'static str {
        match self {
            Self::LoadDependent => {
                "strain is not proportional to the load (a joint that closes, a spring that stiffens)"
            }
            Self::StrainDependent => {
                "readings are not proportional to strain (range, yielding, bond)"
            }
            Self::Memory => "strain depends on the previous run (friction, hysteresis)",
            Self::CrossTalk => "channels leak into their neighbours (wiring, multiplexer)",
            Self::Scatter => "readings scatter from run to run, and no load explains the scatter",
            Self::RelativeScatter => "readings scatter from run to run in proportion to their size",
            Self::Wander(_) => "zeros drift slowly from run to run",
            Self::Zeros => {
                "readings of many gauges have a constant offset each (zeros read under load, at another temperature, or with other leads)"
            }
        }
    }
}

/// Returns the sum of the absolute wheel loads of `run`, relative to the run with the largest sum.
fn load_level(state: &StrainState, run: usize) -> f64 {
    let [_, n_r, n_c] = state.shape;
    let size = |r: usize| {
        let row = &state.columns[r * n_c..(r + 1) * n_c];
        row.iter()
            .take(n_c.saturating_sub(N_PAYLOAD_COLUMNS))
            .map(|f| f.abs())
            .sum::<f64>()
    };
    let most = (0..n_r).map(size).fold(0.0, f64::max);
    if most > 0.0 { size(run) / most } else { 0.0 }
}

impl StrainEffect for ModelDiscrepancy {
    fn id(&self) -> &str {
        match self {
            Self::LoadDependent => "load_dependent",
            Self::StrainDependent => "strain_dependent",
            Self::Memory => "memory",
            Self::CrossTalk => "cross_talk",
            Self::Scatter => "scatter",
            Self::RelativeScatter => "relative_scatter",
            Self::Zeros => "zeros",
            Self::Wander(_) => "wander",
        }
    }
    fn discrepancy(&self) -> Option<Discrepancy> {
        Some(match self {
            Self::Scatter | Self::Wander(_) => Discrepancy::Noise(self.words()),
            _ => Discrepancy::Form(self.words()),
        })
    }
    fn stage(&self) -> Stage {
        match self {
            Self::CrossTalk => Stage::Structure,
            Self::StrainDependent => Stage::Reading,
            _ => Stage::Loads,
        }
    }
    fn parameters(&self) -> Vec<Parameter> {
        match self {
            Self::Scatter | Self::RelativeScatter | Self::Zeros | Self::Wander(_) => Vec::new(),
            _ => vec![Parameter {
                unit: "1",
                neutral: 0.0,
                prior_sd: 0.2,
                step: 0.005,
                starts: vec![0.0],
                plausible: 2.0,
            }],
        }
    }
    fn alter(&self, _frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let Some(&size) = parameters.first() else {
            return;
        };
        let [n_g, n_r, n_c] = state.shape;
        match self {
            Self::LoadDependent => {
                let levels: Vec<f64> = (0..n_r).map(|r| load_level(state, r)).collect();
                for (row, level) in state.columns.chunks_exact_mut(n_c).zip(levels) {
                    row.iter_mut().for_each(|f| *f *= 1.0 + size * level);
                }
            }
            Self::Memory => {
                let before = state.columns.clone();
                for r in 1..n_r {
                    for c in 0..n_c {
                        let change = before[(r - 1) * n_c + c] - before[r * n_c + c];
                        state.columns[r * n_c + c] += size * change;
                    }
                }
            }
            Self::CrossTalk => {
                let before = state.influence.clone();
                for g in 1..n_g {
                    for c in 0..n_c {
                        state.influence[g * n_c + c] += size * before[(g - 1) * n_c + c];
                    }
                }
            }
            _ => {}
        }
    }
    fn read(
        &self,
        frame: &StrainFrame,
        parameters: &[f64],
        _run: usize,
        row: &mut [f64],
        part: Part,
    ) {
        let (Self::StrainDependent, Part::Whole, [size, ..]) = (self, part, parameters) else {
            return;
        };
        let n_g = frame.n_gauges();
        for (g, cell) in row.iter_mut().enumerate() {
            let most = (0..frame.n_runs())
                .map(|r| {
                    frame
                        .observations
                        .values
                        .get(r * n_g + g)
                        .map_or(0.0, |v| v.abs())
                })
                .fold(0.0, f64::max);
            if most > 0.0 {
                *cell *= 1.0 + size * (cell.abs() / most).min(2.0);
            }
        }
    }
    fn amplitudes(&self, frame: &StrainFrame) -> Option<Amplitudes> {
        let n_g = frame.n_gauges();
        let usual = |g: usize| {
            let read = (0..frame.n_runs()).map(|r| frame.observations.value(r, g));
            let kept: Vec<f64> = read.filter(|v| v.is_finite()).collect();
            (kept.iter().map(|v| v * v).sum::<f64>() / kept.len().max(1) as f64).sqrt()
        };
        let height: Vec<f64> = match self {
            Self::Zeros => vec![1.0; n_g],
            // The noise exceeds the stated noise by the same factor at all gauges.
            Self::Scatter | Self::Wander(_) => match &frame.gauge_noise {
                Some(noise) => noise.sd(),
                None => vec![1.0; n_g],
            },
            Self::RelativeScatter => (0..n_g).map(usual).collect(),
            _ => return None,
        };
        let pattern = |(g, h): (usize, &f64)| {
            (0..n_g)
                .map(|k| if k == g { *h } else { 0.0 })
                .collect::<Vec<f64>>()
        };
        let (scatter, steady) = match self {
            Self::Scatter => (3.0 * frame.noise.max(0.5), 0.0),
            Self::Zeros => (0.0, USUAL_ZERO),
            Self::Wander(_) => (0.5 * frame.noise.max(0.5), 0.0),
            _ => (0.1, 0.0),
        };
        let correlation = match self {
            Self::Wander(percent) => 0.01 * f64::from(*percent),
            _ => 0.0,
        };
        Some(Amplitudes {
            patterns: height.iter().enumerate().map(pattern).collect(),
            kinds: vec![0; n_g],
            usual: vec![scatter],
            steady: vec![steady],
            correlation,
            unit: if *self == Self::RelativeScatter {
                "1"
            } else {
                "microstrain"
            },
            plausible: vec![f64::INFINITY],
        })
    }
    fn extension(&self, _frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        Extension::Nothing
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        match self {
            Self::Memory => {
                "approach one load from below and from above: friction shows as a loop".into()
            }
            Self::CrossTalk => {
                "shunt one gauge and check the readings of the adjacent channels".into()
            }
            Self::LoadDependent | Self::StrainDependent => {
                "load in equal steps to the full payload and back".into()
            }
            Self::Zeros => "unload to the installation state and read the zeros again".into(),
            Self::Wander(_) => "read the zeros between runs (`zero` in the runs file)".into(),
            Self::Scatter | Self::RelativeScatter => {
                "repeat one run three times: scatter changes, an effect of the loads repeats".into()
            }
        }
    }
}
