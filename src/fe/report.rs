//! Report of the solver: everything except strain.

use super::mass::MassProperties;
use super::reactions::Reactions;
use super::relief::Balance;
use crate::finding::Finding;
use crate::linalg::sparse::OrderingMethod;

/// Report of the solver on a solution: sizes, accuracy, balance, reactions, modes and times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolveReport {
    /// Grids of the model.
    pub grids: usize,
    /// Unknowns of the largest system solved.
    pub dofs: usize,
    /// Number of entries of the factor.
    pub factor_nonzeros: usize,
    /// Ordering of the factor.
    pub ordering: Option<OrderingMethod>,
    /// Smallest pivot of the matrix scaled to unit diagonal: below 1e-10 the structure is nearly a mechanism.
    pub smallest_pivot: f64,
    /// Nastran's epsilon of the worst case, |u'(f - K u)| / |u'f|, as substituted and after iterative refinement.
    pub epsilon: [f64; 2],
    /// Balance of every case solved by inertia relief.
    pub balance: Vec<Balance>,
    /// Reactions of every case whose supports take load, basic frame.
    pub reactions: Vec<Reactions>,
    /// Mass and centre of gravity.
    pub mass: Option<MassProperties>,
    /// Frequencies of the lowest elastic modes, as many as requested, cycles per unit of time, ascending. The structure has the supports of the
    /// first cases.
    pub modes: Vec<f64>,
    /// Wall seconds by step.
    pub seconds: Vec<(String, f64)>,
}

/// Displacements of a solution, with the solver's report, before strain is computed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DisplacementSolution {
    /// Displacements by case and grid, basic frame.
    pub displacements: Vec<Vec<[f64; 6]>>,
    /// Report of the solver.
    pub report: SolveReport,
    /// Findings of the solver.
    pub findings: Vec<Finding>,
}

/// Times the steps of a solution.
pub(super) struct Clock(std::time::Instant);

impl Clock {
    pub(super) fn start() -> Self {
        Self(std::time::Instant::now())
    }

    /// Adds the time since the last call to a step.
    pub(super) fn note(&mut self, report: &mut SolveReport, step: &str) {
        let seconds = std::mem::replace(&mut self.0, std::time::Instant::now()).elapsed();
        match report.seconds.iter_mut().find(|s| s.0 == step) {
            Some(s) => s.1 += seconds.as_secs_f64(),
            None => report
                .seconds
                .push((step.to_owned(), seconds.as_secs_f64())),
        }
    }
}
