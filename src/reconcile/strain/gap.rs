//! The gap on held-out runs, before and after, over all and by gauge, with its floor; loads recovered before and after.

use super::covariance::{Selection, SizedAmplitudes, covariance, read_patterns};
use super::frame::StrainFrame;
use super::state::{Part, StrainState, predict, read_all};
use crate::linalg::precision::Precision;
use crate::reconcile::effect::Member;
use crate::reconcile::outcome::{ChannelGap, Gap, LoadShift};

/// Residuals of the proof runs by the analyst's model as it stands.
fn plain_residual(frame: &StrainFrame, members: &[Member<'_>], selection: &Selection) -> Vec<f64> {
    let n_g = frame.n_gauges();
    let predicted = selection.pick(&predict(frame, members), n_g);
    selection
        .pick(&frame.observations.values, n_g)
        .iter()
        .zip(predicted)
        .map(|(y, p)| y - p)
        .collect()
}

/// Patterns over the gauges with their variances: errors of the wheel forces, and unknown amplitudes.
fn run_patterns(
    frame: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
) -> Vec<(Vec<f64>, f64)> {
    let state = StrainState::with(frame, members);
    let [n_g, _, n_c] = state.shape;
    let column = |l: usize| {
        (0..n_g)
            .map(|g| state.influence[g * n_c + l])
            .collect::<Vec<f64>>()
    };
    let columns: Vec<Vec<f64>> = (0..frame.n_loads()).map(column).collect();
    let noise = frame.load_noise * frame.load_noise;
    let mut out: Vec<(Vec<f64>, f64)> = read_patterns(frame, members, &columns)
        .into_iter()
        .map(|c| (c, noise))
        .collect();
    for u in unknown {
        let read = read_patterns(frame, members, &u.amplitudes.patterns);
        let size = |k: &usize| u.sizes.get(*k).copied().unwrap_or(0.0);
        out.extend(
            read.into_iter()
                .zip(u.amplitudes.kinds.iter().map(|k| size(k).powi(2))),
        );
    }
    out
}

/// What the errors that stay from run to run (influence, gains) make of each reading of `proof`, mean and variance, as the fit runs tell,
/// and with the variance of noise and wheel forces in it: the conditional Gaussian of the proof runs given the fit runs.
fn learned(
    frame: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
    proof: &Selection,
) -> (Vec<f64>, Vec<f64>) {
    let n = proof.len();
    let alone = covariance(frame, members, proof, &[]);
    let prior: Vec<f64> = (0..n).map(|i| alone[i * n + i]).collect();
    let nothing = (vec![0.0; n], prior.clone());
    let fit_runs = frame.observations.fit_runs();
    if frame.observations.proof_runs() == fit_runs {
        return nothing;
    }
    let fit = Selection::of_runs(frame, &fit_runs);
    let Some(precision) = Precision::of(&covariance(frame, members, &fit, unknown), fit.len())
    else {
        return nothing;
    };
    let both = Selection([fit.0.as_slice(), proof.0.as_slice()].concat());
    let joint = covariance(frame, members, &both, unknown);
    let weighted = precision.apply(&plain_residual(frame, members, &fit));
    let (mut mean, mut variance) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for (i, before) in prior.iter().enumerate() {
        let row = (fit.len() + i) * both.len();
        let shared = &joint[row..row + fit.len()];
        mean.push(shared.iter().zip(&weighted).map(|(a, b)| a * b).sum());
        let told = precision.apply(shared);
        variance.push(before - shared.iter().zip(&told).map(|(a, b)| a * b).sum::<f64>());
    }
    (mean, variance)
}

/// Residuals of the proof runs with `members` on, and by how much the variance of each falls when the errors of the wheel forces are
/// found from the other half of the gauges.
///
/// What differs from run to run (amplitudes of the effects, the errors of the wheel forces) is found from the odd gauges in file order
/// and judged on the even ones, and the other way round.
pub fn held_out_residual(
    frame: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
) -> (Selection, Vec<f64>, Vec<f64>) {
    let all = Selection::of_runs(frame, &frame.observations.proof_runs());
    let mut residual = plain_residual(frame, members, &all);
    let plain = residual.clone();
    let n = all.len();
    let mut found = vec![0.0; n];
    let patterns = run_patterns(frame, members, unknown);
    for &run in &frame.observations.proof_runs() {
        for half in [0, 1] {
            let of = |even: usize| {
                (0..n)
                    .filter(|&i| all.0[i].0 == run && all.0[i].1 % 2 == even)
                    .collect::<Vec<usize>>()
            };
            let (used, judged) = (of(half), of(1 - half));
            let part = Selection(used.iter().map(|&i| all.0[i]).collect());
            let Some(p) = Precision::of(&covariance(frame, members, &part, unknown), part.len())
            else {
                continue;
            };
            let pr = p.apply(&used.iter().map(|&i| plain[i]).collect::<Vec<f64>>());
            // Conditional mean of the judged readings: J V J' (J V J' + C)^-1 r.
            for &i in &judged {
                let shared = |&j: &usize| {
                    patterns
                        .iter()
                        .map(|(p, v)| v * p[all.0[i].1] * p[all.0[j].1])
                        .sum::<f64>()
                };
                residual[i] -= used
                    .iter()
                    .zip(&pr)
                    .map(|(j, w)| shared(j) * w)
                    .sum::<f64>();
            }
            // Floor: the same with the errors of the wheel forces alone.
            let Some(p) = Precision::of(&covariance(frame, members, &part, &[]), part.len()) else {
                continue;
            };
            for &i in &judged {
                let forces = &patterns[..frame.n_loads().min(patterns.len())];
                let shared = |&j: &usize| {
                    forces
                        .iter()
                        .map(|(p, v)| v * p[all.0[i].1] * p[all.0[j].1])
                        .sum::<f64>()
                };
                let c: Vec<f64> = used.iter().map(shared).collect();
                found[i] += c.iter().zip(p.apply(&c)).map(|(a, b)| a * b).sum::<f64>();
            }
        }
    }
    (all, residual, found)
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

/// Gap over all and by gauge, of the model on the analyst's own mesh. Without effects nothing is found anew in a run: before and after
/// are the same. The floor holds noise, errors of the influence as the fit runs tell of them, and the mesh.
pub fn gap(
    finer: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
) -> (Gap, Vec<ChannelGap>) {
    let frame = &finer.as_modelled();
    let all = Selection::of_runs(frame, &frame.observations.proof_runs());
    let on = |f: &StrainFrame| all.pick(&predict(f, members), f.n_gauges());
    let mesh: Vec<f64> = on(finer)
        .iter()
        .zip(on(frame))
        .map(|(a, b)| a - b)
        .collect();
    let before = plain_residual(frame, &[], &all);
    let readings = all.pick(&frame.observations.values, frame.n_gauges());
    let (after, found) = if members.is_empty() {
        (before.clone(), vec![0.0; all.len()])
    } else {
        let (_, after, found) = held_out_residual(frame, members, unknown);
        (after, found)
    };
    let (mean, variance) = learned(finer, members, unknown, &all);
    let floor: Vec<f64> = (0..all.len())
        .map(|i| {
            let known = (variance[i] - found[i]).max(0.0);
            (known + (mean[i] + mesh[i]).powi(2)).sqrt()
        })
        .collect();
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
        mesh: relative(&mesh),
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
            recover(&frame.as_modelled(), &[], &[], run),
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
