//! Covariance of readings from the uncertainty of a calibrated S and the scatter between repeats of one loading.

use super::frame::StrainFrame;
use super::prediction::read_all;
use super::state::{Part, StrainState};
use crate::linalg::spd::dot;
use crate::reconcile::effect::Member;
use crate::sensitivity::Uncertainty;

/// Gauges with their shares in the reading of a channel.
pub(super) type Shares = Vec<(usize, f64)>;

/// Returns the covariance of the readings of `selection` (run, gauge), `n x n` by rows, microstrain^2. `None` if S was not calibrated.
///
/// `Cov(y_rg, y_sh) = scale^2 (sum_jk f_rj f_sk Cov(S_gj, S_hk) + [r = s] q(f_r)^2 C_gh)`, with the gauge readings as `members` change them. A
/// channel with reversed polarity reverses the sign of its share.
pub(super) fn calibration_covariance(
    frame: &StrainFrame,
    members: &[Member<'_>],
    selection: &[(usize, usize)],
    state: &StrainState,
) -> Option<Vec<f64>> {
    let uncertainty = frame.learnt.as_ref()?;
    let [n_g, _, n_c] = state.shape;
    let n_l = frame.n_loads();
    let n = selection.len();
    let mut out = vec![0.0; n * n];
    let runs = runs_of(selection, n_g, |run| shares(frame, members, run, n_g));
    let acts = |run: usize| &state.columns[run * n_c..run * n_c + n_l];
    let scale2 = uncertainty.scale * uncertainty.scale;
    for (a, one) in runs.iter().enumerate() {
        let half = contract_rows(uncertainty, n_g, acts(one.run));
        for other in &runs[..=a] {
            let same = (one.run == other.run).then(|| uncertainty.mean_square_of(acts(one.run)));
            let mut block = contract_columns(&half, n_g, acts(other.run));
            if let Some(q2) = same {
                let scatter = block.iter_mut().zip(&uncertainty.scatter);
                scatter.for_each(|(cell, c)| *cell += q2 * c);
            }
            for (i, mine) in &one.entries {
                for (j, theirs) in &other.entries {
                    let mut sum = 0.0;
                    for &(g, p) in mine {
                        sum += p * theirs
                            .iter()
                            .map(|&(h, q)| q * block[g * n_g + h])
                            .sum::<f64>();
                    }
                    out[i * n + j] = scale2 * sum;
                    out[j * n + i] = scale2 * sum;
                }
            }
        }
    }
    Some(out)
}

/// Returns the log density of a multivariate Student's t minus the log density of a Gaussian, without constants:
/// `chi^2 / 2 - (v + n) / 2 ln(1 + chi^2 / v)`. `v` is the number of degrees of freedom of an estimated covariance. 0 if the covariance is stated.
pub(super) fn heavier_tail(frame: &StrainFrame, chi2: f64, n: usize) -> f64 {
    match &frame.learnt {
        Some(u) if u.dof.is_finite() => {
            0.5 * (chi2 - (u.dof + n as f64) * (chi2.max(0.0) / u.dof.max(1.0)).ln_1p())
        }
        _ => 0.0,
    }
}

/// Returns the expected factor on the precision given a residual of `chi2`: `(v + n) / (v + chi^2)`. A multivariate Student's t is a Gaussian whose
/// precision has an unknown factor. Returns 1 if the covariance is stated.
pub(super) fn expected_precision(frame: &StrainFrame, chi2: f64, n: usize) -> f64 {
    match &frame.learnt {
        Some(u) if u.dof.is_finite() => {
            (u.dof.max(1.0) + n as f64) / (u.dof.max(1.0) + chi2.max(0.0))
        }
        _ => 1.0,
    }
}

/// Readings of a run: index of each reading in the selection, and the shares of the gauges in the reading.
struct Run {
    run: usize,
    entries: Vec<(usize, Shares)>,
}

fn runs_of(
    selection: &[(usize, usize)],
    n_g: usize,
    shares: impl Fn(usize) -> Vec<Shares>,
) -> Vec<Run> {
    let mut out: Vec<Run> = Vec::new();
    let mut own: Vec<Shares> = Vec::new();
    for (i, &(run, g)) in selection.iter().enumerate() {
        if out.last().is_none_or(|r| r.run != run) {
            own = shares(run);
            out.push(Run {
                run,
                entries: Vec::with_capacity(n_g),
            });
        }
        if let (Some(last), Some(s)) = (out.last_mut(), own.get(g)) {
            last.entries.push((i, s.clone()));
        }
    }
    out
}

/// Returns the share of each gauge's strain in the reading of each channel, by channel.
pub(super) fn shares(
    frame: &StrainFrame,
    members: &[Member<'_>],
    run: usize,
    n_g: usize,
) -> Vec<Shares> {
    let mut out = vec![Shares::new(); n_g];
    for gauge in 0..n_g {
        let mut row = vec![0.0; n_g];
        row[gauge] = 1.0;
        read_all(frame, members, run, &mut row, Part::Linear);
        for (channel, v) in row.into_iter().enumerate().filter(|c| c.1 != 0.0) {
            out[channel].push((gauge, v));
        }
    }
    out
}

/// Returns `sum_j f_j Cov(S_gj, S_hk)`, `n x n k` by rows.
fn contract_rows(uncertainty: &Uncertainty, n: usize, f: &[f64]) -> Vec<f64> {
    let width = n * f.len();
    let mut out = vec![0.0; n * width];
    for (g, row) in out.chunks_exact_mut(width.max(1)).enumerate() {
        for (j, fj) in f.iter().enumerate().filter(|v| *v.1 != 0.0) {
            let first = (g * f.len() + j) * width;
            let entries = uncertainty.covariance.get(first..first + width);
            let entries = entries.unwrap_or(&[]);
            row.iter_mut()
                .zip(entries)
                .for_each(|(cell, c)| *cell += fj * c);
        }
    }
    out
}

/// Returns `sum_k f_k half_g,hk`, `n x n` by rows.
fn contract_columns(half: &[f64], n: usize, f: &[f64]) -> Vec<f64> {
    let k = f.len().max(1);
    let out: Vec<f64> = half.chunks_exact(k).map(|e| dot(e, f)).collect();
    if out.len() == n * n {
        out
    } else {
        vec![0.0; n * n]
    }
}
