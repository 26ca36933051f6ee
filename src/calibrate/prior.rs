//! Prior of the rows of S: the model with its relative error, or a prior with almost no information.

use super::types::{ModelError, ModelPrior};

/// Prior of one row, in loads of unit size.
#[derive(Clone, Debug)]
pub(super) struct RowPrior {
    /// Strain by load.
    pub mean: Vec<f64>,
    /// `k x k` by rows.
    pub covariance: Vec<f64>,
}

/// Standard deviation of an entry without a model over the largest strain measured: no information, but invertible.
const DIFFUSE: f64 = 100.0;
/// Shares of a row's root mean square below which an entry's error no longer falls with the entry. The first is for errors proportional to the
/// entries, such as errors of a stiffness. An entry that is zero in the model is not known exactly. The second, the root mean square itself, is for
/// errors proportional to all the strain around the gauge, such as mesh errors. The errors of all entries below it are equal.
pub(super) const FLOORS: [f64; 2] = [0.1, 1.0];
/// Share of the root mean square of all rows that replaces the root mean square of a smaller row. A smaller row gives no scale for entries near zero.
const SMALL_ROW: f64 = 0.1;

/// Error of one row, 1 sd.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowError {
    /// Error that is common to the gauge.
    pub common: f64,
    /// Separate error of each entry, with a part for each of [`FLOORS`].
    pub entries: [f64; FLOORS.len()],
}

impl From<ModelError> for RowError {
    /// Splits the variance of the entries equally between both floors.
    fn from(error: ModelError) -> Self {
        Self {
            common: error.common,
            entries: FLOORS.map(|_| error.entry / (FLOORS.len() as f64).sqrt()),
        }
    }
}

/// Returns the prior of the rows without a model.
pub(super) fn diffuse_prior(n: usize, k: usize, largest_strain: f64) -> Vec<RowPrior> {
    let sd = DIFFUSE * largest_strain;
    let row = RowPrior {
        mean: vec![0.0; k],
        covariance: (0..k * k)
            .map(|i| if i / k == i % k { sd * sd } else { 0.0 })
            .collect(),
    };
    vec![row; n]
}

/// Returns the prior of each row from a model. The covariance of a row is `common^2 s s' + sum entry^2 diag(max(s^2, floor^2 q^2)) + sum sd^2 t t'`.
/// `s` is the row, `q` its root mean square, and `t` its change with each move of the gauge. The first sum is over [`FLOORS`], and the errors are the
/// errors of the gauge.
pub(super) fn rows(
    model: &ModelPrior,
    scales: &[f64],
    errors: impl IntoIterator<Item = (usize, RowError)>,
) -> Vec<RowPrior> {
    let (n, k) = model.values.shape();
    let all: f64 = (0..n)
        .flat_map(|g| (0..k).map(move |l| (g, l)))
        .map(|(g, l)| (model.values[(g, l)] * scales[l]).powi(2))
        .sum::<f64>()
        / (n * k).max(1) as f64;
    let row = |(g, error): (usize, RowError)| {
        let s: Vec<f64> = (0..k).map(|l| model.values[(g, l)] * scales[l]).collect();
        let own = s.iter().map(|v| v * v).sum::<f64>() / k.max(1) as f64;
        let own = own.max(SMALL_ROW * SMALL_ROW * all);
        let mut covariance = vec![0.0; k * k];
        for l in 0..k {
            for m in 0..k {
                let moved = model.moves.iter().map(|t| {
                    let change = t.change[(g, l)] * scales[l] * t.change[(g, m)] * scales[m];
                    t.sd * t.sd * change
                });
                covariance[l * k + m] = error.common.powi(2) * s[l] * s[m] + moved.sum::<f64>();
            }
            let parts = error.entries.iter().zip(FLOORS);
            let parts = parts.map(|(e, floor)| e * e * (s[l] * s[l]).max(floor * floor * own));
            covariance[l * k + l] += parts.sum::<f64>();
        }
        let drawn = |l: usize| {
            let at = model.moves.iter().map(|t| t.change[(g, l)] * t.at[g]);
            s[l] - scales[l] * at.sum::<f64>()
        };
        RowPrior {
            mean: (0..k).map(drawn).collect(),
            covariance,
        }
    };
    errors.into_iter().map(row).collect()
}
