//! Cause of the change of one gauge's row: a gain, an angle, a place, or undetermined.

use super::evidence::RowEvidence;
use super::model_error::ErrorEvidence;
use super::prior::rows;
use super::types::{ModelError, ModelPrior, OffDrawing, ShiftWord};
use crate::linalg::{Matrix, spd};

/// Natural log of the odds over every alternative explanation above which a turned or displaced gauge is reported: 150 to 1. This is "very strong" on
/// the scale of R. E. Kass and A. E. Raftery, J. Am. Stat. Assoc. 90 (1995) 773. A wrong cause costs more than no cause.
const CLEAR: f64 = 5.0;
/// Natural log of the odds over angle and place from which a gain is reported: 7 to 1, "positive" on this scale. A wrong gain is the most usual
/// fault.
const GAIN_RATHER: f64 = 2.0;
/// Standard deviation of a gain that nobody stated: half or double, or reversed.
const GAIN_SD: f64 = 1.0;
/// Standard deviation of an installation angle that nobody stated, degrees. As in `reconcile`, a gauge installed across its axis is as common a
/// mistake as a slightly turned one.
const ANGLE_SD: f64 = 30.0;
/// Step of the tried angles, degrees, and their number to each side of the nominal angle, up to a gauge installed across its axis.
const ANGLE_STEP: f64 = 0.05;
const ANGLES: i32 = 1800;

/// Log marginal likelihoods of a gauge's readings under each cause, in addition to the ordinary error of the model.
struct CauseEvidence {
    /// Wrong gain: the readings of all loads have one factor.
    gain: f64,
    /// Gauge turned by some angle.
    angle: f64,
    /// Gauge moved along the surface.
    place: f64,
    /// Any other row of equal size.
    other: f64,
}

/// Returns `Angle` or `Place` if the readings clearly prefer one of them to the other, to a gain and to any other row.
/// Returns `Gain` if they prefer a gain to angle and place, else `Undetermined`; `None` if the model has no `off_drawing` changes.
/// `error`: the error of the model as determined from the other gauges.
pub(super) fn off_drawing(
    model: &ModelPrior,
    scales: &[f64],
    evidence: &ErrorEvidence,
    error: ModelError,
    g: usize,
) -> Option<ShiftWord> {
    let changes = model.off_drawing.as_ref()?;
    let rivals = CauseEvidence::evaluate_gauge(model, changes, scales, evidence, error, g)?;
    let beats = |own: f64, others: [f64; 3]| others.iter().all(|o| own > o + CLEAR);
    let CauseEvidence {
        gain,
        angle,
        place,
        other,
    } = rivals;
    Some(if beats(angle, [gain, place, other]) {
        ShiftWord::Angle
    } else if beats(place, [gain, angle, other]) {
        ShiftWord::Place
    } else if gain > angle.max(place) + GAIN_RATHER {
        ShiftWord::Gain
    } else {
        ShiftWord::Undetermined
    })
}

impl CauseEvidence {
    fn evaluate_gauge(
        model: &ModelPrior,
        changes: &OffDrawing,
        scales: &[f64],
        evidence: &ErrorEvidence,
        error: ModelError,
        g: usize,
    ) -> Option<Self> {
        let k = scales.len();
        let scaled = |m: &Matrix| -> Vec<f64> { (0..k).map(|l| m[(g, l)] * scales[l]).collect() };
        let [turned, crossed, along, across] = [
            &changes.turned,
            &changes.crossed,
            &changes.along,
            &changes.across,
        ]
        .map(scaled);
        // The row of a gauge on a bar, or from a table, does not change with its angle.
        if turned.iter().chain(&crossed).all(|v| *v == 0.0) {
            return None;
        }
        let normal = evidence.normals.get(g)?;
        let prior = rows(model, scales, [(g, error.into())]).pop()?;
        let usual = RowEvidence::from_row_prior(&prior.mean, &prior.covariance, normal)?;
        let square = spd::dot(&prior.mean, &prior.mean) / k.max(1) as f64;
        let mut any = prior.covariance.clone();
        any.iter_mut().step_by(k + 1).for_each(|v| *v += square);
        Some(Self {
            gain: usual.log_with_directions(&[&prior.mean], GAIN_SD),
            angle: of_angle(&usual, &turned, &crossed)?,
            place: usual.log_with_directions(&[&along, &across], changes.reach),
            other: RowEvidence::from_row_prior(&prior.mean, &any, normal)?.log(),
        })
    }
}

/// Returns the mean of the likelihood over the angles. The row of a gauge turned by `a` is `s + t sin(2a) / 2 + c sin(a)^2`, because strain is a
/// tensor. `t` is its change per radian and `c` its change at a right angle.
fn of_angle(usual: &RowEvidence, turned: &[f64], crossed: &[f64]) -> Option<f64> {
    let (first, second) = usual.orders(&[turned, crossed]);
    let (&[l, m], &[p, q, _, r]) = (first.as_slice(), second.as_slice()) else {
        return None;
    };
    let mut logs = Vec::new();
    let mut weights = 0.0;
    for step in -ANGLES..=ANGLES {
        let degrees = f64::from(step) * ANGLE_STEP;
        let angle = degrees.to_radians();
        let (x, y) = (0.5 * (2.0 * angle).sin(), angle.sin().powi(2));
        let off = -0.5 * (degrees / ANGLE_SD).powi(2);
        weights += off.exp();
        logs.push(off + x * l + y * m - 0.5 * (x * x * p + 2.0 * x * y * q + y * y * r));
    }
    let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = logs.iter().map(|v| (v - top).exp()).sum();
    Some(usual.log() + top + (sum / weights).ln())
}
