//! The gap on held-out runs, before and after, over all and by gauge, with its floor; loads recovered before and after.

use super::covariance::{Selection, SizedAmplitudes, covariance, read_patterns};
use super::frame::StrainFrame;
use super::state::{Part, StrainState, predict, read_all};
use crate::linalg::precision::Precision;
use crate::reconcile::effect::Member;
use crate::reconcile::outcome::{ChannelGap, Gap, LoadShift};

/// Residuals of the proof runs with `members` on; amplitudes found from odd gauges (in file order) and judged on even ones, and the
/// other way round.
pub fn held_out_residual(
    frame: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
) -> (Selection, Vec<f64>) {
    let runs = frame.observations.proof_runs();
    let all = Selection::of_runs(frame, &runs);
    let n_g = frame.n_gauges();
    let predicted = predict(frame, members);
    let measured = &frame.observations.values;
    let plain = |e: &(usize, usize)| measured[e.0 * n_g + e.1] - predicted[e.0 * n_g + e.1];
    if unknown.is_empty() {
        let r = all.0.iter().map(plain).collect();
        return (all, r);
    }
    let patterns: Vec<(Vec<f64>, f64)> = unknown
        .iter()
        .flat_map(|u| {
            let read = read_patterns(frame, members, &u.amplitudes.patterns);
            let sizes = u
                .amplitudes
                .kinds
                .iter()
                .map(|&k| u.sizes.get(k).copied().unwrap_or(0.0))
                .collect::<Vec<_>>();
            read.into_iter().zip(sizes)
        })
        .collect();
    let mut out = vec![f64::NAN; all.len()];
    for &run in &runs {
        for half in [0, 1] {
            let used = Selection(
                all.0
                    .iter()
                    .copied()
                    .filter(|e| e.0 == run && e.1 % 2 == half)
                    .collect(),
            );
            let r: Vec<f64> = used.0.iter().map(plain).collect();
            let Some(p) = Precision::of(&covariance(frame, members, &used, unknown), used.len())
            else {
                continue;
            };
            let pr = p.apply(&r);
            // Conditional mean of each amplitude: V J' (J V J' + C)^-1 r.
            let amplitude = |(pattern, size): &(Vec<f64>, f64)| {
                size * size
                    * used
                        .0
                        .iter()
                        .zip(&pr)
                        .map(|(e, w)| pattern[e.1] * w)
                        .sum::<f64>()
            };
            let found: Vec<f64> = patterns.iter().map(amplitude).collect();
            for (i, e) in all
                .0
                .iter()
                .enumerate()
                .filter(|(_, e)| e.0 == run && e.1 % 2 != half)
            {
                out[i] = plain(e)
                    - patterns
                        .iter()
                        .zip(&found)
                        .map(|((pattern, _), a)| pattern[e.1] * a)
                        .sum::<f64>();
            }
        }
    }
    (all, out)
}

/// Root mean square of some numbers; zero of none.
pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut n) = (0.0, 0usize);
    for v in values.filter(|v| v.is_finite()) {
        sum += v * v;
        n += 1;
    }
    if n == 0 { 0.0 } else { (sum / n as f64).sqrt() }
}

/// Gap over all and by gauge.
pub fn gap(
    frame: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
) -> (Gap, Vec<ChannelGap>) {
    let (all, before) = held_out_residual(frame, &[], &[]);
    let (_, after) = held_out_residual(frame, members, unknown);
    let readings = all.pick(&frame.observations.values, frame.n_gauges());
    let n = all.len();
    let allowed = covariance(frame, members, &all, &[]);
    let floor: Vec<f64> = (0..n).map(|i| allowed[i * n + i].max(0.0).sqrt()).collect();
    let scale = rms(readings.iter().copied());
    let relative = |v: &[f64]| {
        if scale > 0.0 {
            rms(v.iter().copied()) / scale
        } else {
            0.0
        }
    };
    let total = Gap {
        before: relative(&before),
        after: relative(&after),
        floor: relative(&floor),
    };
    let of = |g: usize, v: &[f64]| {
        rms(all
            .0
            .iter()
            .zip(v)
            .filter(|(e, _)| e.1 == g)
            .map(|(_, v)| *v))
    };
    let channel = |(g, f): (usize, &super::frame::GaugeFacts)| ChannelGap {
        channel: f.name.clone(),
        before: of(g, &before),
        after: of(g, &after),
        floor: of(g, &floor),
        reading: of(g, &readings),
    };
    (
        total,
        frame.gauges.iter().enumerate().map(channel).collect(),
    )
}

/// Wheel loads recovered from the strain of each proof run, by generalised least squares, without and with the effects.
pub fn loads_before_after(
    frame: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
) -> Vec<LoadShift> {
    let mut out = Vec::new();
    for run in frame.observations.proof_runs() {
        let (Some(before), Some(after)) = (
            recover(frame, &[], &[], run),
            recover(frame, members, unknown, run),
        ) else {
            continue;
        };
        for (l, name) in frame.load_names.iter().enumerate() {
            out.push(LoadShift {
                run: frame.observations.runs[run].clone(),
                load: name.clone(),
                stated: frame.loads[run * frame.n_loads() + l],
                before: before[l].0,
                after: after[l].0,
                sigma: after[l].1,
            });
        }
    }
    out
}

/// Loads of one run with their standard deviations.
fn recover(
    frame: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
    run: usize,
) -> Option<Vec<(f64, f64)>> {
    let (n_l, n_g) = (frame.n_loads(), frame.n_gauges());
    let mut state = StrainState::with(frame, members);
    let [_, _, n_c] = state.shape;
    let column = |l: usize| {
        (0..n_g)
            .map(|g| state.influence[g * n_c + l])
            .collect::<Vec<f64>>()
    };
    let columns = read_patterns(frame, members, &(0..n_l).map(column).collect::<Vec<_>>());
    state.columns[run * n_c..run * n_c + n_l].fill(0.0);
    let mut rest = state.strain(run);
    read_all(frame, members, run, &mut rest, Part::Whole);
    let used = Selection::of_runs(frame, &[run]);
    let r: Vec<f64> = used
        .0
        .iter()
        .map(|&(k, g)| frame.observations.value(k, g) - rest[g])
        .collect();
    // The loads are to be found: their measured values and noise stay out.
    let mut free = frame.clone();
    free.load_noise = 0.0;
    let p = Precision::of(&covariance(&free, members, &used, unknown), used.len())?;
    let mut normal = vec![0.0; n_l * n_l];
    let mut right = vec![0.0; n_l];
    let here = |l: usize| used.0.iter().map(|e| columns[l][e.1]).collect::<Vec<f64>>();
    for l in 0..n_l {
        let w = p.apply(&here(l));
        for k in 0..n_l {
            normal[l * n_l + k] = here(k).iter().zip(&w).map(|(a, b)| a * b).sum();
        }
        right[l] = r.iter().zip(&w).map(|(a, b)| a * b).sum();
    }
    let solved = Precision::of(&normal, n_l)?;
    Some(
        solved
            .apply(&right)
            .into_iter()
            .enumerate()
            .map(|(l, v)| (v, solved.entry(l, l).max(0.0).sqrt()))
            .collect(),
    )
}
