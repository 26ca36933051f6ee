//! How well the strain of runs fits a payload, as the search for wrong inputs asks it.

use super::evidence::{PayloadModel, PayloadRun, Place, WeighSpec};
use crate::estimate::{LinearGaussian, NORMAL_95, ReadingErrors};
use crate::input_faults::{
    AlternativeRows, DetectedFault, InputFit, Inputs, Misfit, Rules, search_faults,
};
use crate::linalg::Matrix;
use rayon::prelude::*;

/// Rounds between the payload and the variances that depend on it; they settle in two or three.
const ROUNDS: usize = 3;

/// Strain of a payload and of measured wheel forces.
struct WeighingMisfit<'a> {
    model: &'a PayloadModel,
    runs: Vec<&'a PayloadRun>,
    spec: &'a WeighSpec,
    noise: f64,
}

/// Returns the faults of the gauges found from the strain of a payload. `alternatives` has the same rows as [`payload_rows`].
pub fn faults_of_gauges(
    model: &PayloadModel,
    runs: &[PayloadRun],
    spec: &WeighSpec,
    alternatives: &mut dyn FnMut() -> Vec<AlternativeRows>,
) -> Vec<DetectedFault> {
    let reads = |r: &&PayloadRun| r.strain.iter().any(|v| v.is_finite());
    let runs: Vec<&PayloadRun> = runs.iter().filter(reads).collect();
    let noise = runs.iter().flat_map(|r| &r.sigma).filter(|s| s.is_finite());
    let misfit = WeighingMisfit {
        noise: noise.fold(0.0, |a: f64, s| a.max(*s)),
        model,
        runs,
        spec,
    };
    match misfit.runs.is_empty() {
        true => Vec::new(),
        false => search_faults(&misfit, alternatives, &Rules::STATED),
    }
}

/// Returns strain by gauge per unit of `p = (F, F dx, F dy)` and of each wheel force.
pub fn payload_rows(model: &PayloadModel) -> Matrix {
    let n_wheels = model.wheels.ncols();
    Matrix::from_fn(model.gauges.len(), 3 + n_wheels, |g, k| match k {
        0..3 => model.payload[(g, k)],
        _ => model.wheels[(g, k - 3)],
    })
}

impl Misfit for WeighingMisfit<'_> {
    fn inputs(&self) -> Inputs {
        Inputs {
            strain: self.runs.iter().map(|r| r.strain.clone()).collect(),
            rows: payload_rows(self.model),
        }
    }

    fn noise(&self) -> f64 {
        self.noise
    }

    fn fit(&self, inputs: &Inputs) -> InputFit {
        let runs = self.runs.par_iter().zip(&inputs.strain);
        let each = runs.map(|(run, strain)| self.fit_run(run, strain, &inputs.rows));
        let each: Vec<Option<InputFit>> = each.collect();
        let mut out = InputFit::default();
        for run in each {
            let run = run.unwrap_or_else(|| InputFit {
                predicted: vec![vec![f64::NAN; self.model.gauges.len()]],
                loads: vec![vec![[f64::NAN; 2]]],
                ..InputFit::default()
            });
            out.chi2 += run.chi2;
            out.dof += run.dof;
            out.predicted.extend(run.predicted);
            out.loads.extend(run.loads);
        }
        out
    }
}

impl WeighingMisfit<'_> {
    /// Returns the least squares of a run; `None` where nothing carries the payload, or nothing is read.
    fn fit_run(&self, run: &PayloadRun, strain: &[f64], rows: &Matrix) -> Option<InputFit> {
        let (spec, n_wheels) = (self.spec, rows.ncols() - 3);
        let measured = !run.reactions.is_empty();
        let place = [1.0, run.shift[0], run.shift[1]];
        let by_wheels = |g: usize, r: &dyn Fn(usize) -> f64| -> f64 {
            (0..n_wheels).map(|w| rows[(g, 3 + w)] * r(w)).sum()
        };
        let column = |g: usize, k: usize| -> f64 {
            let floor = self.model.floor.as_ref().filter(|_| !measured);
            rows[(g, k)] + floor.map_or(0.0, |f| by_wheels(g, &|w| f[(w, k)]))
        };
        if !measured && self.model.floor.is_none() {
            return None;
        }
        let reaction = |w: usize| run.reactions.get(w).copied().unwrap_or(0.0);
        let less: Vec<f64> = (0..rows.nrows()).map(|g| by_wheels(g, &reaction)).collect();
        let reads = |g: &usize| strain[*g].is_finite() && less[*g].is_finite();
        let used: Vec<usize> = (0..rows.nrows()).filter(reads).collect();
        let q = if spec.place == Place::Free { 3 } else { 1 };
        let entry = |g: usize, k: usize| match q {
            3 => column(g, k),
            _ => (0..3).map(|k| column(g, k) * place[k]).sum(),
        };
        let all = Matrix::from_fn(rows.nrows(), q, entry);
        let a = Matrix::from_fn(used.len(), q, |i, k| all[(used[i], k)]);
        let y: Vec<f64> = used.iter().map(|g| strain[*g] - less[*g]).collect();
        let scales: Vec<f64> = a
            .column_iter()
            .map(|c| 1.0 / c.norm().max(f64::MIN_POSITIVE))
            .collect();
        let mut p = vec![0.0; q];
        let mut solved = None;
        for _ in 0..ROUNDS {
            let variance = |(i, g): (usize, &usize)| {
                let own = run
                    .sigma
                    .get(*g)
                    .copied()
                    .filter(|s| s.is_finite())
                    .unwrap_or(self.noise);
                let model: f64 = (0..q).map(|k| (a[(i, k)] * p[k]).powi(2)).sum();
                let wheels: f64 = (0..if measured { n_wheels } else { 0 })
                    .map(|w| {
                        let row = rows[(*g, 3 + w)];
                        (row * spec.reaction_sigma).powi(2)
                            + (spec.model_rel * row * reaction(w)).powi(2)
                    })
                    .sum();
                (own * own + spec.model_rel.powi(2) * model + wheels).max(f64::MIN_POSITIVE)
            };
            let variances: Vec<f64> = used.iter().enumerate().map(variance).collect();
            let model = LinearGaussian {
                rows: &a,
                errors: ReadingErrors::Variances(&variances),
                prior_sd: &vec![None; q],
                scales: &scales,
            };
            let found = model.estimate(&y)?;
            p.clone_from(&found.value);
            solved = Some(found);
        }
        let found = solved?;
        let predicted = |g: usize| less[g] + (0..q).map(|k| all[(g, k)] * p[k]).sum::<f64>();
        let sigma = found.covariance[(0, 0)].sqrt().hypot(spec.model_rel * p[0]);
        Some(InputFit {
            chi2: found.chi2,
            dof: used.len().saturating_sub(found.rank),
            predicted: vec![(0..rows.nrows()).map(predicted).collect()],
            loads: vec![vec![[p[0], NORMAL_95 * sigma]]],
        })
    }
}
