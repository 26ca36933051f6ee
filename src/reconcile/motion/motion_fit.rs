//! Fit of a set of effects: parameters, sizes, residuals, and the whitening for a further column.

use super::at_rest::RestRow;
use super::change::ChangedVehicle;
use super::design::{Bins, Design};
use super::noise::Whitener;
use super::part::{ColumnOf, Part};
use crate::estimate::columns::PriorColumn;
use rustfft::num_complex::Complex64;
use std::sync::Arc;

/// Fit of a set of effects.
#[derive(Clone, Debug)]
pub struct MotionFit {
    /// The effects.
    pub parts: Vec<Part>,
    /// Vehicle with the effects.
    pub assembled: ChangedVehicle,
    /// Parameters of the vehicle; NaN if no compared equation contains them.
    pub values: Vec<f64>,
    /// One sd of each parameter, 0 for fixed ones.
    pub sigmas: Vec<f64>,
    /// Parameters that were estimated, in the order of the first columns.
    pub free: Vec<usize>,
    /// Sizes of each effect's parameters, with one sd.
    pub sizes: Vec<Vec<[f64; 2]>>,
    /// Joint covariance of all sizes in this order, by rows.
    pub covariance: Vec<Vec<f64>>,
    /// Squared residual divided by its covariance, including the balance of weight.
    pub chi2: f64,
    /// Squared nuisance over its prior.
    pub penalty: f64,
    /// Sum over bins of ln |S| - ln |S of sensors alone|: cost of the background in the normal density of the channels.
    pub log_det: f64,
    /// Data rows.
    pub n_rows: usize,
    /// Design of the record in the last round.
    pub design: Arc<Design>,
    /// Responses at `values`.
    pub responses: Arc<Vec<Vec<Vec<Complex64>>>>,
    /// Whitening at `values`.
    pub whitener: Arc<Whitener>,
    /// Balance of weight, if wheel forces determine it.
    pub rest: Option<RestRow>,
    /// Whitened columns.
    pub columns: Arc<Vec<PriorColumn>>,
    /// Parameter, fault, line or tolerance of each column.
    pub column_of: Vec<ColumnOf>,
    /// Estimate of each column in the last round. For a fault, it is the last step of its parameter.
    pub estimates: Vec<f64>,
    /// Whitened residual, followed by the rows of the priors.
    pub residual: Arc<Vec<f64>>,
    /// Residual of each equation, with the nuisance at its estimate.
    pub left: Arc<Vec<Bins>>,
}

impl MotionFit {
    /// Returns the rows of a further column, `[equation][bin]` and its entry in the balance of weight, whitened like the columns of the fit.
    pub fn rows(&self, bins: &[&[Complex64]], at_rest: f64) -> Vec<f64> {
        whiten_column(&self.whitener, self.rest.as_ref(), bins, at_rest)
    }

    /// Returns the criterion by which a form is chosen, -2 log likelihood except for constants: squared residual, squared nuisance, log-determinants.
    pub fn misfit(&self) -> f64 {
        let at_rest = self.rest.as_ref().map_or(0.0, |r| r.sigma.ln());
        self.chi2 + self.penalty + 2.0 * (self.log_det + at_rest)
    }

    /// Returns the squared residual by degree of freedom.
    pub fn reduced_chi2(&self) -> f64 {
        self.chi2 / self.n_rows.saturating_sub(self.columns.len()).max(1) as f64
    }
}

/// Returns the whitened rows of a column; its entry in the balance of weight is at the end, if there is a balance.
pub fn whiten_column(
    whitener: &Whitener,
    rest: Option<&RestRow>,
    bins: &[&[Complex64]],
    at_rest: f64,
) -> Vec<f64> {
    let mut rows = whitener.rows(bins);
    if rest.is_some() {
        rows.push(at_rest);
    }
    rows
}
