//! Covariance of the residual from noise and stated model uncertainty, over runs and gauges.

use super::calibration_scatter::{Shares, calibration_covariance, shares};
use super::frame::{Scatter, StrainFrame};
use super::prediction::read_all;
use super::state::{Part, StrainState};
use crate::reconcile::effect::{Member, SizedAmplitudes};

/// Selected readings: (run, gauge), in a fixed order.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection(pub Vec<(usize, usize)>);

impl Selection {
    /// Selects all readings of `runs`.
    pub fn of_runs(frame: &StrainFrame, runs: &[usize]) -> Self {
        Self(frame.observations.entries(runs))
    }

    /// Returns the number of readings.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns whether no reading is selected.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the selected entries of an `n_runs x n_gauges` table.
    pub fn pick(&self, table: &[f64], n_gauges: usize) -> Vec<f64> {
        self.0
            .iter()
            .map(|&(r, g)| table.get(r * n_gauges + g).copied().unwrap_or(f64::NAN))
            .collect()
    }
}

/// Returns the patterns as the gauges read them in `run`, after the linear part of the reading effects of `members`.
pub fn read_patterns(
    frame: &StrainFrame,
    members: &[Member<'_>],
    patterns: &[Vec<f64>],
    run: usize,
) -> Vec<Vec<f64>> {
    let read = |pattern: &Vec<f64>| {
        let mut row = pattern.clone();
        read_all(frame, members, run, &mut row, Part::Linear);
        row
    };
    patterns.iter().map(read).collect()
}

/// Returns the patterns as the gauges read them in a run without faults of single runs.
pub(super) fn patterns_read(
    frame: &StrainFrame,
    members: &[Member<'_>],
    patterns: &[Vec<f64>],
) -> Vec<Vec<f64>> {
    let always = |m: &&Member<'_>| m.effect.runs().is_empty();
    let members: Vec<Member<'_>> = members.iter().filter(always).copied().collect();
    read_patterns(frame, &members, patterns, 0)
}

/// Returns the covariance of the residual of `selection`, `n x n` by rows, microstrain^2.
///
/// `C = N + load_noise^2 S S' + model_rel^2 m m' + sum over scatter of b b' + V + U`, with S, m and b as the gauges read them under `members`.
///
/// The terms are:
/// - N is the noise by gauge, correlated if so stated.
/// - load_noise^2 S S' acts within each run, since an error of a measured wheel force enters all gauges.
/// - model_rel^2 m m' acts within each gauge over all runs, since an influence error is the same in all runs.
/// - b b' also acts within each gauge over all runs, with b the strain from an error of one standard deviation. A coefficient of S with the error
///   coefficient_rel adds such a b.
/// - V contains the amplitudes that are unknown in every run, and their uncertainty. Between different runs, only the repeating part of V remains.
/// - U is the uncertainty of a calibrated S (`learnt`).
///
/// Noise with a correlation between runs adds, between runs that are k apart, its variance times the k-th power of its correlation.
pub fn covariance(
    frame: &StrainFrame,
    members: &[Member<'_>],
    selection: &Selection,
    unknown: &[SizedAmplitudes],
) -> Vec<f64> {
    let state = StrainState::from_members(frame, members);
    let [n_g, n_r, n_c] = state.shape;
    let column =
        |c: usize| -> Vec<f64> { (0..n_g).map(|g| state.influence[g * n_c + c]).collect() };
    let columns: Vec<Vec<f64>> = (0..frame.n_loads()).map(column).collect();
    let mut predicted = Vec::with_capacity(n_r * n_g);
    for run in 0..n_r {
        let mut row = state.strain(run);
        read_all(frame, members, run, &mut row, Part::Linear);
        predicted.extend(row);
    }
    // Covariance of the strain within a run (wheel forces, unknown amplitudes), and between runs (the repeating part of the amplitudes).
    let mut block = vec![0.0; n_g * n_g];
    let mut repeats = vec![0.0; n_g * n_g];
    // Between runs that are k apart, this matrix is multiplied by the k-th power of the correlation.
    let mut wander: Vec<(f64, Vec<f64>)> = Vec::new();
    for pattern in &columns {
        add_outer(&mut block, pattern, frame.load_noise * frame.load_noise);
    }
    let doubt = frame.relative_uncertainty();
    let known = frame.nuisance_amplitudes();
    for u in unknown.iter().chain(&known) {
        let correlation = u.amplitudes.correlation;
        if correlation > 0.0 {
            let mut own: Vec<f64> = (0..n_g * n_g)
                .map(|i| frame.noise_between(i / n_g, i % n_g))
                .collect();
            for (pattern, &kind) in u.amplitudes.patterns.iter().zip(&u.amplitudes.kinds) {
                add_outer(&mut own, pattern, u.scatter_variance(kind));
            }
            wander.push((correlation, own));
        }
        for (pattern, &kind) in u.amplitudes.patterns.iter().zip(&u.amplitudes.kinds) {
            // The model error applies to these patterns as well.
            let own: Vec<f64> = pattern
                .iter()
                .zip(&doubt)
                .map(|(p, d)| (p * d).powi(2))
                .collect();
            let (scatter, steady) = (u.scatter_variance(kind), u.steady_variance(kind));
            for (target, variance) in [(&mut block, scatter + steady), (&mut repeats, steady)] {
                add_outer(target, pattern, variance);
                for (g, o) in own.iter().enumerate() {
                    target[g * n_g + g] += variance * o;
                }
            }
        }
    }
    let any_repeats = repeats.iter().any(|v| *v != 0.0);
    let model = frame.model_rel * frame.model_rel;
    let errors = scatter_strains(frame, members, &state);
    let across = |g: usize, r: usize, s: usize| {
        let common = model * predicted[r * n_g + g] * predicted[s * n_g + g];
        common
            + errors
                .iter()
                .map(|e| e[r * n_g + g] * e[s * n_g + g])
                .sum::<f64>()
    };
    // A channel whose contact is open in a run reads no strain in that run.
    let shares = shares_of_runs(frame, members, selection, n_g);
    let read = |of: &[f64], (r, g): (usize, usize), (s, h): (usize, usize)| -> f64 {
        let (Some(mine), Some(theirs)) = (shares[r].get(g), shares[s].get(h)) else {
            return 0.0;
        };
        let one = |&(a, p): &(usize, f64)| {
            let row = &of[a * n_g..(a + 1) * n_g];
            p * theirs.iter().map(|&(b, q)| q * row[b]).sum::<f64>()
        };
        mine.iter().map(one).sum()
    };
    let n = selection.len();
    let mut out = calibration_covariance(frame, members, &selection.0, &state)
        .unwrap_or_else(|| vec![0.0; n * n]);
    for (i, &(r, g)) in selection.0.iter().enumerate() {
        for (j, &(s, h)) in selection.0.iter().enumerate().take(i + 1) {
            let within = match r == s {
                true => read(&block, (r, g), (s, h)) + frame.noise_between(g, h),
                false => {
                    let steady = any_repeats.then(|| read(&repeats, (r, g), (s, h)));
                    let apart = r.abs_diff(s) as i32;
                    let slow = wander.iter();
                    let slow = slow.map(|(c, own)| c.powi(apart) * read(own, (r, g), (s, h)));
                    steady.unwrap_or(0.0) + slow.sum::<f64>()
                }
            };
            let persistent = if g == h { across(g, r, s) } else { 0.0 };
            out[i * n + j] += within + persistent;
            out[j * n + i] = out[i * n + j];
        }
    }
    out
}

/// Returns, by run of `selection` and channel, the share of each gauge's strain in the channel. Other runs have an empty list.
fn shares_of_runs(
    frame: &StrainFrame,
    members: &[Member<'_>],
    selection: &Selection,
    n_g: usize,
) -> Vec<Vec<Shares>> {
    let mut out: Vec<Vec<Shares>> = vec![Vec::new(); frame.n_runs()];
    for &(run, _) in &selection.0 {
        if let Some(own) = out.get_mut(run).filter(|own| own.is_empty()) {
            *own = shares(frame, members, run, n_g);
        }
    }
    out
}

/// Adds `variance` times the outer product of `pattern` with itself.
pub(super) fn add_outer(block: &mut [f64], pattern: &[f64], variance: f64) {
    if variance == 0.0 {
        return;
    }
    for (row, a) in block.chunks_exact_mut(pattern.len().max(1)).zip(pattern) {
        if *a != 0.0 {
            row.iter_mut()
                .zip(pattern)
                .for_each(|(cell, b)| *cell += variance * a * b);
        }
    }
}

/// Returns the strain, `n_runs x n_gauges`, from each independent error of the influence, as the gauges read it under `members`.
fn scatter_strains(
    frame: &StrainFrame,
    members: &[Member<'_>],
    state: &StrainState,
) -> Vec<Vec<f64>> {
    let [n_g, n_r, n_c] = state.shape;
    let strain = |error: &[f64], columns: std::ops::Range<usize>| {
        let mut out = Vec::with_capacity(n_r * n_g);
        for run in 0..n_r {
            let acts = &state.columns[run * n_c..(run + 1) * n_c];
            let of = |g: usize| columns.clone().map(|c| error[g * n_c + c] * acts[c]).sum();
            let mut row: Vec<f64> = (0..n_g).map(of).collect();
            read_all(frame, members, run, &mut row, Part::Linear);
            out.extend(row);
        }
        out
    };
    let mut out = Vec::new();
    for s in &frame.scatter {
        match s {
            Scatter::Together(error) => out.push(strain(error, 0..n_c)),
            Scatter::Single(error) => out.extend((0..n_c).map(|c| strain(error, c..c + 1))),
        }
    }
    if frame.coefficient_rel > 0.0 {
        let relative = |v: &f64| frame.coefficient_rel * v;
        let own: Vec<f64> = state.influence.iter().map(relative).collect();
        out.extend((0..n_c).map(|c| strain(&own, c..c + 1)));
    }
    out.retain(|e| e.iter().any(|v| *v != 0.0));
    out
}
