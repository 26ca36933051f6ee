//! Error of the model from the readings of the calibration runs: a common error of all gauges, and the error of each gauge.

use super::evidence::{NormalEquations, RowEvidence};
use super::given_others::ByGauge;
use super::prior::{FLOORS, RowError, RowPrior, rows};
use super::types::{ModelError, ModelPrior};
use rayon::prelude::*;

/// Number of steps from the stated error that are tried, in factors of the square root of two.
const STEPS: i32 = 8;
/// Uncertainty of the stated error, 1 sd of its natural logarithm: half or double is common.
const STATED_LN_SD: f64 = 0.7;
/// Degrees of freedom of Student's distribution over the gauges. Most rows of a model are better than its error. A few, where strain changes fast,
/// are off by several times as much. Four is the usual choice if few data cannot determine it.
///
/// # Reference
/// K. L. Lange, R. J. A. Little, J. M. G. Taylor, J. Am. Stat. Assoc. 84 (1989) 881.
const FREEDOM: f64 = 4.0;
/// Steps from the common error to a gauge's own error that are tried, in factors of the square root of two: 0.35 to 8 times. With [`FREEDOM`] of four
/// a gauge's error is smaller than this range once in 300 gauges, and larger once in 8,000.
const OWN_STEPS: std::ops::RangeInclusive<i32> = -3..=6;

/// Returns the factor on the relative error at a step.
fn factor(step: i32) -> f64 {
    2_f64.powf(f64::from(step) / 2.0)
}

/// Probability of each gauge's readings, for each tested relative error of the model.
#[derive(Clone, Debug)]
pub(super) struct ErrorEvidence {
    stated: ModelError,
    /// Normal equations of each gauge's row from the runs.
    pub normals: Vec<NormalEquations>,
    /// Data of each gauge, for each run.
    by_run: Vec<ByGauge>,
    tried: Vec<ErrorHypothesis>,
}

/// One relative error of the model.
#[derive(Clone, Debug)]
struct ErrorHypothesis {
    error: ModelError,
    /// Log of its prior.
    prior: f64,
    by_gauge: Vec<GaugeLikelihood>,
}

/// A gauge, given the error of all.
#[derive(Clone, Debug)]
struct GaugeLikelihood {
    /// Log marginal likelihood of the gauge's readings.
    log: f64,
    /// Error of the gauge's row: mean variance over all errors tried, weighted by their probability given the readings.
    error: RowError,
}

impl ErrorEvidence {
    /// Returns the most probable relative error of the model, given the readings of all gauges except `without`. It is the maximum of the marginal
    /// likelihood (separately for each gauge) times a log-normal prior around the stated error.
    pub fn most_probable(&self, without: &[usize]) -> ModelError {
        self.find_best_error(without)
            .map_or(self.stated, |t| t.error)
    }

    /// Returns the error of each gauge, given the most probable common error of all gauges except `without`. The gauges in `without` get the common
    /// error of all gauges instead.
    pub fn by_gauge(&self, without: &[usize]) -> Vec<RowError> {
        let (all, others) = (self.find_best_error(&[]), self.find_best_error(without));
        let one = |g: usize| {
            let error = if without.contains(&g) { all } else { others };
            error.map_or(self.stated.into(), |t| t.by_gauge[g].error)
        };
        (0..self.normals.len()).map(one).collect()
    }

    /// Returns the errors as [`ErrorEvidence::by_gauge`], computed without run number `left` of the evidence. The common error of all gauges is
    /// unchanged.
    pub fn by_gauge_without(
        &self,
        left: usize,
        model: &ModelPrior,
        scales: &[f64],
        without: &[usize],
    ) -> Vec<RowError> {
        let n = self.normals.len();
        let run = &self.by_run[left];
        let readings = run.y.iter().zip(&run.variance);
        let normals: Vec<NormalEquations> = (self.normals.iter().zip(readings))
            .map(|(normal, (y, v))| normal.without_reading(&run.phi, *y, *v))
            .collect();
        let own = own_steps();
        let errors: Vec<ModelError> = {
            let (all, others) = (self.most_probable(&[]), self.most_probable(without));
            let of = |g: usize| if without.contains(&g) { all } else { others };
            (0..n).map(of).collect()
        };
        let logs_of = |floor: usize, step: i32| -> Vec<f64> {
            let row = |g: usize| {
                let mut row = RowError {
                    common: errors[g].common * factor(step),
                    entries: [0.0; FLOORS.len()],
                };
                row.entries[floor] = errors[g].entry * factor(step);
                (g, row)
            };
            let rows = rows(model, scales, (0..n).map(row));
            let log = |(row, normal): (&RowPrior, &NormalEquations)| {
                let evidence = RowEvidence::from_row_prior(&row.mean, &row.covariance, normal);
                evidence.map_or(f64::NEG_INFINITY, |e| e.log())
            };
            rows.iter().zip(&normals).map(log).collect()
        };
        let all: Vec<Vec<Vec<f64>>> = (0..FLOORS.len())
            .map(|floor| own.iter().map(|o| logs_of(floor, o.0)).collect())
            .collect();
        (0..n)
            .map(|g| of_gauge(&own, errors[g], |floor, i| all[floor][i][g]).error)
            .collect()
    }

    fn find_best_error(&self, without: &[usize]) -> Option<&ErrorHypothesis> {
        let score = |t: &ErrorHypothesis| {
            let kept = t.by_gauge.iter().enumerate();
            let kept = kept.filter(|(g, _)| !without.contains(g));
            t.prior + kept.map(|(_, own)| own.log).sum::<f64>()
        };
        let mut best: Option<(f64, &ErrorHypothesis)> = None;
        for t in &self.tried {
            let score = score(t);
            if score > best.map_or(f64::NEG_INFINITY, |b| b.0) {
                best = Some((score, t));
            }
        }
        best.map(|b| b.1)
    }
}

/// Returns the evidence of the runs on the model's relative error.
///
/// A gauge's error is the common error times a factor for the gauge. It is proportional to the entries or to the row ([`FLOORS`]), with equal prior
/// probability. The probability of the gauge's readings is the mean over these cases.
///
/// `runs`: each with loads of unit size.
pub(super) fn error_evidence(
    model: &ModelPrior,
    scales: &[f64],
    runs: Vec<ByGauge>,
) -> ErrorEvidence {
    let stated = ModelError {
        common: model.uncertainty_rel,
        entry: model.uncertainty_rel,
    };
    let (n, k) = model.values.shape();
    let normals: Vec<NormalEquations> = (0..n)
        .map(|g| NormalEquations::from_runs(g, k, &runs))
        .collect();
    let tables: Vec<Table> = (0..FLOORS.len())
        .into_par_iter()
        .map(|floor| Table::compute(model, scales, &normals, floor))
        .collect();
    let own = own_steps();
    let steps: Vec<(i32, i32)> = (-STEPS..=STEPS)
        .flat_map(|common| (-STEPS..=STEPS).map(move |entry| (common, entry)))
        .collect();
    let tried = steps.into_par_iter().map(|(common, entry)| {
        let off = |step: i32| 0.5 * (factor(step).ln() / STATED_LN_SD).powi(2);
        let error = ModelError {
            common: stated.common * factor(common),
            entry: stated.entry * factor(entry),
        };
        ErrorHypothesis {
            error,
            prior: -off(common) - off(entry),
            by_gauge: (0..n)
                .map(|g| {
                    of_gauge(&own, error, |floor, i| {
                        let step = own[i].0;
                        tables[floor].log(common + step, entry + step, g)
                    })
                })
                .collect(),
        }
    });
    ErrorEvidence {
        tried: tried.collect(),
        stated,
        normals,
        by_run: runs,
    }
}

/// Returns each step of a gauge's own error with the log of its probability. Student's distribution of unit variance is a normal one with a random
/// variance `v`. The density of `v` is `v^(-FREEDOM / 2 - 1) exp(-(FREEDOM - 2) / (2 v))`. Multiplied by `v`, it is the density of `ln v`.
fn own_steps() -> Vec<(i32, f64)> {
    let log = |step: i32| {
        let v = factor(step).powi(2);
        -0.5 * FREEDOM * v.ln() - 0.5 * (FREEDOM - 2.0) / v
    };
    let total = OWN_STEPS.map(|step| log(step).exp()).sum::<f64>().ln();
    OWN_STEPS.map(|step| (step, log(step) - total)).collect()
}

/// Returns the evidence and error of a gauge for the common error `error`; `log`: log marginal likelihood of its readings by floor and step.
fn of_gauge(
    own: &[(i32, f64)],
    error: ModelError,
    log: impl Fn(usize, usize) -> f64,
) -> GaugeLikelihood {
    let floors = (FLOORS.len() as f64).ln();
    let steps = || own.iter().enumerate();
    let logs: Vec<Vec<f64>> = (0..FLOORS.len())
        .map(|floor| {
            steps()
                .map(|(i, (_, prior))| prior - floors + log(floor, i))
                .collect()
        })
        .collect();
    let largest = logs.iter().flatten().copied();
    let largest = largest.fold(f64::NEG_INFINITY, f64::max);
    let weight = |log: &f64| {
        if largest.is_finite() {
            (log - largest).exp()
        } else {
            0.0
        }
    };
    let total: f64 = logs.iter().flatten().map(weight).sum();
    // Entry for each floor: the mean square of the gauge's own factor at this floor, times the probability of the floor.
    let mut squares = [0.0; FLOORS.len()];
    for (square, logs) in squares.iter_mut().zip(&logs) {
        let each = logs.iter().zip(own);
        let each = each.map(|(log, (step, _))| weight(log) / total * factor(*step).powi(2));
        *square = if total > 0.0 {
            each.sum()
        } else {
            1.0 / FLOORS.len() as f64
        };
    }
    GaugeLikelihood {
        log: largest + total.ln(),
        error: RowError {
            common: error.common * squares.iter().sum::<f64>().sqrt(),
            entries: squares.map(|square| error.entry * square.sqrt()),
        },
    }
}

/// Log marginal likelihoods of each gauge's readings with one of the floors. The steps cover all products of the error common to all gauges and a
/// gauge's own error.
struct Table {
    logs: Vec<f64>,
    gauges: usize,
}

impl Table {
    const LEAST: i32 = -STEPS + *OWN_STEPS.start();
    const MOST: i32 = STEPS + *OWN_STEPS.end();

    fn compute(
        model: &ModelPrior,
        scales: &[f64],
        normals: &[NormalEquations],
        floor: usize,
    ) -> Self {
        let stated = model.uncertainty_rel;
        let (n, k) = model.values.shape();
        let drawn: Vec<Vec<f64>> = (0..n)
            .map(|g| (0..k).map(|l| model.values[(g, l)] * scales[l]).collect())
            .collect();
        let mut logs = Vec::new();
        for entry in Self::LEAST..=Self::MOST {
            let mut error = RowError {
                common: 0.0,
                entries: [0.0; FLOORS.len()],
            };
            error.entries[floor] = stated * factor(entry);
            let rows = rows(model, scales, (0..n).map(|g| (g, error)));
            // The common error of a gauge's row adds one direction. Its likelihood follows from a few products, because the other terms are known.
            let one = |((row, normal), s): ((&RowPrior, &NormalEquations), &Vec<f64>)| {
                let e = RowEvidence::from_row_prior(&row.mean, &row.covariance, normal)?;
                let (first, second) = e.orders(&[s.as_slice()]);
                Some((e.log(), *first.first()?, *second.first()?))
            };
            let all: Vec<_> = rows.iter().zip(normals).zip(&drawn).map(one).collect();
            for common in Self::LEAST..=Self::MOST {
                let variance = (stated * factor(common)).powi(2);
                logs.extend(all.iter().map(|row| {
                    row.map_or(f64::NEG_INFINITY, |(log, first, second)| {
                        let total = 1.0 + variance * second;
                        log + 0.5 * (variance * first * first / total - total.ln())
                    })
                }));
            }
        }
        Self { logs, gauges: n }
    }

    /// Returns the log marginal likelihood of gauge `g` at these steps of the errors; negative infinity outside the table.
    fn log(&self, common: i32, entry: i32, g: usize) -> f64 {
        let place = |step: i32| (step - Self::LEAST) as usize;
        let tries = place(Self::MOST) + 1;
        let at = (place(entry) * tries + place(common)) * self.gauges + g;
        self.logs.get(at).copied().unwrap_or(f64::NEG_INFINITY)
    }
}
