//! `zero_drift`: a gauge whose zero moves over the days of a vehicle, named as in `reconcile`.

use super::gauge_history::GaugeHistory;
use super::outcome::VehicleAnswer;
use crate::estimate::student_tail;
use crate::finding::{Finding, Severity};
use crate::recovery::{ALARM, ErrorModel};
use crate::units::MICROSTRAIN;

/// Smallest number of days for a trend. The scatter about a line through fewer days can't be estimated well enough.
const DAYS: usize = 5;
/// Sigmas of the model's error by which the loads of a day may move the mean of a right gauge.
const OF_MODEL: f64 = 3.0;

/// Line through the offsets of a gauge by the number of the day.
struct Trend {
    /// Change from the first to the last day, microstrain.
    moved: f64,
    /// Scatter of the days about the line, microstrain.
    scatter: f64,
    /// Change that noise and the model's error can cause, microstrain.
    small: f64,
    /// Number of the first and last day.
    ends: [usize; 2],
    /// Change in the gauge's own residual, divided by the root of the gauge's share in it: `moved * sqrt(1 - leverage)`. It is largest for the gauge
    /// that moves (Cauchy and Schwarz), although the residuals of other gauges change too.
    weight: f64,
}

/// Fits the line by least squares. `None` if it is not significant against the scatter (chance [`ALARM`] over all gauges), or not larger than noise
/// and the model's error.
fn trend(g: &GaugeHistory, v: &VehicleAnswer, errors: &ErrorModel) -> Option<Trend> {
    let known = g.offset.iter().enumerate();
    let known = known.filter(|(i, _)| v.misread.get(*i) != Some(&true));
    let known: Vec<(usize, f64)> = known.filter_map(|(i, v)| Some((i, (*v)?))).collect();
    let n = known.len() as f64;
    let (first, last) = (known.first()?.0, known.last()?.0);
    if known.len() < DAYS {
        return None;
    }
    let mean_x = known.iter().map(|k| k.0 as f64).sum::<f64>() / n;
    let mean_y = known.iter().map(|k| k.1).sum::<f64>() / n;
    let (mut xx, mut xy) = (0.0, 0.0);
    for (x, y) in &known {
        let dx = *x as f64 - mean_x;
        xx += dx * dx;
        xy += dx * (y - mean_y);
    }
    let slope = xy / xx;
    let left = |k: &(usize, f64)| k.1 - mean_y - slope * (k.0 as f64 - mean_x);
    let squares: f64 = known.iter().map(|k| left(k).powi(2)).sum();
    let scatter = (squares / (n - 2.0)).sqrt();
    let moved = slope * (last - first) as f64;
    let t = slope.abs() / (scatter / xx.sqrt()).max(f64::MIN_POSITIVE);
    let means = g.mean.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
    let noise = errors.noise / MICROSTRAIN;
    let small = noise.max(OF_MODEL * errors.model_rel * means);
    let by_chance = 2.0 * v.gauges.len() as f64 * student_tail(t, n - 2.0);
    let leverage = g.leverage.get(last).copied().filter(|h| h.is_finite());
    (by_chance < ALARM && moved.abs() > small).then(|| Trend {
        moved,
        scatter,
        small,
        ends: [first, last],
        weight: moved.abs() * (1.0 - leverage.unwrap_or(0.0)).max(0.0).sqrt(),
    })
}

/// Returns the finding on the gauge of a vehicle whose zero changes most. `None` if no zero changes. A changed gain also changes the means of all
/// gauges, together with the mean loads. A vehicle with a changed gain therefore gets only the finding on the gain.
pub(super) fn drift(v: &VehicleAnswer, errors: &ErrorModel) -> Option<Finding> {
    if v.gain_changes().next().is_some() {
        return None;
    }
    let trends = v.gauges.iter();
    let moving: Vec<(&GaugeHistory, Trend)> = trends
        .filter_map(|g| Some((g, trend(g, v, errors)?)))
        .collect();
    let worst = moving.iter();
    let (g, t) = worst.max_by(|a, b| a.1.weight.total_cmp(&b.1.weight))?;
    let [first, last] = t.ends.map(|i| v.days.get(i).map_or("", String::as_str));
    let others = match moving.len() {
        1 => String::new(),
        n => format!(
            "; {} others drift less, as they do if one gauge changes the loads",
            n - 1
        ),
    };
    Some(
        Finding::new(
            Severity::Warning,
            "zero_drift",
            format!("{} {}", v.name, g.name),
            format!(
                "its zero relative to the other gauges drifts by {:.1} microstrain from {first} to {last}, linearly. The scatter from day to day is {:.1} microstrain{others}",
                t.moved, t.scatter
            ),
            "balance it again, and check its cover and cable; then check whether another gauge still drifts",
        )
        .with_numbers(t.moved, t.small),
    )
}
