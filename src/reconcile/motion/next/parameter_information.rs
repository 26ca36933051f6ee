//! Information of the present record about an explanation's parameters, and rows of a further measurement.

use crate::linalg::tall::{Triangle, triangle};
use crate::reconcile::motion::columns::parameter_column;
use crate::reconcile::motion::fit::held_parameters;
use crate::reconcile::motion::frame::MotionFrame;
use crate::reconcile::motion::motion_fit::MotionFit;

/// Rows of a measurement, divided by their standard deviation.
#[derive(Clone)]
pub(super) struct Rows {
    /// Reading under the explanation, or its residual.
    pub(super) reading: Vec<f64>,
    /// Columns of the fit, in the order of the fit.
    pub(super) own: Vec<Vec<f64>>,
    /// Columns that the measurement adds, each with one standard deviation if it is known beforehand.
    pub(super) fresh: Vec<(Vec<f64>, Option<f64>)>,
    /// Scale of masses and springs, if the measurement sets it.
    pub(super) scale: Vec<(usize, Vec<f64>)>,
}

/// Explanation with the information of the present record about its parameters.
pub(super) struct ParameterInformation<'a> {
    /// Fit of the explanation.
    pub(super) fit: &'a MotionFit,
    /// Parameters that are fixed because no force sets the scale.
    pub(super) held: Vec<usize>,
    /// Rows of the present record: columns of the fit, then the held parameters.
    pub(super) now: Triangle,
}

impl<'a> ParameterInformation<'a> {
    pub(super) fn from_fit(frame: &MotionFrame, fit: &'a MotionFit) -> Self {
        let v = &fit.assembled.vehicle;
        let names = v.parameters();
        let known = |i: &usize| frame.known.contains_key(&names[*i].name);
        let held: Vec<usize> = (held_parameters(frame, v, &fit.design).iter().enumerate())
            .filter_map(|(i, h)| h.map(|_| i))
            .filter(|i| !known(i))
            .collect();
        let scale: Vec<Vec<f64>> = held
            .iter()
            .map(|&i| fit.rows(&parameter_column(&fit.design, i), 0.0))
            .collect();
        let own = fit.columns.iter().map(|c| c.rows.as_slice());
        let all: Vec<(usize, &[f64])> = own
            .chain(scale.iter().map(Vec::as_slice))
            .enumerate()
            .collect();
        let now = match all.is_empty() {
            true => Triangle {
                columns: vec![],
                rows: vec![],
                n_rows: 0,
            },
            false => triangle(&all),
        };
        Self { fit, held, now }
    }
}
