//! `run_exchange`: the recorded loads and payloads of two runs are exchanged.

use super::{Extension, Stage, StrainEffect};
use crate::reconcile::strain::{StrainFrame, StrainState};

/// Exchange of two runs: loads and payload of run a act in run b, and loads and payload of run b act in run a.
#[derive(Clone, Debug)]
pub struct RunExchange {
    /// The two runs.
    pub pair: [usize; 2],
    /// Names of the two runs.
    pub names: [String; 2],
}

impl RunExchange {
    /// Returns one effect for every pair with a run that is used for fitting.
    pub fn list_effects(frame: &StrainFrame) -> Vec<Self> {
        let fit = frame.observations.fit_runs();
        let name = |r: usize| frame.observations.runs.get(r).cloned().unwrap_or_default();
        let mut out = Vec::new();
        for a in 0..frame.n_runs() {
            let others = (a + 1..frame.n_runs()).filter(|b| fit.contains(&a) || fit.contains(b));
            out.extend(others.map(|b| Self {
                pair: [a, b],
                names: [name(a), name(b)],
            }));
        }
        out
    }
}

impl StrainEffect for RunExchange {
    fn id(&self) -> &str {
        "run_exchange"
    }
    fn place(&self) -> Option<String> {
        Some(self.names.join("+"))
    }
    fn stage(&self) -> Stage {
        Stage::Loads
    }
    fn alter(&self, _frame: &StrainFrame, _parameters: &[f64], state: &mut StrainState) {
        let n_c = state.shape[2];
        let [a, b] = self.pair;
        for c in 0..n_c {
            let (i, j) = (a * n_c + c, b * n_c + c);
            if i < state.columns.len() && j < state.columns.len() {
                state.columns.swap(i, j);
            }
        }
    }
    fn extension(&self, _frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        Extension::RunExchange {
            runs: self.names.clone(),
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!(
            "check the notes and the times of runs {} in the test log",
            self.names.join(" and ")
        )
    }
    fn runs(&self) -> Vec<usize> {
        self.pair.to_vec()
    }
}
