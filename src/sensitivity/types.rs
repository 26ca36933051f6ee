//! The matrix with its names and scales.

use super::{GaugeNoise, Uncertainty};
use crate::estimate::student_95;
use crate::linalg::{Matrix, dense};
use crate::units::Quantity;

/// A column of S.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Name.
    pub name: String,
    /// Expected size of the load, 1 sd, job units; `None` if it is not stated.
    pub expected: Option<f64>,
    /// Whether the load is wanted as a result. Otherwise it is a nuisance load.
    pub wanted: bool,
    /// Force or moment, if known. Sizes of loads are compared within a kind.
    pub quantity: Option<Quantity>,
}

impl Load {
    /// Returns a wanted load without a stated size.
    pub fn from_name(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            expected: None,
            wanted: true,
            quantity: None,
        }
    }

    /// Returns the prior standard deviation of the load about zero: the stated size of a nuisance load, `None` for a wanted one.
    pub fn prior(&self) -> Option<f64> {
        self.expected.filter(|e| !self.wanted && *e > 0.0)
    }
}

/// Sensitivity `S` of `n_gauges x n_loads`, strain (not microstrain) per job unit of load, with names and errors. `eps = S f`.
///
/// # Example
/// ```
/// use strainbridge::linalg::Matrix;
/// use strainbridge::sensitivity::{Load, Sensitivity};
///
/// let s = Sensitivity {
///     gauges: ["G1", "G2", "G3"].map(str::to_owned).to_vec(),
///     loads: vec![Load::from_name("left"), Load::from_name("right")],
///     values: 1e-6 * Matrix::from_row_slice(3, 2, &[4.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
///     uncertainty: None,
///     noise: None,
/// };
/// assert_eq!(s.rank(), 2);
/// assert!((s.condition_number() - 4.0).abs() < 1e-12);
/// // Columns of unit norm are orthogonal here: the units of the loads do not matter.
/// assert!((s.condition_number_scaled() - 1.0).abs() < 1e-12);
/// // The second gauge alone determines one load.
/// assert_eq!(s.of_gauges(&[1]).rank(), 1);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// Row names.
    pub gauges: Vec<String>,
    /// Columns.
    pub loads: Vec<Load>,
    /// Values.
    pub values: Matrix,
    /// Uncertainty of a calibrated S; `None` if only the stated error of a model is known.
    pub uncertainty: Option<Uncertainty>,
    /// Noise of the gauges; `None` if each has the stated noise, independent of the other gauges.
    pub noise: Option<GaugeNoise>,
}

impl Sensitivity {
    /// Returns the error of the strain under loads of expected size, 1 sd, as a share of this strain. Both are root mean squares over the gauges.
    /// Returns 0 if S has no uncertainty.
    pub fn relative_sd(&self) -> f64 {
        let Some(u) = &self.uncertainty else {
            return 0.0;
        };
        let (n, scales) = (self.values.nrows(), self.scales());
        let c = u.expected_covariance(n, &scales);
        let off: f64 = (0..n).map(|g| c[g * n + g]).sum();
        let columns = self.values.column_iter().zip(&scales);
        let whole: f64 = columns.map(|(s, f)| s.norm_squared() * f * f).sum();
        if whole > 0.0 {
            (off / whole).sqrt()
        } else {
            0.0
        }
    }

    /// Returns the half widths of the 95 % intervals of the entries, `n x k`; zeros if S has no uncertainty.
    pub fn half_widths(&self) -> Matrix {
        let (n, k) = self.values.shape();
        let Some(u) = &self.uncertainty else {
            return Matrix::zeros(n, k);
        };
        let factor = u.scale * student_95(u.dof);
        let variance = |e: usize| u.covariance.get(e * (n * k + 1)).copied().unwrap_or(0.0);
        Matrix::from_fn(n, k, |g, l| factor * variance(g * k + l).max(0.0).sqrt())
    }

    /// Returns the column scales: `expected` if every load states it, else 1 over the norm of the column (1 for a zero column).
    pub fn scales(&self) -> Vec<f64> {
        let stated: Option<Vec<f64>> = self
            .loads
            .iter()
            .map(|l| l.expected.filter(|e| *e > 0.0))
            .collect();
        stated.unwrap_or_else(|| {
            self.values
                .column_iter()
                .map(|c| {
                    let n = c.norm();
                    if n > 0.0 { 1.0 / n } else { 1.0 }
                })
                .collect()
        })
    }

    /// Returns S with the columns of the loads that the gauges alone must separate. Loads with a known prior size ([`Load::prior`]) are left out.
    pub fn without_prior_loads(&self) -> Self {
        let free: Vec<usize> = (0..self.loads.len())
            .filter(|&l| self.loads[l].prior().is_none())
            .collect();
        Self {
            gauges: self.gauges.clone(),
            loads: free.iter().map(|&l| self.loads[l].clone()).collect(),
            values: self.values.select_columns(&free),
            uncertainty: None,
            noise: self.noise.clone(),
        }
    }

    /// Returns the rows of these gauges, by number and in this order.
    pub fn of_gauges(&self, gauges: &[usize]) -> Self {
        Self {
            gauges: gauges.iter().map(|&g| self.gauges[g].clone()).collect(),
            loads: self.loads.clone(),
            values: self.values.select_rows(gauges),
            uncertainty: self.uncertainty.as_ref().map(|u| u.of_gauges(gauges)),
            noise: self.noise.as_ref().map(|n| n.of_gauges(gauges)),
        }
    }

    /// Returns [`Load::prior`] of every load.
    pub fn priors(&self) -> Vec<Option<f64>> {
        self.loads.iter().map(Load::prior).collect()
    }

    /// Returns S with its columns times [`Self::scales`].
    pub fn scale_columns(&self) -> Matrix {
        let mut m = self.values.clone();
        for (mut c, s) in m.column_iter_mut().zip(self.scales()) {
            c *= s;
        }
        m
    }

    /// Returns the condition number of S in microstrain per job unit; infinite if the loads cannot be separated.
    pub fn condition_number(&self) -> f64 {
        dense::condition(&self.values)
    }

    /// Returns the condition number of S with scaled columns.
    pub fn condition_number_scaled(&self) -> f64 {
        dense::condition(&self.scale_columns())
    }

    /// Returns the rank of S with columns of unit norm.
    pub fn rank(&self) -> usize {
        dense::rank(&dense::unit_columns(&self.values))
    }
}
