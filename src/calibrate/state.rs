//! One fit of all used runs: posterior of S, error of the model, scatter of repeats and corrected loads in turn.

use super::common_zero::{CentredPosterior, less_zero, zero_of};
use super::given_others;
use super::load_correction::correct;
use super::model_error::{ErrorEvidence, error_evidence as learn_error};
use super::posterior::{Equation, Posterior, solve};
use super::prior::{FLOORS, RowError, RowPrior, diffuse_prior, rows};
use super::scatter::{RunResiduals, Scatter};
use super::start::{from_known, from_parts};
use super::types::{KnownRun, ModelPrior, Task};
use super::unknown_directions::{FreeDirections, UnknownDirections};
use crate::linalg::Matrix;
use crate::sensitivity::{Sensitivity, Uncertainty, mean_square};

/// Rounds between S, model error, scatter and corrected loads; they settle in three.
const ROUNDS: usize = 4;
/// One fit of all used runs.
pub(super) struct State {
    /// Runs used, by number.
    pub used: Vec<usize>,
    /// Size of each load. The columns of the fit are the columns of S times these sizes.
    pub scales: Vec<f64>,
    /// Prior of the rows.
    pub prior: Vec<RowPrior>,
    /// Entries of S.
    pub posterior: Posterior,
    /// Equation of each used run.
    pub equations: Vec<Equation>,
    /// Residuals of each used run.
    pub lefts: Vec<RunResiduals>,
    /// Scatter of repeats.
    pub scatter: Scatter,
    /// Scatter and mean squares of the previous round, which the equations use.
    pub scatter_used: Scatter,
    /// See `scatter_used`.
    pub q2_used: Vec<f64>,
    /// Number of repeats of each used run, including the run itself.
    pub repeats: Vec<usize>,
    /// Degrees of freedom, counted in runs, that the fit took from each gauge.
    pub fitted: f64,
    /// Estimated error of the model in each gauge's row; empty without a model.
    pub row_errors: Vec<RowError>,
    /// Evidence for the model's error, gauge by gauge.
    pub error_evidence: Option<ErrorEvidence>,
    /// Gauges that are wired wrongly, which are excluded from the estimate of the model's error.
    pub wrongly_wired: Vec<usize>,
    /// Covariance of readings at any load from terms that the model lacks, `n x n` by rows; empty if none is found.
    pub lack: Vec<f64>,
}

impl State {
    /// Fits all used runs. `wrongly_wired` gauges do not contribute to the estimate of the model error. Returns `None` if numbers are not finite.
    pub fn fit_runs(task: &Task, used: &[usize], wrongly_wired: &[usize]) -> Option<Self> {
        let runs: Vec<&KnownRun> = used.iter().filter_map(|&r| task.runs.get(r)).collect();
        let (n, k) = (task.gauges.len(), task.loads.len());
        let scales = load_scales(task, &runs);
        let largest = runs
            .iter()
            .flat_map(|r| &r.strain)
            .filter(|v| v.is_finite())
            .fold(0.0_f64, |a, v| a.max(v.abs()));
        let alike = |r: &&KnownRun| runs.iter().filter(|o| o.group == r.group).count();
        let repeats: Vec<usize> = runs.iter().map(alike).collect();
        let without_model = diffuse_prior(n, k, largest);
        let begun = StartValues::from_runs(task, &runs, &scales, &without_model);
        let mut scatter = Scatter::none(n);
        let mut state: Option<Self> = None;
        for _ in 0..ROUNDS {
            let mean: Vec<Vec<f64>> = match (&state, &task.model) {
                (Some(s), _) => rows_of(&s.posterior),
                (None, Some(m)) => scaled_model_rows(m, &scales),
                (None, None) => begun.rows.clone(),
            };
            let mut freedom = 0.0;
            let (mut equations, mut by_gauge) = (Vec::new(), Vec::new());
            for (i, run) in runs.iter().enumerate() {
                let so_far = state.as_ref();
                let times = so_far.map(|s| s.lefts[i].q2 * scatter.design(repeats[i]));
                let free = begun
                    .unknown
                    .as_ref()
                    .map_or(FreeDirections::NONE, |u| u.free_directions(i));
                let made = equation(task, (run, free), &scales, &mean, &scatter, times)?;
                freedom += made.freedom / made.equation.gauges.len().max(1) as f64;
                by_gauge.push(given_others::by_gauge(&made.equation, &made.spread, &mean));
                equations.push(made.equation);
            }
            let error_evidence = task.model.as_ref();
            let error_evidence = error_evidence.map(|m| learn_error(m, &scales, by_gauge));
            let row_errors = error_evidence.as_ref();
            let row_errors = row_errors.map(|e| e.by_gauge(wrongly_wired));
            let prior = match (&task.model, &row_errors) {
                (Some(m), Some(e)) => rows(m, &scales, e.iter().copied().enumerate()),
                _ => begun.prior(&without_model),
            };
            let posterior = solve(&prior, &equations)?;
            let lefts: Vec<RunResiduals> = runs
                .iter()
                .zip(&equations)
                .map(|(run, e)| run_residuals(task, run, &posterior, &e.phi))
                .collect();
            let fitted = freedom + fitted_parameters_per_gauge(&posterior, &equations);
            let scatter_used = std::mem::replace(
                &mut scatter,
                Scatter::from_residuals(&lefts, fitted, &posterior.matrix()),
            );
            let q2_used = (0..runs.len())
                .map(|i| state.as_ref().map_or(0.0, |s| s.lefts[i].q2))
                .collect();
            state = Some(Self {
                scatter_used,
                q2_used,
                repeats: repeats.clone(),
                used: used.to_vec(),
                scales: scales.clone(),
                prior,
                posterior,
                equations,
                lefts,
                scatter: scatter.clone(),
                fitted,
                row_errors: row_errors.unwrap_or_default(),
                error_evidence,
                wrongly_wired: wrongly_wired.to_vec(),
                lack: Vec::new(),
            });
        }
        state
    }

    /// Returns S with its uncertainty, in job units of load.
    pub fn sensitivity(&self, task: &Task, factor: f64) -> Sensitivity {
        let of = (&self.scales[..], &self.posterior, &self.scatter);
        let mut s = sensitivity_of(task, of, factor, &self.lack);
        if let Some(uncertainty) = &mut s.uncertainty {
            uncertainty.one_by_one = self.is_one_by_one(task);
        }
        s
    }

    /// Returns whether S comes only from runs that scatter, each with one load, without a model.
    fn is_one_by_one(&self, task: &Task) -> bool {
        let k = task.loads.len();
        let acts = |run: &KnownRun, l: usize| {
            run.loads.mean[l] != 0.0 || run.loads.covariance[l * k + l] > 0.0
        };
        let own = task.own_loads();
        let alone = |r: &usize| (0..own).filter(|&l| acts(&task.runs[*r], l)).count() <= 1;
        task.model.is_none() && self.scatter.dof.is_finite() && self.used.iter().all(alone)
    }
}

/// Returns S of a posterior with the terms of its intervals, in job units of load. The columns are the loads of the job. The readings are relative to
/// the common zero. See [`State::lack`] for `lack`.
pub(super) fn sensitivity_of(
    task: &Task,
    (scales, posterior, scatter): (&[f64], &Posterior, &Scatter),
    factor: f64,
    lack: &[f64],
) -> Sensitivity {
    let (n, all) = (posterior.n, posterior.k);
    let k = task.own_loads();
    let order = n * all;
    let values = Matrix::from_fn(n, k, |g, l| posterior.mean[g * all + l] / scales[l]);
    let entries = || (0..n).flat_map(|g| (0..k).map(move |l| (g * all + l, scales[l])));
    let covariance = entries().flat_map(|(e, a)| {
        entries().map(move |(f, b)| posterior.covariance[e * order + f] / (a * b))
    });
    let mut additive = lack.to_vec();
    let mut center = Vec::new();
    if task.is_extended() {
        let centred = CentredPosterior::from_posterior(posterior);
        center = centred
            .center
            .iter()
            .zip(scales)
            .map(|(c, s)| c * s)
            .collect();
        additive.resize(n * n, 0.0);
        let both = additive.iter_mut().zip(&centred.covariance);
        both.for_each(|(a, c)| *a += c);
    }
    Sensitivity {
        gauges: task.gauges.clone(),
        loads: task.loads[..k].to_vec(),
        noise: task.gauge_noise.clone(),
        uncertainty: Some(Uncertainty {
            covariance: covariance.collect(),
            scatter: scatter.covariance.clone(),
            mean_square: mean_square(&values),
            scale: factor,
            dof: scatter.dof,
            dof_outside: scatter.dof_outside,
            one_by_one: false,
            additive,
            center,
            is_tested: true,
        }),
        values,
    }
}

/// Returns the size of each load. It is the root mean square over the runs in which the load acts, else `expected`, else the size of the other loads.
fn load_scales(task: &Task, runs: &[&KnownRun]) -> Vec<f64> {
    let rms = |l: usize| {
        let known: Vec<f64> = runs
            .iter()
            .filter_map(|r| r.loads.mean.get(l).copied())
            .filter(|f| *f != 0.0)
            .collect();
        (!known.is_empty())
            .then(|| (known.iter().map(|f| f * f).sum::<f64>() / known.len() as f64).sqrt())
    };
    let found: Vec<Option<f64>> = (0..task.loads.len())
        .map(|l| rms(l).or(task.loads[l].expected.filter(|e| *e > 0.0)))
        .collect();
    let known: Vec<f64> = found.iter().flatten().copied().collect();
    let other = if known.is_empty() {
        1.0
    } else {
        known.iter().sum::<f64>() / known.len() as f64
    };
    found.into_iter().map(|f| f.unwrap_or(other)).collect()
}

/// Rows of S by gauge.
fn rows_of(posterior: &Posterior) -> Vec<Vec<f64>> {
    let rows = posterior.mean.chunks_exact(posterior.k.max(1));
    rows.map(<[f64]>::to_vec).collect()
}

/// Returns the rows of the model by gauge at the nominal position, for loads of unit size.
fn scaled_model_rows(model: &ModelPrior, scales: &[f64]) -> Vec<Vec<f64>> {
    let none = RowError {
        common: 0.0,
        entries: [0.0; FLOORS.len()],
    };
    let all = rows(model, scales, (0..model.values.nrows()).map(|g| (g, none)));
    all.into_iter().map(|row| row.mean).collect()
}

/// Start values of a fit without a model.
struct StartValues {
    /// Rows of S; empty with a model.
    rows: Vec<Vec<f64>>,
    /// Directions of the loads that no run determines; `None` if there are no such directions.
    unknown: Option<UnknownDirections>,
}

impl StartValues {
    fn from_runs(task: &Task, runs: &[&KnownRun], scales: &[f64], prior: &[RowPrior]) -> Self {
        if task.model.is_some() {
            return Self {
                rows: Vec::new(),
                unknown: None,
            };
        }
        let unknown =
            Some(UnknownDirections::from_runs(runs, scales)).filter(UnknownDirections::is_any);
        let rows = match &unknown {
            Some(unknown) => from_parts(task, runs, unknown, prior),
            None => from_known(task, runs, scales, prior).map(|s| rows_of(&s)),
        };
        Self {
            rows: rows.unwrap_or_else(|| vec![vec![0.0; scales.len()]; prior.len()]),
            unknown,
        }
    }

    /// Returns the prior of the rows. Along directions that no run determines, S keeps its start value.
    fn prior(&self, without_model: &[RowPrior]) -> Vec<RowPrior> {
        let mut out = without_model.to_vec();
        if self.unknown.is_some() {
            for (prior, row) in out.iter_mut().zip(&self.rows) {
                prior.mean.clone_from(row);
            }
        }
        out
    }
}

/// Equation of a run for S.
struct RunEquation {
    equation: Equation,
    /// Degrees of freedom, counted in readings, that the correction of its loads takes.
    freedom: f64,
    /// Part of the equation's covariance that the loads' own error makes.
    spread: Vec<f64>,
}

/// Returns a run as an equation, with `times` the scatter.
fn equation(
    task: &Task,
    (run, free): (&KnownRun, FreeDirections),
    scales: &[f64],
    mean: &[Vec<f64>],
    scatter: &Scatter,
    times: Option<f64>,
) -> Option<RunEquation> {
    let n = task.gauges.len();
    let gauges: Vec<usize> = (0..n)
        .filter(|&g| run.strain.get(g).is_some_and(|v| v.is_finite()))
        .collect();
    let m = gauges.len();
    let noise = (task.noise * task.noise * run.noise_factor).max(f64::MIN_POSITIVE);
    let mut own = vec![0.0; m * m];
    for (i, g) in gauges.iter().enumerate() {
        for (j, h) in gauges.iter().enumerate() {
            own[i * m + j] = times.unwrap_or(0.0) * scatter.covariance[g * n + h]
                + noise * task.noise_between(*g, *h);
        }
    }
    let y: Vec<f64> = gauges.iter().map(|&g| run.strain[g]).collect();
    let s: Vec<Vec<f64>> = gauges.iter().map(|&g| mean[g].clone()).collect();
    let corrected = correct((&run.loads, free), scales, &s, &y, &own)?;
    let covariance = own.iter().zip(&corrected.spread);
    Some(RunEquation {
        equation: Equation {
            y: y.iter().zip(&corrected.shift).map(|(y, d)| y + d).collect(),
            covariance: covariance.map(|(a, b)| a + b).collect(),
            phi: corrected.phi,
            gauges,
        },
        freedom: corrected.freedom,
        spread: corrected.spread,
    })
}

/// Returns the residuals of a run at loads `phi`.
pub(super) fn run_residuals(
    task: &Task,
    run: &KnownRun,
    posterior: &Posterior,
    phi: &[f64],
) -> RunResiduals {
    let predicted = posterior.predict(phi);
    let of_loads = less_zero(&predicted, &zero_of(task, posterior));
    let n = predicted.len();
    let noise = task.noise * task.noise * run.noise_factor;
    RunResiduals {
        residual: run
            .strain
            .iter()
            .zip(&predicted)
            .map(|(y, p)| y - p)
            .collect(),
        q2: of_loads.iter().map(|p| p * p).sum::<f64>() / n.max(1) as f64,
        explained: (0..n)
            .map(|g| (noise * task.noise_between(g, g)).max(f64::MIN_POSITIVE))
            .collect(),
        group: run.group,
    }
}

/// Returns `sum_r trace(R_r^-1 A_r V A_r') / m_r`, with `m_r` the number of gauges in run `r`.
fn fitted_parameters_per_gauge(posterior: &Posterior, equations: &[Equation]) -> f64 {
    let one = |e: &Equation| -> Option<f64> {
        let inverse =
            crate::linalg::precision::Precision::from_covariance(&e.covariance, e.gauges.len())?;
        let spread = posterior.spread(&e.gauges, &e.phi);
        let m = e.gauges.len();
        let trace: f64 = (0..m * m)
            .map(|i| inverse.entry(i / m, i % m) * spread[i])
            .sum();
        Some(trace / m.max(1) as f64)
    };
    equations.iter().filter_map(one).sum()
}
