//! The prediction, evaluated exactly with any set of effects on.

use super::frame::StrainFrame;
use super::state::{Part, StrainState};
use crate::reconcile::effect::{Member, Stage};

impl StrainState {
    /// Returns the model with `members` included, each with its parameters: structure first, then loads. [`read_all`] applies reading effects.
    pub fn from_members(frame: &StrainFrame, members: &[Member<'_>]) -> Self {
        let mut state = Self::from_nominal_model(frame);
        for stage in [Stage::Structure, Stage::Loads] {
            for m in members.iter().filter(|m| m.effect.stage() == stage) {
                m.effect.alter(frame, m.parameters, &mut state);
            }
        }
        state
    }
}

/// Applies the reading effects of `members` to `strain` (one row of gauges in `run`).
pub fn read_all(
    frame: &StrainFrame,
    members: &[Member<'_>],
    run: usize,
    strain: &mut [f64],
    part: Part,
) {
    for m in members
        .iter()
        .filter(|m| m.effect.stage() == Stage::Reading)
    {
        m.effect.read(frame, m.parameters, run, strain, part);
    }
}

/// Returns the predicted readings of every run, `n_runs x n_gauges`, with `members` included.
pub fn predict(frame: &StrainFrame, members: &[Member<'_>]) -> Vec<f64> {
    let state = StrainState::from_members(frame, members);
    let mut out = Vec::with_capacity(frame.n_runs() * frame.n_gauges());
    for run in 0..frame.n_runs() {
        let mut row = state.strain(run);
        read_all(frame, members, run, &mut row, Part::Whole);
        out.extend(row);
    }
    out
}
