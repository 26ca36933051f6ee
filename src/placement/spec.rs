//! What a placement is asked for.

use super::criterion::Criterion;
use super::exchange::Effort;
use crate::stop::Stop;

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// Number of gauges to choose.
    pub gauges: usize,
    /// Least distance between two gauges, in the unit of the positions; 0: none. With a distance, a place takes one gauge at most.
    pub spacing: f64,
    /// Information already there, `k x k` by rows (zeros: none): gauges kept, known load sizes.
    pub prior: Vec<f64>,
    /// What the layout is chosen for.
    pub criterion: Criterion,
    /// Gap, per load, to which the relaxation is solved; the certificate is as much looser.
    pub tolerance: f64,
    /// How hard to search.
    pub effort: Effort,
    /// Floating-point operations, roughly, that a proof by branch and bound may take; 0: none is tried. It is tried where few candidates
    /// are left that could be in a better layout ([`branch_and_bound::MOST_ROWS`]).
    pub proof: f64,
    /// What the loss of a gauge means for the choice.
    pub loss: Loss,
    /// Cuts the search short: the layout is the best so far, its certificate holds.
    pub stop: Stop,
}

/// Whether a layout is chosen for what is left after the worst loss of one gauge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// It is not.
    Judged,
    /// It is, where there are more gauges than loads or prior information; the determinant for all columns counts then.
    Optimised,
}

impl Spec {
    /// Usual settings for `gauges` gauges and `loads` loads: many loads make more local optima, so the search is longer.
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
