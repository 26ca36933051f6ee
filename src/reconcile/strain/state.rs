//! State of the model that determines the strain: influence, and the loads of each run.

use crate::reconcile::strain::frame::{PayloadWeight, StrainFrame};

/// Model with effects included: influence, loads, and strain that no load explains.
#[derive(Clone, Debug)]
pub struct StrainState {
    /// `n_gauges x n_columns`.
    pub influence: Vec<f64>,
    /// `n_runs x n_columns`: wheel loads, then payload mass times 1, dx, dy, dx dy.
    pub columns: Vec<f64>,
    /// Additional strain, `n_runs x n_gauges`: a mass that the model lacks.
    pub extra: Vec<f64>,
    /// Number of gauges, runs, columns.
    pub shape: [usize; 3],
}

impl StrainState {
    /// Returns the analyst's own model.
    pub fn from_nominal_model(frame: &StrainFrame) -> Self {
        let (n_g, n_r, n_c, n_l) = (
            frame.n_gauges(),
            frame.n_runs(),
            frame.n_columns(),
            frame.n_loads(),
        );
        let mut state = Self {
            influence: frame.influence.clone(),
            columns: vec![0.0; n_r * n_c],
            extra: vec![0.0; n_r * n_g],
            shape: [n_g, n_r, n_c],
        };
        for run in 0..n_r {
            for load in 0..n_l {
                state.columns[run * n_c + load] = frame.loads[run * n_l + load];
            }
        }
        if frame.payload_weight == PayloadWeight::InModel {
            state.set_payload(frame, 0.0, 0.0);
        }
        state
    }

    /// Applies the payload, moved by `dx`, `dy` metres from its place in the job.
    pub fn set_payload(&mut self, frame: &StrainFrame, dx: f64, dy: f64) {
        let [_, n_r, n_c] = self.shape;
        for run in 0..n_r {
            let [mass, x, y] = frame.payload.get(run).copied().unwrap_or([0.0; 3]);
            let (x, y) = (x + dx, y + dy);
            let first = run * n_c + frame.n_loads();
            let terms = [1.0, x, y, x * y];
            for (cell, t) in self.columns[first..first + terms.len()]
                .iter_mut()
                .zip(terms)
            {
                *cell = mass * t;
            }
        }
    }

    /// Returns the strain of every gauge in `run`, before any reading effect.
    pub fn strain(&self, run: usize) -> Vec<f64> {
        let [n_g, _, n_c] = self.shape;
        let acts = &self.columns[run * n_c..(run + 1) * n_c];
        let extra = &self.extra[run * n_g..(run + 1) * n_g];
        let rows = self.influence.chunks_exact(n_c);
        rows.zip(extra)
            .map(|(row, e)| e + row.iter().zip(acts).map(|(a, f)| a * f).sum::<f64>())
            .collect()
    }
}

/// Part of a reading effect that applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Complete strain, with offsets and limits, for predictions.
    Whole,
    /// The linear part: for columns of unknown amplitude and for noise.
    Linear,
}
