//! Inputs and results of a relaxation.

use super::criterion::{Criterion, Point};

/// Weight below which a row counts as unused, and slack below which a group counts as full.
pub(super) const FULL: f64 = 1e-12;

/// Rows of a relaxation.
#[derive(Clone, Debug, Default)]
pub struct Active {
    /// Number of columns.
    pub k: usize,
    /// Criterion to maximise.
    pub criterion: Criterion,
    /// `n x k` by rows.
    pub rows: Vec<f64>,
    /// Group of each row, `0 .. n_groups`.
    pub group: Vec<u32>,
    /// Number of groups.
    pub n_groups: usize,
}

impl Active {
    /// Returns the number of rows.
    pub fn len(&self) -> usize {
        self.group.len()
    }

    /// Returns whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.group.is_empty()
    }

    /// Returns row `i`.
    pub fn row(&self, i: usize) -> &[f64] {
        &self.rows[i * self.k..(i + 1) * self.k]
    }
}

/// A solution of the relaxation over a list of rows.
#[derive(Clone, Debug)]
pub struct RelaxationSolution {
    /// Weights.
    pub weights: Vec<f64>,
    /// Criterion at `M`. Its slope towards a row is `d = |root a|^2`.
    pub point: Point,
    /// `tr(G P)`, `G = root' root`.
    pub prior_trace: f64,
    /// Slopes towards the rows.
    pub d: Vec<f64>,
    /// Gap: upper bound of the criterion over these rows minus its value, divided by its degree.
    pub gap: f64,
    /// Number of sweeps.
    pub sweeps: usize,
}

impl RelaxationSolution {
    /// Returns the criterion at the relaxed solution.
    pub fn value(&self) -> f64 {
        self.point.value
    }
}

/// Returns by row the difference between its slope and the least slope of a row whose weight it can take. A row can take the weight of any row if its
/// group is not full, otherwise only of rows in its group.
pub(super) fn pulls(active: &Active, weights: &[f64], d: &[f64]) -> Vec<f64> {
    let mut slack = vec![1.0; active.n_groups];
    let mut least = vec![f64::INFINITY; active.n_groups];
    let mut all = f64::INFINITY;
    for ((&g, &w), &d) in active.group.iter().zip(weights).zip(d) {
        let g = g as usize;
        slack[g] -= w;
        if w > 0.0 {
            least[g] = least[g].min(d);
            all = all.min(d);
        }
    }
    active
        .group
        .iter()
        .zip(d)
        .map(|(&g, &d)| {
            let g = g as usize;
            d - if slack[g] > FULL { all } else { least[g] }
        })
        .collect()
}
