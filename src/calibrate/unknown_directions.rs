//! Directions of the loads that the runs do not determine. A lorry on a scale gives the sum of its bays, not the load of each bay.
//!
//! Let `Z` be directions along which no run determines the loads. Then `S` and `S (1 + Z B)` explain all runs equally well for any `B`: the columns
//! along `Z` are known up to size and mixture. Only the sum is known, a functional of strain that these columns do not affect. The columns therefore
//! start from patterns of strain that the known sums leave (`start.rs`), and the loads along `Z` are free in each run ([`FreeDirections`]). The
//! covariance of S along `S Z B` keeps its prior width: recovered loads along `Z` are unknown, their sums are known.

use super::types::{KnownLoads, KnownRun, Task};
use crate::linalg::{Matrix, dense, spd};

/// Share of the largest eigenvalue of the loads' squares from which a combination counts as applied.
pub(super) const SPANNED: f64 = 1e-6;
/// Standard deviation of a load, divided by its size, from which the load counts as unknown.
pub(super) const UNKNOWN: f64 = 0.5;
/// Variance of a load along a free direction in a run, in units of its size squared and of the number of runs. All runs together then determine the
/// size of its column with an sd of five times that size, which is no information.
const FREE: f64 = 25.0;
/// Square of a sine under which two directions are one.
const SAME: f64 = 1e-6;

/// Known and unknown part of the loads of some runs, in loads of unit size.
pub(super) struct UnknownDirections {
    /// Known parts of the loads by run: the loads without their components along unknown directions.
    pub parts: Vec<Vec<f64>>,
    /// Orthonormal directions along which the known part of the loads is zero in every run.
    pub undetermined: Vec<Vec<f64>>,
    /// Orthonormal directions among `undetermined` along which the loads are unknown, by run.
    pub free: Vec<Vec<Vec<f64>>>,
    /// See [`FREE`].
    variance: f64,
}

/// Directions along which the loads of a run may be anything.
#[derive(Clone, Copy)]
pub(super) struct FreeDirections<'a> {
    /// Orthonormal, loads of unit size.
    pub directions: &'a [Vec<f64>],
    /// Variance along each.
    pub variance: f64,
}

impl UnknownDirections {
    /// Finds the unknown directions of these runs.
    pub fn from_runs(runs: &[&KnownRun], scales: &[f64]) -> Self {
        let k = scales.len();
        let mut gram = vec![0.0; k * k];
        let (mut parts, mut wide) = (Vec::new(), Vec::new());
        for run in runs {
            let directions = wide_directions(&run.loads, scales);
            let mut part: Vec<f64> = (run.loads.mean.iter().zip(scales))
                .map(|(f, c)| f / c)
                .collect();
            project_out(&mut part, &directions);
            spd::add_outer(&mut gram, &part, 1.0);
            parts.push(part);
            wide.push(directions);
        }
        let undetermined = null_space(&gram, k);
        let free = wide
            .iter()
            .map(|w| common_directions(&undetermined, w))
            .collect();
        Self {
            parts,
            undetermined,
            free,
            variance: FREE * runs.len() as f64,
        }
    }

    /// Returns whether the loads of any run are unknown along a direction that no run determines.
    pub fn is_any(&self) -> bool {
        self.free.iter().any(|f| !f.is_empty())
    }

    /// Returns the free directions of run number `i`.
    pub fn free_directions(&self, i: usize) -> FreeDirections<'_> {
        FreeDirections {
            directions: self.free.get(i).map_or(&[], Vec::as_slice),
            variance: self.variance,
        }
    }
}

impl FreeDirections<'_> {
    /// No free direction.
    pub const NONE: FreeDirections<'static> = FreeDirections {
        directions: &[],
        variance: 0.0,
    };

    /// Returns the covariance of loads `l` and `m`.
    pub fn covariance(&self, l: usize, m: usize) -> f64 {
        let each = self.directions.iter().map(|z| z[l] * z[m]);
        self.variance * each.sum::<f64>()
    }
}

/// Returns the directions along which the loads of a run, of unit size, have an sd of more than [`UNKNOWN`], orthonormal.
pub(super) fn wide_directions(loads: &KnownLoads, scales: &[f64]) -> Vec<Vec<f64>> {
    let k = scales.len();
    if loads.covariance.iter().all(|v| *v == 0.0) {
        return Vec::new();
    }
    let unit = Matrix::from_fn(k, k, |l, m| {
        loads.covariance[l * k + m] / (scales[l] * scales[m])
    });
    let Some(d) = dense::svd(&unit) else {
        return Vec::new();
    };
    let wide = (0..k).filter(|i| d.s[*i] > UNKNOWN * UNKNOWN);
    wide.map(|i| d.v.column(i).iter().copied().collect())
        .collect()
}

/// Returns the known value of a sum of loads (their numbers and factors) in a run of the task. Returns `None` if its standard deviation exceeds
/// `UNKNOWN` times the largest value of the sum in any run.
pub fn known_of(task: &Task, run: usize, terms: &[(usize, f64)]) -> Option<f64> {
    let k = task.loads.len();
    let value = |r: &KnownRun| -> f64 { terms.iter().map(|(l, c)| c * r.loads.mean[*l]).sum() };
    let largest = task.runs.iter().map(|r| value(r).abs());
    let largest = largest.fold(0.0, f64::max);
    let run = task.runs.get(run)?;
    let pairs = terms.iter().flat_map(|a| terms.iter().map(move |b| (a, b)));
    let variance: f64 = pairs
        .map(|((l, c), (m, d))| c * d * run.loads.covariance[l * k + m])
        .sum();
    (variance.max(0.0).sqrt() <= UNKNOWN * largest).then(|| value(run))
}

/// Removes from `x` its parts along orthonormal directions.
pub(super) fn project_out(x: &mut [f64], directions: &[Vec<f64>]) {
    for z in directions {
        let along = spd::dot(x, z);
        x.iter_mut().zip(z).for_each(|(x, z)| *x -= along * z);
    }
}

/// Returns whether two orthonormal sets have the same span.
pub(super) fn have_equal_span(a: &[Vec<f64>], b: &[Vec<f64>]) -> bool {
    a.len() == b.len() && common_directions(a, b).len() == a.len()
}

/// Returns the directions along which a `k x k` matrix of squares is zero.
fn null_space(gram: &[f64], k: usize) -> Vec<Vec<f64>> {
    let Some(d) = dense::svd(&Matrix::from_row_slice(k, k, gram)) else {
        return Vec::new();
    };
    let limit = SPANNED * d.s.first().copied().unwrap_or(0.0);
    let null = (0..k).filter(|&i| d.s[i] <= limit);
    null.map(|i| d.v.column(i).iter().copied().collect())
        .collect()
}

/// Returns the directions in the spans of both sets: the directions of `a` whose cosine with `b` is 1.
///
/// # Reference
/// G. H. Golub, C. F. Van Loan, Matrix Computations (4th ed.), section 6.4.3: principal angles.
fn common_directions(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<Vec<f64>> {
    if a.is_empty() || b.is_empty() {
        return Vec::new();
    }
    let cosines = Matrix::from_fn(b.len(), a.len(), |i, j| spd::dot(&b[i], &a[j]));
    let Some(d) = dense::svd(&cosines) else {
        return Vec::new();
    };
    let same = (0..d.s.len()).filter(|i| 1.0 - d.s[*i].powi(2) < SAME);
    let along = |i: usize| -> Vec<f64> {
        let entry = |l: usize| (0..a.len()).map(|j| a[j][l] * d.v[(j, i)]).sum();
        (0..a[0].len()).map(entry).collect()
    };
    same.map(along).collect()
}
