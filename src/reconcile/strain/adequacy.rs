//! Test whether a set of effects is enough: chi-square against noise and stated uncertainty, over all readings, by gauge, by run, and held out.

use super::covariance::{Selection, covariance};
use super::frame::StrainFrame;
use super::prediction::predict;
use crate::estimate::f_tail;
use crate::linalg::cholesky::Cholesky;
use crate::reconcile::effect::{Member, SizedAmplitudes};
use crate::reconcile::outcome::Misfit;
use statrs::distribution::{ContinuousCDF, Normal};

/// Chi-squares of a set of effects.
#[derive(Clone, Debug)]
pub struct Adequacy {
    /// Reduced chi-square of the fit runs.
    pub fit: f64,
    /// Number of readings minus number of parameters.
    pub n_fit: f64,
    /// Reduced chi-square of the held-out runs given the fit runs; if no run is held out, of the fit runs.
    pub held_out: f64,
    /// Number of readings in held-out runs; zero if no run is held out.
    pub n_held_out: f64,
    /// Misfit by gauge over the fit runs.
    pub gauges: Vec<Misfit>,
    /// Misfit by run over the fit runs.
    pub runs: Vec<Misfit>,
    /// Degrees of freedom with which the covariance was estimated; infinite if it is stated. The misfit of a single gauge uses the degrees of freedom
    /// for patterns that no loads make.
    pub from: f64,
}

/// Returns the standard normal deviate of a chi-square of `n` degrees of freedom (Wilson and Hilferty 1931).
pub fn deviate(chi2: f64, n: f64) -> f64 {
    if n <= 0.0 {
        return 0.0;
    }
    let spread = 2.0 / (9.0 * n);
    ((chi2.max(0.0) / n).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Returns the deviate under a covariance estimated with `from` degrees of freedom: chi-square over `n` then follows an F distribution.
pub fn deviate_estimated(chi2: f64, n: f64, from: f64) -> f64 {
    /// Chances below this are beyond what a distribution function resolves.
    const LEAST: f64 = 1e-300;
    if !from.is_finite() || n <= 0.0 || !chi2.is_finite() {
        return deviate(chi2, n);
    }
    let chance = f_tail(chi2.max(0.0) / n, n, from.max(1.0));
    if chance > f64::EPSILON {
        Normal::standard().inverse_cdf(1.0 - chance)
    } else {
        // In the far tail, the probability beyond the deviate z is about exp(-z^2 / 2).
        (-2.0 * chance.max(LEAST).ln()).sqrt()
    }
}

fn residual(frame: &StrainFrame, members: &[Member<'_>], selection: &Selection) -> Vec<f64> {
    let n_g = frame.n_gauges();
    let predicted = selection.pick(&predict(frame, members), n_g);
    selection
        .pick(&frame.observations.values, n_g)
        .iter()
        .zip(predicted)
        .map(|(y, p)| y - p)
        .collect()
}

fn chi2(cov: &[f64], r: &[f64]) -> f64 {
    Cholesky::from_covariance(cov, r.len()).map_or(f64::NAN, |c| c.chi2(r))
}

/// Computes the chi-squares of `members` with amplitudes of the sizes in `unknown`, after `n_parameters` were fitted.
pub fn adequacy(
    frame: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
    n_parameters: usize,
) -> Adequacy {
    let fit_runs = frame.observations.fit_runs();
    let proof_runs = frame.observations.proof_runs();
    let fit = Selection::of_runs(frame, &fit_runs);
    let r = residual(frame, members, &fit);
    let cov = covariance(frame, members, &fit, unknown);
    let fit_chi2 = chi2(&cov, &r);
    let n_fit = fit.len() as f64 - n_parameters as f64;
    let (held_chi2, n_held) = if proof_runs == fit_runs {
        (fit_chi2, 0.0)
    } else {
        // Chain rule of Gaussian densities: chi^2 of the held-out runs given the fit runs is the difference.
        let all = Selection::of_runs(frame, &[fit_runs, proof_runs].concat());
        let total = chi2(
            &covariance(frame, members, &all, unknown),
            &residual(frame, members, &all),
        );
        (total - fit_chi2, (all.len() - fit.len()) as f64)
    };
    let learnt = frame.learnt.as_ref();
    let from = learnt.map_or(f64::INFINITY, |u| u.dof);
    let from_outside = learnt.map_or(f64::INFINITY, |u| u.dof_outside);
    let part = |name: &str, from: f64, keep: &dyn Fn((usize, usize)) -> bool| {
        let at: Vec<usize> = fit
            .0
            .iter()
            .enumerate()
            .filter(|(_, e)| keep(**e))
            .map(|(i, _)| i)
            .collect();
        let n = fit.len();
        let block: Vec<f64> = at
            .iter()
            .flat_map(|&i| at.iter().map(move |&j| (i, j)))
            .map(|(i, j)| cov[i * n + j])
            .collect();
        let here: Vec<f64> = at.iter().map(|&i| r[i]).collect();
        let c = chi2(&block, &here);
        let count = here.len() as f64;
        Misfit {
            name: name.to_string(),
            reduced_chi2: c / count.max(1.0),
            deviate: deviate_estimated(c, count, from),
        }
    };
    let gauges = frame
        .gauges
        .iter()
        .enumerate()
        .map(|(g, f)| part(&f.name, from_outside, &|e| e.1 == g))
        .collect();
    let runs = frame
        .observations
        .fit_runs()
        .iter()
        .map(|&k| part(&frame.observations.runs[k], from, &|e| e.0 == k))
        .collect();
    Adequacy {
        fit: fit_chi2 / n_fit.max(1.0),
        n_fit,
        held_out: if n_held > 0.0 {
            held_chi2 / n_held
        } else {
            fit_chi2 / n_fit.max(1.0)
        },
        n_held_out: n_held,
        gauges,
        runs,
        from,
    }
}
