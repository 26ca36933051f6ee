//! Stretch, rate and terms of links; columns of changes of mass.

use super::layout::Vehicle;
use super::limiter::Limiter;
use super::term::Term;
use super::treatment::{SlowStretch, Treatment};
use crate::series::channels::Channels;
use crate::series::detrend::{mean, without_mean};
use crate::series::spectrum::{Band, Spectrum};
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Wide-band signals of links reach down to this share of the lower band edge.
const WIDE: f64 = 0.5;
/// Below this multiple of the lower band edge the stretch of nonlinear terms comes from force, where that is known.
const SLOW: f64 = 1.4;

/// Stretch of a link, its rate and its terms, limited to the band.
pub(super) struct LinkMotion {
    pub stretch: Vec<f64>,
    pub rate: Vec<f64>,
    pub terms: Vec<Vec<f64>>,
}

pub(super) fn link_motion(
    vehicle: &Vehicle,
    record: &Channels,
    treatment: &Treatment,
    body_spectra: &[Vec<Spectrum>],
    l: usize,
    limit: &mut Limiter,
) -> Option<LinkMotion> {
    let link = &vehicle.links[l];
    let mut parts = Vec::new();
    for (weight, end) in &link.ends {
        for (phi, s) in vehicle.functions(end).iter().zip(&body_spectra[end.body]) {
            parts.push((weight * phi, s));
        }
    }
    let relative = Spectrum::sum(&parts)?;
    let (stretch, rate) = (
        limit.samples_in_band(&relative, 2),
        limit.samples_in_band(&relative, 1),
    );
    let nonlinear = link.terms.iter().any(|t| !t.is_linear());
    let slow = treatment.slow.iter().find(|s| s.link == l);
    let slow = slow.filter(|s| s.stretch.len() == record.n_samples());
    let wide = nonlinear.then(|| wide_band(&relative, slow, limit));
    let terms = link
        .terms
        .iter()
        .map(|term| match (term, &wide) {
            (Term::Stiffness, _) => stretch.clone(),
            (Term::Damping, _) => rate.clone(),
            (Term::Inertance, _) => limit.samples_in_band(&relative, 0),
            (term, Some((d, v))) => {
                let force: Vec<f64> = (d.iter().zip(v).enumerate())
                    .map(|(i, (d, v))| {
                        let t_s = record.start_s + i as f64 / limit.rate_hz;
                        term.basis_at(*d, *v, t_s)
                    })
                    .collect();
                limit.limited_samples(&force)
            }
            (_, None) => vec![0.0; stretch.len()],
        })
        .collect();
    Some(LinkMotion {
        stretch,
        rate,
        terms,
    })
}

/// Stretch and rate with no upper edge at every sample of the record, the slow part from force where that is known.
fn wide_band(
    relative: &Spectrum,
    slow: Option<&SlowStretch>,
    limit: &mut Limiter,
) -> (Vec<f64>, Vec<f64>) {
    let from = |share: f64| Band {
        low_hz: limit.band.low_hz * share,
        high_hz: f64::INFINITY,
    };
    let Some(slow) = slow else {
        let open = from(WIDE);
        return (
            limit.fourier.samples(&relative.band_integrated(open, 2), 1),
            limit.fourier.samples(&relative.band_integrated(open, 1), 1),
        );
    };
    let fast = from(SLOW);
    let level = mean(&slow.stretch);
    let below = limit
        .fourier
        .spectrum(&without_mean(&slow.stretch), limit.rate_hz)
        .times(|f| Complex64::new(1.0 - fast.gain(f), 0.0));
    let rate = below.times(|f| Complex64::new(0.0, 2.0 * PI * f));
    let mut joined = |times: i32, slow: &Spectrum| {
        let whole = Spectrum::sum(&[(1.0, &relative.band_integrated(fast, times)), (1.0, slow)]);
        whole.map_or(vec![], |s| limit.fourier.samples(&s, 1))
    };
    let d = joined(2, &below);
    (d.iter().map(|d| d + level).collect(), joined(1, &rate))
}

/// Returns a column for each change of mass: the share present at each time, times the sum of acceleration and `step.gravity`.
pub(super) fn step_columns(
    vehicle: &Vehicle,
    record: &Channels,
    body_spectra: &[Vec<Spectrum>],
    limit: &mut Limiter,
) -> Vec<Vec<f64>> {
    let mut out = Vec::new();
    for step in &vehicle.steps {
        let Some(heave) = body_spectra.get(step.body).and_then(|b| b.first()) else {
            continue;
        };
        let a = limit.fourier.samples(heave, 1);
        let product: Vec<f64> = a
            .iter()
            .enumerate()
            .map(|(i, a)| {
                step.share_at(record.start_s + i as f64 / limit.rate_hz) * (a + step.gravity)
            })
            .collect();
        out.push(limit.limited_samples(&product));
    }
    out
}
