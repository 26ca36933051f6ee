//! Criterion of a layout, a concave function of its information matrix `M` (`k x k`), larger is better.
//!
//! | criterion | value | slope `G` |
//! |---|---|---|
//! | D | `ln det M` | `M^-1` |
//! | Ds | `ln det M - ln det M_nn` | `M^-1` minus the inverse of the nuisance block |
//! | linear | `-k ln tr(L M^-1)` | `k M^-1 L M^-1 / tr(L M^-1)` |
//!
//! For all three criteria, a layout `S` with information `M_S = P + sum a a'` satisfies `value(M_S) <= value(M) + q ln((tr(G P) + sum a' G a) / q)`,
//! where `q` is the degree. For D and Ds this is the inequality of the arithmetic and geometric means. For the linear criterion, convexity of `tr(L
//! M^-1)` along the ray through `M` gives `tr(L M_S^-1) >= tr(L M^-1)^2 / tr(M^-1 L M^-1 M_S)`.

use crate::linalg::spd;

/// Criterion that a layout maximises. [`Criterion::evaluate_at`] gives its value at an information matrix `M`.
///
/// # Example
/// ```
/// use strainbridge::placement::Criterion;
///
/// let m = [4.0, 1.0, 1.0, 2.0]; // det = 7
/// let value = |c: Criterion| c.evaluate_at(&m, 2).unwrap().value;
/// assert!((value(Criterion::D) - 7.0_f64.ln()).abs() < 1e-12);
/// // Only the second column is wanted: det M over the entry of the nuisance column.
/// assert!((value(Criterion::Ds(1)) - (7.0_f64 / 4.0).ln()).abs() < 1e-12);
/// // A-optimality: the sum of the variances, the trace of M^-1, is 6 / 7.
/// let a = value(Criterion::Linear(vec![1.0, 0.0, 0.0, 1.0]));
/// assert!((a + 2.0 * (6.0_f64 / 7.0).ln()).abs() < 1e-12);
/// // The slope of ln det M is M^-1.
/// let slope = Criterion::D.evaluate_at(&m, 2).unwrap().slope(2);
/// assert!((slope[0] - 2.0 / 7.0).abs() < 1e-12 && (slope[1] + 1.0 / 7.0).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Criterion {
    /// The determinant for all columns.
    #[default]
    D,
    /// The determinant for the wanted columns; that many leading columns are nuisance columns.
    Ds(usize),
    /// The smallest `tr(L M^-1)`, `L` `k x k` by rows, symmetric, not negative. A-optimality has a diagonal `L` (weighted variances of loads),
    /// I-optimality the mean of `b b'` over rows `b` whose prediction counts.
    Linear(Vec<f64>),
}

/// A criterion at an information matrix.
#[derive(Clone, Debug)]
pub struct Point {
    /// Value of the criterion.
    pub value: f64,
    /// Lower triangular `W` with `W' W = G`: the slope towards a row `a` is `d = |W a|^2`.
    pub root: Vec<f64>,
    /// `M^-1`.
    pub inverse: Vec<f64>,
    /// Ds: the inverse of the nuisance block, padded with zeros; linear: `M^-1 L M^-1`; D: empty.
    pub second: Vec<f64>,
    /// `tr(L M^-1)`; 0 for D and Ds.
    pub spread: f64,
}

impl Criterion {
    /// Returns the degree `q`: if `M` is multiplied by `t`, `value` increases by `q ln t`. So `exp(difference / q)` is an efficiency.
    pub fn degree(&self, k: usize) -> usize {
        match self {
            Self::Ds(nuisance) => k - self.n_nuisance_columns(k, *nuisance),
            _ => k,
        }
    }

    /// At least one column is requested.
    fn n_nuisance_columns(&self, k: usize, nuisance: usize) -> usize {
        nuisance.min(k.saturating_sub(1))
    }

    /// Returns value and slope at `m`. `None` if `m` is singular.
    pub fn evaluate_at(&self, m: &[f64], k: usize) -> Option<Point> {
        let l = spd::cholesky(m, k)?;
        let mut root = spd::inverse_lower(&l, k);
        let inverse = spd::gram_of_lower(&root, k);
        match self {
            Self::D => Some(Point {
                value: spd::log_det(&l, k),
                root,
                inverse,
                second: Vec::new(),
                spread: 0.0,
            }),
            Self::Ds(nuisance) => {
                let q = self.n_nuisance_columns(k, *nuisance);
                // The leading block of the factor is the factor of the leading block.
                let mut head = root.clone();
                head[q * k..].fill(0.0);
                let second = if q == 0 {
                    Vec::new()
                } else {
                    spd::gram_of_lower(&head, k)
                };
                root[..q * k].fill(0.0);
                Some(Point {
                    value: 2.0 * (q..k).map(|i| l[i * k + i].ln()).sum::<f64>(),
                    root,
                    inverse,
                    second,
                    spread: 0.0,
                })
            }
            Self::Linear(weights) => {
                let spread = spd::trace_of_product(weights, &inverse);
                let second = spd::product(&spd::product(&inverse, weights, k), &inverse, k);
                let slope: Vec<f64> = second.iter().map(|v| v * k as f64 / spread).collect();
                (spread > 0.0).then(|| Point {
                    value: -(k as f64) * spread.ln(),
                    root: spd::lower_root(&slope, k),
                    inverse,
                    second,
                    spread,
                })
            }
        }
    }
}

impl Point {
    /// Returns the slope `G`.
    pub fn slope(&self, k: usize) -> Vec<f64> {
        spd::gram_of_lower(&self.root, k)
    }
}
