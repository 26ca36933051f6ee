//! Weight and position of a payload from gauges, some of which may be faulty, and from wheel forces, by expectation maximisation.
//!
//! The unknowns of a run are the wheel forces `R` if measured, the payload `p = (F, F dx, F dy)`, and the common error `c` of the model. If the
//! position is known, `p` contains only `F`. Every gauge has one noise level in all runs: the stated noise, or up to 10^4 times the stated noise.

use super::evidence::{PayloadModel, PayloadRun, Place, WeighSpec};
use super::one_run::{Balance, PayloadFit, solve_run};
use super::robust::{GOOD_FACTOR, LARGEST_FACTOR, N_LEVELS, PRIOR_AS_STATED};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Number of random starts. Each start gives a few gauges full weight and all other gauges a small weight.
const STARTS: usize = 24;
/// Steps of each start, and steps of the best start.
const STEPS: [usize; 2] = [8, 60];
/// Weight of the other gauges at a start.
const DOUBTED: f64 = 1e-6;

/// Result of all runs, with the state of the gauges.
#[derive(Clone, Debug)]
pub struct Location {
    /// Result for each run.
    pub runs: Vec<PayloadFit>,
    /// Probability that each gauge is as good as stated.
    pub good: Vec<f64>,
}

struct State {
    runs: Vec<PayloadFit>,
    weights: Vec<f64>,
    good: Vec<f64>,
    log_likelihood: f64,
}

/// Returns the most probable answer over many starts. `None` if the readings do not determine the weight.
pub fn locate(
    model: &PayloadModel,
    runs: &[PayloadRun],
    spec: &WeighSpec,
    balance: Balance,
) -> Option<Location> {
    let n = model.gauges.len();
    let unknown = if spec.place == Place::Free { 3 } else { 1 };
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let readable: Vec<usize> = (0..n)
        .filter(|g| {
            runs.iter()
                .any(|r| r.strain.get(*g).is_some_and(|v| v.is_finite()))
        })
        .collect();
    let mut starts: Vec<Vec<f64>> = vec![vec![1.0; n]];
    if runs.iter().any(|r| !r.reactions.is_empty()) {
        starts.push(vec![DOUBTED; n]);
    }
    for _ in 0..STARTS {
        let mut w = vec![DOUBTED; n];
        for _ in 0..unknown + 2 {
            if let Some(g) = readable.get(random.random_range(0..readable.len().max(1))) {
                w[*g] = 1.0;
            }
        }
        starts.push(w);
    }
    let states: Vec<(Vec<f64>, f64)> = starts
        .into_par_iter()
        .filter_map(|w| expectation_maximisation(model, runs, spec, balance, w, STEPS[0]))
        .map(|s| (s.weights, s.log_likelihood))
        .collect();
    let (weights, _) = states
        .into_iter()
        .fold(None::<(Vec<f64>, f64)>, |best, s| match best {
            Some(b) if b.1 >= s.1 => Some(b),
            _ => Some(s),
        })?;
    let end = expectation_maximisation(model, runs, spec, balance, weights, STEPS[1])?;
    Some(Location {
        runs: end.runs,
        good: end.good,
    })
}

/// Returns whether a run alone determines all unknowns.
pub fn determines_payload(model: &PayloadModel, run: &PayloadRun, spec: &WeighSpec) -> bool {
    let weights = vec![1.0; model.gauges.len()];
    solve_run(
        model,
        run,
        spec,
        Balance::Kept,
        &weights,
        &PayloadFit::zeros(),
    )
    .is_some()
}

fn expectation_maximisation(
    model: &PayloadModel,
    runs: &[PayloadRun],
    spec: &WeighSpec,
    balance: Balance,
    mut weights: Vec<f64>,
    steps: usize,
) -> Option<State> {
    let mut found: Vec<PayloadFit> = runs.iter().map(|_| PayloadFit::zeros()).collect();
    let mut before = f64::NEG_INFINITY;
    let mut end = None;
    for _ in 0..steps {
        let mut terms: Vec<[f64; N_LEVELS]> = vec![prior(); model.gauges.len()];
        let mut wheels = 0.0;
        for (run, old) in runs.iter().zip(found.iter_mut()) {
            let solved = solve_run(model, run, spec, balance, &weights, old)?;
            wheels += solved.wheels;
            for (g, variance, square) in solved.gauges {
                for (k, t) in terms[g].iter_mut().enumerate() {
                    let v = variance * level(k).powi(2);
                    *t -= 0.5 * (square / v + (TAU * v).ln());
                }
            }
            *old = solved.found;
        }
        let log_likelihood = wheels + terms.iter().map(|t| log_sum(t)).sum::<f64>();
        let good_levels = (0..N_LEVELS)
            .take_while(|k| level(*k) <= GOOD_FACTOR)
            .count();
        let mut good = Vec::with_capacity(terms.len());
        for (w, t) in weights.iter_mut().zip(&terms) {
            let total = log_sum(t);
            *w = t
                .iter()
                .enumerate()
                .map(|(k, t)| (t - total).exp() / level(k).powi(2))
                .sum();
            good.push((log_sum(&t[..good_levels]) - total).exp());
        }
        let settled = (log_likelihood - before).abs() < 1e-9 * log_likelihood.abs().max(1.0);
        before = log_likelihood;
        end = Some(State {
            runs: found.clone(),
            weights: weights.clone(),
            good,
            log_likelihood,
        });
        if settled {
            break;
        }
    }
    end
}

fn level(k: usize) -> f64 {
    LARGEST_FACTOR.powf(k as f64 / (N_LEVELS - 1) as f64)
}

fn prior() -> [f64; N_LEVELS] {
    std::array::from_fn(|k| {
        if k == 0 {
            PRIOR_AS_STATED.ln()
        } else {
            ((1.0 - PRIOR_AS_STATED) / (N_LEVELS - 1) as f64).ln()
        }
    })
}

fn log_sum(t: &[f64]) -> f64 {
    let top = t.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    top + t.iter().map(|v| (v - top).exp()).sum::<f64>().ln()
}
