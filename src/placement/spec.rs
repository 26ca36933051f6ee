//! Requirements of a placement.

use super::criterion::Criterion;
use super::exchange::Effort;
use crate::stop::Stop;

/// Requirements of a placement.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// Number of gauges to choose.
    pub gauges: usize,
    /// Least distance between two gauges, in the unit of the positions. 0 means no limit. With a limit, a place takes at most one gauge.
    pub spacing: f64,
    /// Prior information, `k x k` by rows (zeros if none): kept gauges, known sizes of loads.
    pub prior: Vec<f64>,
    /// Criterion of the layout.
    pub criterion: Criterion,
    /// Gap per load to which the relaxation is solved. The certificate is looser by this gap.
    pub tolerance: f64,
    /// Effort of the search.
    pub effort: Effort,
    /// Approximate number of floating-point operations for a proof by branch and bound; 0: no proof. It is tried if few candidates
    /// remain that could be in a better layout (`branch_and_bound::MOST_ROWS`).
    pub proof: f64,
    /// Effect of the loss of a gauge on the choice.
    pub loss: Loss,
    /// Cancellation of the search: the result is the best layout so far, with a valid certificate.
    pub stop: Stop,
}

/// Whether a layout is optimised for the information after the worst loss of one gauge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// The loss is only reported.
    Judged,
    /// The layout is optimised for the loss, with the determinant for all columns, if it has more gauges than loads, or prior information.
    Optimised,
}

impl Spec {
    /// Returns the usual settings for `gauges` gauges and `loads` loads: many loads make more local optima, so the search is longer.
    pub fn new(gauges: usize, loads: usize) -> Self {
        Self {
            gauges,
            spacing: 0.0,
            prior: vec![0.0; loads * loads],
            criterion: Criterion::D,
            tolerance: 5e-4,
            effort: Effort {
                starts: 8,
                perturbations: if loads > 12 { 60 } else { 12 },
                seed: 1,
            },
            proof: 1e9,
            loss: Loss::Judged,
            stop: Stop::default(),
        }
    }
}
