//! The linear Gaussian model with many rows and few columns: whitened columns of unit variance, some with a prior.

use crate::linalg::tall::{solve, triangle};

/// Column of whitened rows and the prior of its coefficient (mean 0).
#[derive(Clone, Debug)]
pub struct PriorColumn {
    /// Entries of the column, each divided by the standard deviation of its reading.
    pub rows: Vec<f64>,
    /// Standard deviation of the coefficient; `None` if there is no prior.
    pub prior: Option<f64>,
}

/// Solution of the model for one target.
#[derive(Clone, Debug)]
pub struct TargetSolution {
    /// Coefficient of each column.
    pub x: Vec<f64>,
    /// Covariance of the coefficients `(A'A)^-1`, by rows.
    pub covariance: Vec<Vec<f64>>,
    /// Squared residual of the data rows.
    pub chi2: f64,
    /// Sum of the squared coefficients, each divided by the variance of its prior.
    pub penalty: f64,
    /// Residual: `target - A x` of the data rows, then the residual of the priors.
    pub residual: Vec<f64>,
}

/// Returns the coefficients that minimise `|A x - target|^2 + sum (x / prior)^2`.
pub fn solve_with_priors(columns: &[PriorColumn], target: &[f64]) -> TargetSolution {
    let n = columns.len();
    let priors: Vec<usize> = (0..n).filter(|&i| columns[i].prior.is_some()).collect();
    let mut all: Vec<Vec<f64>> = columns.iter().map(|c| c.rows.clone()).collect();
    for (i, column) in all.iter_mut().enumerate() {
        for &p in &priors {
            column.push(if p == i {
                1.0 / columns[i]
                    .prior
                    .unwrap_or(f64::INFINITY)
                    .max(f64::MIN_POSITIVE)
            } else {
                0.0
            });
        }
    }
    let mut y = target.to_vec();
    y.extend(vec![0.0; priors.len()]);
    let mut list: Vec<(usize, &[f64])> = all
        .iter()
        .enumerate()
        .map(|(i, c)| (i, c.as_slice()))
        .collect();
    list.push((n, &y));
    let t = triangle(&list);
    let s = solve(&[(1.0, &t)], n);
    let mut residual = target.to_vec();
    for (c, x) in columns.iter().zip(&s.x) {
        residual
            .iter_mut()
            .zip(&c.rows)
            .for_each(|(r, a)| *r -= a * x);
    }
    let chi2 = residual.iter().map(|r| r * r).sum();
    residual.extend(priors.iter().map(|&p| match columns[p].prior {
        Some(sd) => -s.x[p] / sd,
        None => 0.0,
    }));
    TargetSolution {
        chi2,
        penalty: columns
            .iter()
            .zip(&s.x)
            .filter_map(|(c, x)| c.prior.map(|p| (x / p).powi(2)))
            .sum(),
        x: s.x,
        covariance: s.inverse,
        residual,
    }
}

/// Orthonormal basis of columns, priors included, for the gain of further columns.
#[derive(Clone, Debug)]
pub struct Basis {
    columns: Vec<Vec<f64>>,
    n_priors: usize,
}

impl Basis {
    /// Returns the basis of the columns of a solved model.
    pub fn from_columns(columns: &[PriorColumn]) -> Self {
        let priors: Vec<usize> = (0..columns.len())
            .filter(|&i| columns[i].prior.is_some())
            .collect();
        let mut out = Self {
            columns: vec![],
            n_priors: priors.len(),
        };
        for (i, c) in columns.iter().enumerate() {
            let mut rows = c.rows.clone();
            rows.extend(priors.iter().map(|&p| match (p == i, c.prior) {
                (true, Some(sd)) => 1.0 / sd,
                _ => 0.0,
            }));
            out.join(rows);
        }
        out
    }

    /// Returns the orthonormal columns. The rows of the priors follow the rows of the readings.
    pub fn columns(&self) -> &[Vec<f64>] {
        &self.columns
    }

    /// Adds the part of a column that other columns do not span. Returns false if there is no such part.
    fn join(&mut self, mut rows: Vec<f64>) -> bool {
        let before = norm(&rows);
        self.reduce(&mut rows);
        let after = norm(&rows);
        if after.is_nan() || after <= 1e-8 * before {
            return false;
        }
        rows.iter_mut().for_each(|v| *v /= after);
        self.columns.push(rows);
        true
    }

    fn reduce(&self, rows: &mut [f64]) {
        for _ in 0..2 {
            for q in &self.columns {
                let dot: f64 = q.iter().zip(rows.iter()).map(|(a, b)| a * b).sum();
                rows.iter_mut().zip(q).for_each(|(r, q)| *r -= dot * q);
            }
        }
    }

    /// Returns the norm of the part of a column that other columns do not span. It is the reciprocal of the standard deviation of the coefficient.
    pub fn left_of(&self, column: &[f64]) -> f64 {
        let mut c = column.to_vec();
        c.extend(vec![0.0; self.n_priors]);
        let before = norm(&c);
        self.reduce(&mut c);
        let after = norm(&c);
        if after <= 1e-7 * before { 0.0 } else { after }
    }

    /// Returns the reduction of the squared residual by each further free column in sequence, and the coefficient of the first column.
    pub fn gain(&self, residual: &[f64], further: &[Vec<f64>]) -> (f64, f64) {
        let mut own = Self {
            columns: vec![],
            n_priors: 0,
        };
        let mut total = 0.0;
        let mut first = 0.0;
        for (i, rows) in further.iter().enumerate() {
            let mut c = rows.clone();
            c.extend(vec![0.0; self.n_priors]);
            let before = norm(&c);
            self.reduce(&mut c);
            own.reduce(&mut c);
            let after = norm(&c);
            if after.is_nan() || after <= 1e-7 * before {
                continue;
            }
            let dot: f64 = c.iter().zip(residual).map(|(a, b)| a * b).sum();
            total += (dot / after).powi(2);
            if i == 0 {
                first = dot / (after * after);
            }
            c.iter_mut().for_each(|v| *v /= after);
            own.columns.push(c);
        }
        (total, first)
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}
