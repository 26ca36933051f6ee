//! Single reading far off, with all other readings at the noise floor.

use super::covariance::{Selection, covariance};
use super::explanation::Explanation;
use super::frame::StrainFrame;
use super::likelihood::Fit;
use super::prediction::predict;
use crate::linalg::precision::Precision;
use crate::reconcile::effect::Candidate;
use crate::reconcile::search::ScoredSet;

/// Returns a text on the fit-run reading without which `scored` reaches the noise floor, as `at_floor` tests it; `None` without such a reading.
///
/// One spike in a few hundred readings is not an effect, nor evidence against one. The reading is `(P r)_i / sqrt(P_ii)` standard deviations off
/// given all other readings, with P the precision of the residual r. No other reading has a larger deviation, and a healthy gauge has a smaller one.
pub(super) fn but_for_one(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
    at_floor: impl FnOnce(&StrainFrame) -> bool,
) -> Option<String> {
    let e = Explanation::from_fit(frame, candidates, scored);
    let readings = Selection::of_runs(frame, &frame.observations.fit_runs());
    let n_g = frame.n_gauges();
    let predicted = readings.pick(&predict(frame, &e.members), n_g);
    let read = readings.pick(&frame.observations.values, n_g);
    let residual: Vec<f64> = read.iter().zip(predicted).map(|(y, p)| y - p).collect();
    let covariance = covariance(frame, &e.members, &readings, &e.unknown);
    let precision = Precision::from_covariance(&covariance, readings.len())?;
    let weighted = precision.apply(&residual).into_iter().enumerate();
    let (at, off) = weighted
        .map(|(i, v)| (i, v / precision.entry(i, i).sqrt()))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    if off.abs() < frame.rules.part {
        return None;
    }
    let &(run, gauge) = readings.0.get(at)?;
    let mut rest = frame.clone();
    *rest.observations.values.get_mut(run * n_g + gauge)? = f64::NAN;
    at_floor(&rest).then(|| {
        format!(
            "the reading of {} in {} is an isolated outlier, {:.1} standard deviations off: a spike or a wrong entry",
            frame.gauges[gauge].name,
            frame.observations.runs[run],
            off.abs()
        )
    })
}
