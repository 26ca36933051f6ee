//! Gaussian posterior of all entries of S together.

use super::prior::RowPrior;
use crate::linalg::precision::Precision;
use crate::linalg::{Matrix, spd};

/// One run as an equation for S: `y = S phi + e`, `Cov e = covariance`, in loads of unit size.
#[derive(Clone, Debug)]
pub(super) struct Equation {
    /// Gauges that read, ascending.
    pub gauges: Vec<usize>,
    /// Strain of these gauges.
    pub y: Vec<f64>,
    /// Loads, each divided by its scale.
    pub phi: Vec<f64>,
    /// Covariance of the readings, by rows, over `gauges`.
    pub covariance: Vec<f64>,
}

/// Mean and covariance of S. Its columns are multiplied by the scales of the loads, so that entries are strain.
#[derive(Clone, Debug)]
pub(super) struct Posterior {
    pub n: usize,
    pub k: usize,
    /// Mean. Entry (g, l) is at `g k + l`.
    pub mean: Vec<f64>,
    /// Covariance, `(n k) x (n k)` by rows.
    pub covariance: Vec<f64>,
}

/// Returns the posterior with precision `blockdiag(P_g^-1) + sum_r R_r^-1 (x) phi_r phi_r'`. `None` if a covariance is not positive definite.
pub(super) fn solve(prior: &[RowPrior], equations: &[Equation]) -> Option<Posterior> {
    let n = prior.len();
    let k = prior.first().map_or(0, |p| p.mean.len());
    let order = n * k;
    if equations.iter().all(Equation::is_by_gauge) {
        return solve_by_gauge(prior, equations);
    }
    let mut information = vec![0.0; order * order];
    let mut right = vec![0.0; order];
    for (g, row) in prior.iter().enumerate() {
        let inverse = Precision::from_covariance(&row.covariance, k)?;
        let weighted = inverse.apply(&row.mean);
        for l in 0..k {
            right[g * k + l] += weighted[l];
            for m in 0..k {
                information[(g * k + l) * order + g * k + m] += inverse.entry(l, m);
            }
        }
    }
    for e in equations {
        let inverse = Precision::from_covariance(&e.covariance, e.gauges.len())?;
        let weighted = inverse.apply(&e.y);
        for (i, &g) in e.gauges.iter().enumerate() {
            for (l, p) in e.phi.iter().enumerate() {
                right[g * k + l] += weighted[i] * p;
                if *p == 0.0 {
                    continue;
                }
                for (j, &h) in e.gauges.iter().enumerate() {
                    let w = inverse.entry(i, j) * p;
                    let row = (g * k + l) * order + h * k;
                    for (slot, q) in information[row..row + k].iter_mut().zip(&e.phi) {
                        *slot += w * q;
                    }
                }
            }
        }
    }
    let lower = Precision::from_covariance(&information, order)?;
    let mean = lower.apply(&right);
    let covariance = (0..order * order)
        .map(|i| lower.entry(i / order, i % order))
        .collect();
    Some(Posterior {
        n,
        k,
        mean,
        covariance,
    })
}

/// Computes the posterior of [`solve`] row by row, for errors that are independent between gauges.
fn solve_by_gauge(prior: &[RowPrior], equations: &[Equation]) -> Option<Posterior> {
    let n = prior.len();
    let k = prior.first().map_or(0, |p| p.mean.len());
    let order = n * k;
    let mut rows: Vec<(Vec<f64>, Vec<f64>)> = Vec::with_capacity(n);
    for row in prior {
        let inverse = Precision::from_covariance(&row.covariance, k)?;
        let information = (0..k * k).map(|i| inverse.entry(i / k, i % k)).collect();
        rows.push((information, inverse.apply(&row.mean)));
    }
    for e in equations {
        let m = e.gauges.len();
        for (i, (&g, y)) in e.gauges.iter().zip(&e.y).enumerate() {
            let variance = e.covariance[i * m + i];
            if variance.is_nan() || variance <= 0.0 {
                return None;
            }
            let (information, right) = rows.get_mut(g)?;
            spd::add_outer(information, &e.phi, 1.0 / variance);
            for (slot, p) in right.iter_mut().zip(&e.phi) {
                *slot += p * y / variance;
            }
        }
    }
    let mut out = Posterior {
        n,
        k,
        mean: Vec::with_capacity(order),
        covariance: vec![0.0; order * order],
    };
    for (g, (information, right)) in rows.iter().enumerate() {
        let found = Precision::from_covariance(information, k)?;
        out.mean.extend(found.apply(right));
        for l in 0..k {
            for m in 0..k {
                out.covariance[(g * k + l) * order + g * k + m] = found.entry(l, m);
            }
        }
    }
    Some(out)
}

impl Equation {
    /// Returns whether the errors of the readings are independent of each other.
    pub fn is_by_gauge(&self) -> bool {
        let step = self.gauges.len() + 1;
        let mut entries = self.covariance.iter().enumerate();
        entries.all(|(at, c)| *c == 0.0 || at % step == 0)
    }
}

impl Posterior {
    /// Returns S, `n x k`, for loads of unit size.
    pub fn matrix(&self) -> Matrix {
        Matrix::from_row_slice(self.n, self.k, &self.mean)
    }

    /// Returns `S phi` by gauge.
    pub fn predict(&self, phi: &[f64]) -> Vec<f64> {
        self.mean
            .chunks_exact(self.k.max(1))
            .map(|row| row.iter().zip(phi).map(|(s, p)| s * p).sum())
            .collect()
    }

    /// Returns `V A'` for the equations `S phi` of some gauges: `(n k) x gauges`, by columns.
    fn columns(&self, gauges: &[usize], phi: &[f64]) -> Vec<Vec<f64>> {
        let (k, order) = (self.k, self.n * self.k);
        let column = |g: &usize| -> Vec<f64> {
            let mut out = vec![0.0; order];
            for (l, p) in phi.iter().enumerate().filter(|(_, p)| **p != 0.0) {
                let row = (g * k + l) * order;
                for (o, c) in out.iter_mut().zip(&self.covariance[row..row + order]) {
                    *o += p * c;
                }
            }
            out
        };
        gauges.iter().map(column).collect()
    }

    /// Returns the covariance of `S phi` over some gauges, by rows.
    pub fn spread(&self, gauges: &[usize], phi: &[f64]) -> Vec<f64> {
        let columns = self.columns(gauges, phi);
        project(&columns, gauges, phi, self.k)
    }

    /// Returns the posterior without one equation. `None` if the other equations do not determine S.
    ///
    /// `s' = s - V A' M^-1 (y - A s)`, `V' = V + V A' M^-1 A V`, `M = R - A V A'`.
    pub fn without_equation(&self, e: &Equation) -> Option<Self> {
        let m = e.gauges.len();
        let columns = self.columns(&e.gauges, &e.phi);
        let spread = project(&columns, &e.gauges, &e.phi, self.k);
        let rest: Vec<f64> = e
            .covariance
            .iter()
            .zip(&spread)
            .map(|(r, h)| r - h)
            .collect();
        let root = spd::inverse_lower(&spd::cholesky(&rest, m)?, m);
        let all = self.predict(&e.phi);
        let left: Vec<f64> = e
            .gauges
            .iter()
            .zip(&e.y)
            .map(|(g, y)| y - all[*g])
            .collect();
        let white: Vec<f64> = (0..m)
            .map(|i| spd::dot(&root[i * m..i * m + i + 1], &left[..=i]))
            .collect();
        let order = self.n * self.k;
        // Rows of L^-1 A V.
        let rows: Vec<Vec<f64>> = (0..m)
            .map(|i| {
                let mut row = vec![0.0; order];
                for (j, column) in columns.iter().enumerate().take(i + 1) {
                    let w = root[i * m + j];
                    if w == 0.0 {
                        continue;
                    }
                    row.iter_mut().zip(column).for_each(|(r, c)| *r += w * c);
                }
                row
            })
            .collect();
        let mut out = self.clone();
        for (row, w) in rows.iter().zip(&white) {
            for (s, r) in out.mean.iter_mut().zip(row) {
                *s -= w * r;
            }
            add_outer_within(&mut out.covariance, row);
        }
        Some(out)
    }
}

/// Adds `x x'` to `a`. `x` is zero outside one stretch, which is a single gauge if errors are independent across gauges.
fn add_outer_within(a: &mut [f64], x: &[f64]) {
    let order = x.len();
    let from = x.iter().position(|v| *v != 0.0).unwrap_or(order);
    let to = x.iter().rposition(|v| *v != 0.0).map_or(from, |i| i + 1);
    let stretch = &x[from..to];
    for (row, &xi) in a.chunks_exact_mut(order.max(1)).skip(from).zip(stretch) {
        for (v, &xj) in row[from..to].iter_mut().zip(stretch) {
            *v += xi * xj;
        }
    }
}

/// Returns `A V A'` from the columns of `V A'`.
fn project(columns: &[Vec<f64>], gauges: &[usize], phi: &[f64], k: usize) -> Vec<f64> {
    let entry = |h: usize, column: &[f64]| -> f64 {
        let row = column.get(h * k..(h + 1) * k).unwrap_or(&[]);
        row.iter().zip(phi).map(|(c, p)| c * p).sum()
    };
    let pairs = columns
        .iter()
        .flat_map(|c| gauges.iter().map(move |h| (c, *h)));
    pairs.map(|(c, h)| entry(h, c)).collect()
}
