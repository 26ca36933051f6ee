//! Prior of the rows of S: the model with its relative error, or next to nothing.

use super::evidence::{Normal, RowEvidence};
use super::types::{KnownRun, ModelError, ModelPrior};

/// Prior of one row, in loads of unit size.
#[derive(Clone, Debug)]
pub(super) struct RowPrior {
    /// Strain by load.
    pub mean: Vec<f64>,
    /// `k x k` by rows.
    pub covariance: Vec<f64>,
}

/// Standard deviation of an entry without a model over the largest strain measured: knows nothing, and still inverts.
const DIFFUSE: f64 = 100.0;
/// Error of an entry near zero over the row's root mean square, in units of the relative error: an entry that is zero in the model is not
/// known exactly.
const ENTRY_FLOOR: f64 = 0.1;

/// Without a model.
pub(super) fn diffuse(n: usize, k: usize, largest_strain: f64) -> Vec<RowPrior> {
    let sd = DIFFUSE * largest_strain;
    let row = RowPrior {
        mean: vec![0.0; k],
        covariance: (0..k * k)
            .map(|i| if i / k == i % k { sd * sd } else { 0.0 })
            .collect(),
    };
    vec![row; n]
}

/// With a model: `common^2 s s' + entry^2 diag(s^2) + sum sd^2 t t'`, `s` the row and `t` its change with each move of the gauge.
pub(super) fn rows(model: &ModelPrior, scales: &[f64], error: ModelError) -> Vec<RowPrior> {
    let (n, k) = model.values.shape();
    let all: f64 = (0..n)
        .flat_map(|g| (0..k).map(move |l| (g, l)))
        .map(|(g, l)| (model.values[(g, l)] * scales[l]).powi(2))
        .sum::<f64>()
        / (n * k).max(1) as f64;
    (0..n)
        .map(|g| {
            let s: Vec<f64> = (0..k).map(|l| model.values[(g, l)] * scales[l]).collect();
            let own = s.iter().map(|v| v * v).sum::<f64>() / k.max(1) as f64;
            let floor = ENTRY_FLOOR * ENTRY_FLOOR * own.max(ENTRY_FLOOR * ENTRY_FLOOR * all);
            let mut covariance = vec![0.0; k * k];
            for l in 0..k {
                for m in 0..k {
                    let moved = model.moves.iter().map(|t| {
                        let change = t.change[(g, l)] * scales[l] * t.change[(g, m)] * scales[m];
                        t.sd * t.sd * change
                    });
                    covariance[l * k + m] = error.common.powi(2) * s[l] * s[m] + moved.sum::<f64>();
                }
                covariance[l * k + l] += error.entry.powi(2) * (s[l] * s[l]).max(floor);
            }
            let drawn = |l: usize| {
                let at = model.moves.iter().map(|t| t.change[(g, l)] * t.at[g]);
                s[l] - scales[l] * at.sum::<f64>()
            };
            RowPrior {
                mean: (0..k).map(drawn).collect(),
                covariance,
            }
        })
        .collect()
}

/// Steps from the stated error, in factors of the square root of two, that are tried.
const STEPS: i32 = 8;
/// How far the stated error may be off, 1 sd of its natural logarithm: half or double is common.
const STATED_LN_SD: f64 = 0.7;

/// How probable each gauge's readings are with each relative error of the model that is tried.
#[derive(Clone, Debug)]
pub(super) struct ErrorEvidence {
    stated: ModelError,
    /// What the runs say of each gauge's row.
    pub normals: Vec<Normal>,
    /// Error, log of its prior, log marginal likelihood by gauge.
    tried: Vec<(ModelError, f64, Vec<f64>)>,
}

impl ErrorEvidence {
    /// The relative error of the model that the readings of all gauges but some make most probable, near the stated one: maximum of the
    /// marginal likelihood (each gauge by itself) times a log-normal prior around what was stated.
    pub fn most_probable(&self, without: &[usize]) -> ModelError {
        let mut best = (f64::NEG_INFINITY, self.stated);
        for (error, prior, by_gauge) in &self.tried {
            let kept = by_gauge.iter().enumerate();
            let kept = kept.filter(|(g, _)| !without.contains(g));
            let score = prior + kept.map(|(_, v)| v).sum::<f64>();
            if score > best.0 {
                best = (score, *error);
            }
        }
        best.1
    }
}

/// The evidence of the runs on the model's relative error.
///
/// `variance[r][g]`: variance of the reading of gauge g in run r, S aside; `phi[r]`: its loads of unit size.
pub(super) fn error_evidence(
    model: &ModelPrior,
    scales: &[f64],
    runs: &[&KnownRun],
    phi: &[Vec<f64>],
    variance: &[Vec<f64>],
) -> ErrorEvidence {
    let stated = ModelError {
        common: model.uncertainty_rel,
        entry: model.uncertainty_rel,
    };
    let (n, k) = model.values.shape();
    let normals: Vec<Normal> = (0..n)
        .map(|g| Normal::of(g, k, runs, phi, variance))
        .collect();
    let step = |i: i32| 2f64.powf(f64::from(i) / 2.0);
    let drawn: Vec<Vec<f64>> = (0..n)
        .map(|g| (0..k).map(|l| model.values[(g, l)] * scales[l]).collect())
        .collect();
    // The part common to a gauge is one direction more: with what is known of the rest it costs a few products.
    let of_entry = |j: i32| -> Vec<Option<(f64, f64, f64)>> {
        let error = ModelError {
            common: 0.0,
            entry: stated.entry * step(j),
        };
        let rows = rows(model, scales, error);
        let one = |((row, normal), s): ((&RowPrior, &Normal), &Vec<f64>)| {
            let e = RowEvidence::of(&row.mean, &row.covariance, normal)?;
            let (first, second) = e.orders(&[s.as_slice()]);
            Some((e.log(), *first.first()?, *second.first()?))
        };
        rows.iter().zip(&normals).zip(&drawn).map(one).collect()
    };
    let by_entry: Vec<_> = (-STEPS..=STEPS).map(|j| (j, of_entry(j))).collect();
    let mut tried = Vec::new();
    for i in -STEPS..=STEPS {
        for (j, rows) in &by_entry {
            let error = ModelError {
                common: stated.common * step(i),
                entry: stated.entry * step(*j),
            };
            let off = |i: i32| 0.5 * (step(i).ln() / STATED_LN_SD).powi(2);
            let variance = error.common * error.common;
            let with_common = |row: &Option<(f64, f64, f64)>| {
                row.map_or(f64::NEG_INFINITY, |(log, first, second)| {
                    let total = 1.0 + variance * second;
                    log + 0.5 * (variance * first * first / total - total.ln())
                })
            };
            let by_gauge = rows.iter().map(with_common).collect();
            tried.push((error, -off(i) - off(*j), by_gauge));
        }
    }
    ErrorEvidence {
        stated,
        normals,
        tried,
    }
}
