//! Log evidence of a set of effects: likelihood of the channels, prior of sizes, cost of freedom.

use super::candidate::Candidate;
use super::change::Change;
use super::frame::MotionFrame;
use super::motion_fit::MotionFit;
use super::zeros::zeros;

/// Returns the cost of the freedom of an effect, in log evidence. Each parameter costs half the log of the number of rows (Schwarz). The log of the
/// number of candidates and the handicap of the candidate are added.
///
/// # Reference
/// G. Schwarz, Estimating the dimension of a model, Ann. Statist. 6 (1978) 461.
pub fn cost(candidate: &Candidate, shape: &Change, n_candidates: usize, n_rows: usize) -> f64 {
    let n = match shape {
        Change::Terms { terms, .. } => terms.len(),
        Change::Links(links) => links.iter().map(|l| l.terms.len()).sum(),
        // A line has an amplitude, a phase and a frequency.
        Change::Line { .. } => 3,
        _ => 1,
    };
    // A constant that is selected among several forms is a parameter as well.
    let constants = usize::from(candidate.shapes.len() > 4);
    let per = 0.5 * (n_rows.max(2) as f64).ln();
    per * (n + constants) as f64 + (n_candidates.max(1) as f64).ln() + candidate.handicap
}

/// Returns the log evidence of a fit. It is minus half of a sum of squares, minus the log-determinants of the covariances, minus prior and cost of
/// the effects.
///
/// The squares are the residual over its covariance (with the balance of weight), the nuisance over its tolerance, and the means of accelerometers.
/// The log-determinant of the equations is relative to the covariance of the sensors alone.
pub fn evidence(frame: &MotionFrame, candidates: &[Candidate], fit: &MotionFit) -> f64 {
    let cost: f64 = fit
        .parts
        .iter()
        .filter_map(|p| {
            let c = candidates.get(p.candidate)?;
            Some(cost(c, &p.shape, candidates.len(), fit.n_rows))
        })
        .sum();
    let at_rest = fit.rest.as_ref().map_or(0.0, |r| r.sigma.ln());
    -0.5 * (fit.chi2 + fit.penalty + zeros(frame, fit))
        - fit.log_det
        - at_rest
        - cost
        - channel_fault_cost(frame, fit)
}

/// Returns the log evidence from data other than the shaken part of the record: means of accelerometers, sizes of channel faults.
pub fn evidence_outside_shaking(frame: &MotionFrame, fit: &MotionFit) -> f64 {
    -0.5 * zeros(frame, fit) - channel_fault_cost(frame, fit)
}

/// Returns the cost of the sizes of channel faults.
fn channel_fault_cost(frame: &MotionFrame, fit: &MotionFit) -> f64 {
    fit.parts
        .iter()
        .map(|p| match &p.shape {
            Change::Gain { .. } => 0.5 * ((1.0 / p.fault).ln() / frame.rules.gain).powi(2),
            Change::Delay { .. } | Change::Slip { .. } | Change::Lag { .. } => {
                0.5 * (p.fault / frame.rules.delay_s).powi(2)
            }
            _ => 0.0,
        })
        .sum()
}
