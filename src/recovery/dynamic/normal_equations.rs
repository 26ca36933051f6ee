//! Normal equations of the estimate of modes, from sums of products over parts of a record.

use crate::linalg::{Matrix, Vector};
use std::ops::Range;

/// Sums of products over part of the record. Columns are the derivatives by parameter, the residual, and the residual without modes.
#[derive(Clone)]
pub(super) struct Products {
    /// Products of loads and motions of the `m` modes with each other, `(k + m) x (k + m)`.
    pub loads: Matrix,
    /// Loads and motions with columns by gauge, `(k + m) x (p + 2)`.
    pub by_gauge: Vec<Matrix>,
    /// Columns with columns, `(p + 2) x (p + 2)`, sum over the gauges.
    pub columns: Matrix,
    pub samples: f64,
}

/// Normal equations at one set of parameters.
pub(super) struct Normal {
    /// Derivatives with derivatives, and with the residual.
    pub matrix: Matrix,
    pub right: Vector,
    /// Sum of squares of the residual, also without the modes.
    pub squares: f64,
    pub squares_without: f64,
    /// Sum of squares of the part of the residual that the modes remove.
    pub squares_of_motion: f64,
    /// Gradient of each part of the record, after the best linear step.
    pub gradients: Vec<Vector>,
    /// Covariance of the gradient from errors of the modes' strain, `p x p`.
    pub by_shape: Matrix,
    /// Samples times residual degrees of freedom.
    pub freedom: f64,
    /// Share of white noise in the band.
    pub band: f64,
}

/// Strain of the modes with parameters at the gauges.
pub(super) struct Shapes {
    /// Strain of each mode at each gauge.
    pub strain: Vec<Vec<f64>>,
    /// One standard deviation, as a share of the strain.
    pub sd: f64,
    pub n_loads: usize,
}

impl Products {
    /// Computes the sums over the samples `part`. `columns` contains by gauge the time histories of the derivatives and of the residual.
    pub fn new(
        loads: &[Vec<f64>],
        columns: &[Vec<Vec<f64>>],
        without: &[Vec<f64>],
        part: Range<usize>,
    ) -> Self {
        let dot = |a: &[f64], b: &[f64]| -> f64 {
            let (a, b) = (&a[part.clone()], &b[part.clone()]);
            a.iter().zip(b).map(|(x, y)| x * y).sum()
        };
        let k = loads.len();
        let p = columns.first().map_or(0, Vec::len) + 1;
        let mut products = Matrix::zeros(p, p);
        let by_gauge = columns.iter().zip(without).map(|(columns, without)| {
            let all: Vec<&[f64]> = columns
                .iter()
                .chain(std::iter::once(without))
                .map(Vec::as_slice)
                .collect();
            for i in 0..p {
                for j in 0..=i {
                    let sum = dot(all[i], all[j]);
                    products[(i, j)] += sum;
                    if i != j {
                        products[(j, i)] += sum;
                    }
                }
            }
            Matrix::from_fn(k, p, |l, i| dot(&loads[l], all[i]))
        });
        let by_gauge = by_gauge.collect();
        Self {
            loads: Matrix::from_fn(k, k, |a, b| dot(&loads[a], &loads[b])),
            by_gauge,
            columns: products,
            samples: part.len() as f64,
        }
    }

    pub fn add(&mut self, other: &Self) {
        self.loads += &other.loads;
        self.columns += &other.columns;
        self.samples += other.samples;
        for (own, of_other) in self.by_gauge.iter_mut().zip(&other.by_gauge) {
            *own += of_other;
        }
    }

    /// Returns the products of columns minus their regression on the loads. `regression` contains the coefficients by gauge, `k x (p + 2)`.
    pub fn orthogonal(&self, regression: &[Matrix]) -> Matrix {
        let mut out = self.columns.clone();
        let k = regression.first().map_or(0, Matrix::nrows);
        let loads = self.loads.view((0, 0), (k, k));
        for (own, by) in self.by_gauge.iter().zip(regression) {
            let cross = by.transpose() * own.rows(0, k);
            out -= &cross + cross.transpose();
            out += by.transpose() * loads * by;
        }
        out
    }

    /// Returns the covariance of the gradient from errors of `shape_sd` of the strain of each mode at each gauge, `p x p`. `shapes` is the strain of
    /// the modes, by gauge.
    pub fn shape_covariance(
        &self,
        regression: &[Matrix],
        shapes: &[Vec<f64>],
        shape_sd: f64,
    ) -> Matrix {
        let (k, columns) = regression.first().map_or((0, 2), Matrix::shape);
        let p = columns - 2;
        let mut out = Matrix::zeros(p, p);
        for ((own, by), shape) in self.by_gauge.iter().zip(regression).zip(shapes) {
            for (m, strain) in shape.iter().enumerate() {
                let with_loads = self.loads.view((0, k + m), (k, 1)).column(0).into_owned();
                let of_mode = own.row(k + m).transpose() - by.transpose() * with_loads;
                let of_mode = of_mode.rows(0, p) * (shape_sd * strain);
                out += &of_mode * of_mode.transpose();
            }
        }
        out
    }
}

impl Normal {
    /// Forms the normal equations from the sums over parts of the record; `None` without any, or with too few samples.
    pub fn new(parts: &[Products], shapes: &Shapes, band: f64) -> Option<Self> {
        let mut all = parts.first()?.clone();
        parts[1..].iter().for_each(|part| all.add(part));
        let (n, k, p) = (all.by_gauge.len(), shapes.n_loads, all.columns.nrows() - 2);
        if all.samples < 10.0 * (k + p) as f64 {
            return None;
        }
        let inverse = all.loads.view((0, 0), (k, k)).into_owned();
        let inverse = inverse.pseudo_inverse(0.0).ok()?;
        let regression: Vec<Matrix> = (all.by_gauge.iter())
            .map(|m| &inverse * m.rows(0, k))
            .collect();
        let whole = all.orthogonal(&regression);
        let mut normal = Self {
            matrix: whole.view((0, 0), (p, p)).into_owned(),
            right: whole.view((0, p), (p, 1)).column(0).into_owned(),
            squares: whole[(p, p)].max(0.0),
            squares_without: whole[(p + 1, p + 1)].max(0.0),
            squares_of_motion: whole[(p, p)] + whole[(p + 1, p + 1)] - 2.0 * whole[(p, p + 1)],
            gradients: Vec::new(),
            by_shape: all.shape_covariance(&regression, &shapes.strain, shapes.sd),
            freedom: all.samples * (n - k) as f64,
            band,
        };
        let step = normal.step();
        let gradient = |part: &Products| {
            let own = part.orthogonal(&regression);
            own.view((0, p), (p, 1)).column(0).into_owned() - own.view((0, 0), (p, p)) * &step
        };
        normal.gradients = parts.iter().map(gradient).collect();
        Some(normal)
    }

    /// Returns the shortest change of the parameters that minimises the linearised residual.
    pub fn step(&self) -> Vector {
        // The matrix is scaled to a diagonal of 1. Combinations of parameters without effect on the residual get no step.
        let n = self.right.len();
        let scale = |i: usize| self.matrix[(i, i)].max(f64::MIN_POSITIVE).sqrt();
        let scaled = Matrix::from_fn(n, n, |i, j| self.matrix[(i, j)] / (scale(i) * scale(j)));
        let right = Vector::from_fn(n, |i, _| self.right[i] / scale(i));
        let svd = scaled.svd(true, true);
        let step = svd
            .solve(&right, 1e-10)
            .unwrap_or_else(|_| Vector::zeros(n));
        Vector::from_fn(n, |i, _| step[i] / scale(i))
    }

    /// Returns the variance of one residual. It is the variance of the noise, or of the remainder after the best linear step if this is larger.
    pub fn variance(&self, noise: f64) -> f64 {
        let left = (self.squares - self.right.dot(&self.step())).max(0.0) / self.freedom;
        (noise * noise * self.band).max(left).max(f64::MIN_POSITIVE)
    }
}
