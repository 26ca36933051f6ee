//! The smallest size of each effect that these data would show.

use super::covariance::{Selection, covariance};
use super::frame::StrainFrame;
use super::prediction::predict;
use crate::linalg::precision::Precision;
use crate::reconcile::effect::{Candidate, Member, full_id};
use crate::reconcile::outcome::DetectionLimit;

/// Returns the sizes at which the expected gain of evidence covers the effect's prior weight, its width and the evidence for a name. If an effect has
/// many overlapping places (ranges of a card, records of a run), only the effects of `also` are listed.
pub fn find_detectable_sizes(
    frame: &StrainFrame,
    candidates: &[Candidate],
    also: &[usize],
) -> Vec<DetectionLimit> {
    let fit = Selection::of_runs(frame, &frame.observations.fit_runs());
    let Some(precision) = Precision::from_covariance(&covariance(frame, &[], &fit, &[]), fit.len())
    else {
        return Vec::new();
    };
    let n_g = frame.n_gauges();
    let nominal = fit.pick(&predict(frame, &[]), n_g);
    let mut out = Vec::new();
    for (number, c) in candidates.iter().enumerate() {
        if frame.stop.is_asked() {
            break;
        }
        let effect = c.effect.as_ref();
        let overlaps = effect.gauges().len() > 1 || !effect.runs().is_empty();
        // An effect that also scatters has the detection limit of its plain form.
        let scatters = !effect.parameters().is_empty() && effect.amplitudes(frame).is_some();
        if effect.discrepancy().is_some() || scatters || (overlaps && !also.contains(&number)) {
            continue;
        }
        let id = full_id(effect);
        if let Some(a) = effect.amplitudes(frame) {
            // For amplitudes, the expected gain at s times the usual size, one pattern at a time.
            let read = &a.patterns;
            let mut strengths = Vec::new();
            for run in frame.observations.fit_runs() {
                for (pattern, &kind) in read.iter().zip(&a.kinds) {
                    let usual = a.usual.get(kind).copied().unwrap_or(0.0);
                    let x: Vec<(usize, f64)> = fit
                        .0
                        .iter()
                        .enumerate()
                        .filter(|(_, e)| e.0 == run)
                        .map(|(i, e)| (i, usual * pattern[e.1]))
                        .collect();
                    strengths.push(precision.quadratic_sparse(&x));
                }
            }
            // The patterns of a family explain overlapping parts of the residual, so the strongest pattern of each run represents the family.
            let per_run = read.len().max(1);
            let strongest: Vec<f64> = strengths
                .chunks(per_run)
                .map(|s| s.iter().copied().fold(0.0, f64::max))
                .collect();
            let expected = |s: f64| {
                0.5 * strongest
                    .iter()
                    .map(|l| s * s * l - (s * s * l).ln_1p())
                    .sum::<f64>()
            };
            let needed = frame.rules.decisive - c.log_prior;
            let (mut low, mut high) = (1e-6, 1e3);
            for _ in 0..60 {
                let middle = f64::sqrt(low * high);
                if expected(middle) < needed {
                    low = middle
                } else {
                    high = middle
                }
            }
            let usual = a.usual.iter().copied().fold(0.0, f64::max);
            out.push(DetectionLimit {
                id,
                size: high * usual,
                unit: a.unit,
            });
        } else if let [p] = effect.parameters().as_slice() {
            let size = smallest_detectable_size(
                frame, c, &fit, &nominal, &precision, p.neutral, p.step, p.prior_sd,
            );
            out.push(DetectionLimit {
                id,
                size,
                unit: p.unit,
            });
        }
    }
    out
}

/// Finds the smallest detectable size by bisection on the exact change of the prediction, for the sign with the smaller size.
#[allow(
    clippy::too_many_arguments,
    reason = "one call site, all of it the state of a loop"
)]
fn smallest_detectable_size(
    frame: &StrainFrame,
    c: &Candidate,
    fit: &Selection,
    nominal: &[f64],
    precision: &Precision,
    neutral: f64,
    step: f64,
    prior_sd: f64,
) -> f64 {
    let gauges = c.effect.gauges();
    let power = |size: f64| {
        let parameters = [neutral + size];
        let changed = predict(
            frame,
            &[Member {
                effect: c.effect.as_ref(),
                parameters: &parameters,
            }],
        );
        let changed = fit.pick(&changed, frame.n_gauges());
        let touched =
            |i: &usize| gauges.is_empty() || fit.0.get(*i).is_some_and(|e| gauges.contains(&e.1));
        let x: Vec<(usize, f64)> = (0..fit.len())
            .filter(touched)
            .map(|i| (i, changed[i] - nominal[i]))
            .collect();
        if gauges.is_empty() {
            let px = precision.apply_sparse(&x);
            return 0.5 * x.iter().map(|&(i, v)| v * px[i]).sum::<f64>();
        }
        0.5 * precision.quadratic_sparse(&x)
    };
    let curvature = 2.0 * power(step) / (step * step);
    let needed =
        frame.rules.decisive - c.log_prior + 0.5 * (prior_sd * prior_sd * curvature).ln_1p();
    if c.effect
        .parameters()
        .iter()
        .all(|p| p.starts == [p.neutral])
    {
        // The prediction is nearly linear in the size.
        return (2.0 * needed / curvature.max(f64::MIN_POSITIVE)).sqrt();
    }
    let mut size = step;
    while power(size) < needed && size < 1e4 * step {
        size *= 1.25;
    }
    size
}
