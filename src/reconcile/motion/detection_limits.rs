//! The smallest size of every effect that a record would have shown.

use super::change::Change;
use super::effect_units::unit_of_change;
use super::limits::{late_on_average, tolerance_limit};
use super::motion_fit::MotionFit;
use super::outcome::MotionDetectionLimit;
use super::part::ColumnOf;
use super::scorer::MotionScorer;
use crate::estimate::columns::Basis;

/// Returns the smallest detectable sizes by candidate, in the order of the library. A candidate of this size, in its most visible form, raises the
/// log evidence enough to be named. It also exceeds the declared tolerances of its channel.
///
/// An effect of size x whose column's coefficient has the standard deviation s gains (x / s)^2 / 2 minus its cost.
pub fn smallest_sizes(scorer: &mut MotionScorer, null: &MotionFit) -> Vec<MotionDetectionLimit> {
    let basis = Basis::from_columns(&null.columns);
    let tolerances = null
        .column_of
        .iter()
        .filter(|c| matches!(c, ColumnOf::Gain(_) | ColumnOf::Delay(_)))
        .count();
    let limit = tolerance_limit(&scorer.frame.rules, tolerances);
    let mut out: Vec<Option<MotionDetectionLimit>> = vec![None; scorer.candidates.len()];
    for (c, k, columns) in scorer.form_columns(null) {
        let candidate = &scorer.candidates[c];
        let Some(shape) = candidate.shapes.get(k) else {
            continue;
        };
        // For a line, the phase with the smaller residual counts.
        let left = match (shape, columns.as_slice()) {
            (_, [column]) => basis.left_of(column),
            (Change::Line { .. }, [a, b]) => basis.left_of(a).min(basis.left_of(b)),
            _ => continue,
        };
        if left <= 0.0 {
            continue;
        }
        let price = scorer.cost(c, shape, null.n_rows);
        let sigma = 1.0 / left;
        let seen = sigma * (2.0 * (scorer.frame.rules.decisive + price)).sqrt();
        let tolerance = match shape {
            Change::Gain { .. } => scorer.frame.gain_tolerance,
            Change::Delay { .. }
            | Change::Lag { .. }
            | Change::Slip { .. }
            | Change::Clock { .. } => scorer.frame.sync_tolerance_s / late_on_average(shape, null),
            _ => 0.0,
        };
        let size = seen.max(limit * tolerance.hypot(sigma));
        if out[c].as_ref().is_none_or(|s| size < s.size) {
            out[c] = Some(MotionDetectionLimit {
                id: candidate.id.clone(),
                size: size * shape.stated_size_factor(),
                unit: unit_of_change(scorer.frame, shape, null),
            });
        }
    }
    out.into_iter().flatten().collect()
}
