//! `run_record`: a recorded load or the recorded mass of one run is wrong.

use super::{Extension, Parameter, RecordedQuantity, Stage, StrainEffect};
use crate::reconcile::strain::{StrainFrame, StrainState};

/// Load or mass of one run = recorded value + size; for all loads together, recorded value times (1 + size).
#[derive(Clone, Debug)]
pub struct RunRecord {
    /// Index of the run.
    pub run: usize,
    /// Name of the run.
    pub name: String,
    /// Recorded quantity that is wrong.
    pub noted: RecordedQuantity,
    /// Usual size of an error.
    pub usual: f64,
}

impl RunRecord {
    /// Returns one effect for each load, for all loads together and for the mass, in every fit run.
    pub fn list_effects(frame: &StrainFrame) -> Vec<Self> {
        /// Usual size of a record error, as a share of the root mean square of the recorded quantity over all runs.
        const SHARE: f64 = 0.3;
        let rms = |v: &mut dyn Iterator<Item = f64>| {
            let (sum, n) = v.fold((0.0, 0usize), |(s, n), x| (s + x * x, n + 1));
            (sum / n.max(1) as f64).sqrt()
        };
        let (n_l, payload) = (
            frame.n_loads(),
            rms(&mut frame.payload.iter().map(|p| p[0])),
        );
        let load = SHARE * rms(&mut frame.loads.iter().copied());
        let mut kinds: Vec<(RecordedQuantity, f64)> = Vec::new();
        if load > 0.0 {
            kinds.extend((0..n_l).map(|l| (RecordedQuantity::Load(l), load)));
            kinds.push((RecordedQuantity::Loads, SHARE));
        }
        if payload > 0.0 {
            kinds.push((RecordedQuantity::Mass, SHARE * payload));
        }
        let mut out = Vec::new();
        for run in frame.observations.fit_runs() {
            let name = frame
                .observations
                .runs
                .get(run)
                .cloned()
                .unwrap_or_default();
            out.extend(kinds.iter().map(|&(noted, usual)| Self {
                run,
                name: name.clone(),
                noted,
                usual,
            }));
        }
        out
    }
}

impl StrainEffect for RunRecord {
    fn id(&self) -> &str {
        "run_record"
    }
    fn place(&self) -> Option<String> {
        Some(self.name.clone())
    }
    fn stage(&self) -> Stage {
        Stage::Loads
    }
    fn parameters(&self) -> Vec<Parameter> {
        let unit = match self.noted {
            RecordedQuantity::Load(_) => "kN",
            RecordedQuantity::Loads => "of all loads",
            RecordedQuantity::Mass => "kg",
        };
        let (sd, step) = (self.usual, 0.02 * self.usual);
        vec![Parameter {
            unit,
            neutral: 0.0,
            prior_sd: sd,
            step,
            starts: vec![0.0],
            plausible: 10.0 * sd,
        }]
    }
    fn alter(&self, frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let Some(&size) = parameters.first() else {
            return;
        };
        let (n_c, n_l) = (state.shape[2], frame.n_loads());
        let [mass, ..] = frame.payload.get(self.run).copied().unwrap_or([0.0; 3]);
        let Some(row) = state.columns.get_mut(self.run * n_c..(self.run + 1) * n_c) else {
            return;
        };
        match self.noted {
            RecordedQuantity::Load(l) => {
                if let Some(cell) = row.get_mut(l) {
                    *cell += size;
                }
            }
            RecordedQuantity::Loads => row.iter_mut().take(n_l).for_each(|f| *f *= 1.0 + size),
            RecordedQuantity::Mass if mass > 0.0 => row
                .iter_mut()
                .skip(n_l)
                .for_each(|f| *f *= (mass + size) / mass),
            // The run is recorded as empty, so the unrecorded mass acts at the nominal place.
            RecordedQuantity::Mass => {
                if let Some(cell) = row.get_mut(n_l) {
                    *cell += size;
                }
            }
        }
    }
    fn extension(&self, _frame: &StrainFrame, parameters: &[f64]) -> Extension {
        Extension::RunRecord {
            run: self.name.clone(),
            noted: self.noted,
            size: parameters.first().copied().unwrap_or(0.0),
        }
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        format!("repeat run {}, or check its weighing notes", self.name)
    }
    fn runs(&self) -> Vec<usize> {
        vec![self.run]
    }
}
