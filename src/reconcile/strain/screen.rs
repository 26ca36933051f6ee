//! Approximate test of candidates on top of a fitted set, which selects candidates for an exact fit.

use super::likelihood::{Fit, Likelihood};
use super::prediction::predict;
use super::size::{RunPrecision, run_by_run_log_likelihood};
use super::state::Part;
use crate::linalg::precision::Precision;
use crate::linalg::spd::dot;
use crate::reconcile::effect::{Amplitudes, Discrepancy, Member, Parameter, Stage};
use crate::reconcile::search::{Addition, ScoredSet};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Fitted set to which candidates are added.
struct Base<'b> {
    scored: &'b ScoredSet<Fit>,
    members: Vec<Member<'b>>,
    /// Members with amplitudes.
    families: Vec<usize>,
    /// Prediction of all readings by the set.
    predicted: Vec<f64>,
    precision: &'b Precision,
    /// Precision times residual.
    weighted: Vec<f64>,
}

impl Likelihood<'_> {
    /// Returns the candidates that may be added to `base`, by their approximate gain, best first.
    pub(super) fn additions_to(&mut self, base: &ScoredSet<Fit>) -> Vec<Addition> {
        let Some(precision) = self.precision(&base.fit.sizes) else {
            return Vec::new();
        };
        let slow = self.slow_noise(base, &precision);
        let members = self.members(&base.set, &base.fit.parameters);
        let now = Base {
            scored: base,
            predicted: predict(self.frame, &members),
            weighted: precision.apply(&base.fit.residual),
            precision: precision.as_ref(),
            families: base.fit.sizes.iter().map(|s| s.0).collect(),
            members,
        };
        let alone = self
            .blocks
            .precisions(&self.sized_amplitudes(&base.fit.sizes, &now.members));
        let without = run_by_run_log_likelihood(
            &self.blocks,
            &base.fit.residual,
            &self.sized_amplitudes(&base.fit.sizes, &now.members),
        );
        let (this, now, alone) = (&*self, &now, &alone);
        let tried = this
            .candidates
            .par_iter()
            .enumerate()
            .map(|(c, candidate)| {
                let general = candidate.effect.discrepancy();
                let form = matches!(general, Some(Discrepancy::Form(_)));
                let smooth = matches!(general, Some(Discrepancy::Smooth(_)));
                if base.set.contains(&c) || smooth || (form && this.names_only) {
                    return None;
                }
                if let Some(known) = slow.iter().find(|a| a.candidate == c) {
                    return Some(known.clone());
                }
                let (gain, parameters, sizes) = match candidate.effect.amplitudes(this.frame) {
                    Some(_) if candidate.effect.parameters().is_empty() => {
                        let (after, sizes) = this.run_by_run(c, now);
                        (after - without, Vec::new(), sizes)
                    }
                    Some(a) => this.screen_scattering(c, &a, now, alone),
                    None => {
                        let (gain, theta) = this.screen_parameters(c, now);
                        (gain, theta, Vec::new())
                    }
                };
                Some(Addition {
                    candidate: c,
                    gain: gain + candidate.log_prior,
                    parameters,
                    sizes,
                })
            });
        let mut out: Vec<Addition> = tried
            .collect::<Vec<Option<Addition>>>()
            .into_iter()
            .flatten()
            .collect();
        out.retain(|a| a.gain.is_finite());
        out.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        out
    }

    /// Returns the gain of noise that is correlated from run to run: the change of `-(r' P r - ln det P) / 2` from the base set. P includes the
    /// correlation between runs.
    fn slow_noise(&mut self, base: &ScoredSet<Fit>, precision: &Precision) -> Vec<Addition> {
        let r = &base.fit.residual;
        let density = |p: &Precision| -0.5 * (dot(r, &p.apply(r)) + p.log_det());
        let before = density(precision);
        let mut out = Vec::new();
        for (candidate, c) in self.candidates.iter().enumerate() {
            let Some(a) = (c.effect.amplitudes(self.frame)).filter(|a| a.correlation > 0.0) else {
                continue;
            };
            let own = [a.usual, a.steady].concat();
            let sizes = [base.fit.sizes.as_slice(), &[(candidate, own.clone())]].concat();
            if let Some(with) = self.precision(&sizes) {
                out.push(Addition {
                    candidate,
                    gain: density(&with) - before + c.log_prior,
                    parameters: Vec::new(),
                    sizes: own,
                });
            }
        }
        out
    }

    /// Returns the change of the prediction of the selection by candidate `c`, at the readings that it changes.
    fn change(&self, c: usize, base: &Base<'_>, theta: &[f64]) -> Vec<(usize, f64)> {
        let Some(candidate) = self.candidates.get(c) else {
            return Vec::new();
        };
        let effect = candidate.effect.as_ref();
        let n_g = self.frame.n_gauges();
        let all = |some: Vec<usize>, n: usize| {
            if some.is_empty() {
                (0..n).collect()
            } else {
                some
            }
        };
        let gauges: Vec<usize> = all(effect.gauges(), n_g);
        let touched = effect.runs();
        let runs = self
            .runs
            .iter()
            .filter(|r| touched.is_empty() || touched.contains(r));
        let place = |run: usize, g: usize| self.index.get(run * n_g + g).copied().flatten();
        let mut out = Vec::new();
        if effect.stage() == Stage::Reading {
            // Effects on the reading act last, on the predicted readings.
            for &run in runs {
                let Some(before) = base.predicted.get(run * n_g..(run + 1) * n_g) else {
                    continue;
                };
                let mut row = before.to_vec();
                effect.read(self.frame, theta, run, &mut row, Part::Whole);
                out.extend(
                    gauges
                        .iter()
                        .filter_map(|&g| Some((place(run, g)?, row[g] - before[g]))),
                );
            }
            return out;
        }
        let mut members = base.members.clone();
        members.push(Member {
            effect,
            parameters: theta,
        });
        // Members act in the order of the set, as in a fit.
        let now = predict(self.frame, &members);
        for &run in runs {
            let at = |&g: &usize| {
                Some((
                    place(run, g)?,
                    now[run * n_g + g] - base.predicted[run * n_g + g],
                ))
            };
            out.extend(gauges.iter().filter_map(at));
        }
        out
    }

    /// Computes the approximate gain of log evidence by adding candidate `c`: one Newton step per parameter from each start.
    fn screen_parameters(&self, c: usize, base: &Base<'_>) -> (f64, Vec<f64>) {
        let Some(candidate) = self.candidates.get(c) else {
            return (f64::NEG_INFINITY, Vec::new());
        };
        let described = candidate.effect.parameters();
        let gain = |change: &[(usize, f64)]| {
            let along: f64 = change.iter().map(|&(i, v)| v * base.weighted[i]).sum();
            along - 0.5 * quadratic_form(base.precision, change)
        };
        match described.as_slice() {
            [] => (gain(&self.change(c, base, &[])), Vec::new()),
            [one] if one.starts == [one.neutral] => {
                let (gain, theta, _) = self.linear_step(c, base, one);
                (gain, vec![theta])
            }
            _ => self.newton_steps(c, base, &described, &gain),
        }
    }

    /// Returns gain and parameter of a candidate that is nearly linear in its only parameter, and the slope x of its prediction. The gain is
    /// `(x' P r)^2 / (2 k) - ln(k s^2) / 2` with `k = x' P x + 1 / s^2`.
    fn linear_step(
        &self,
        c: usize,
        base: &Base<'_>,
        p: &Parameter,
    ) -> (f64, f64, Vec<(usize, f64)>) {
        let mut slope = self.change(c, base, &[p.neutral + p.step]);
        slope.iter_mut().for_each(|e| e.1 /= p.step);
        let variance = p.prior_sd * p.prior_sd;
        let curvature = quadratic_form(base.precision, &slope) + 1.0 / variance;
        let pull: f64 = slope.iter().map(|&(i, v)| v * base.weighted[i]).sum();
        let gain = 0.5 * pull * pull / curvature - 0.5 * (curvature * variance).ln();
        (gain, p.neutral + pull / curvature, slope)
    }

    fn newton_steps(
        &self,
        c: usize,
        base: &Base<'_>,
        described: &[Parameter],
        gain: &dyn Fn(&[(usize, f64)]) -> f64,
    ) -> (f64, Vec<f64>) {
        let mut best = (f64::NEG_INFINITY, Vec::new());
        let starts: Vec<Vec<f64>> = match described {
            [one] => one.starts.iter().map(|s| vec![*s]).collect(),
            many => vec![
                many.iter()
                    .map(|p| p.starts.first().copied().unwrap_or(p.neutral))
                    .collect(),
            ],
        };
        for mut theta in starts {
            let mut log_width = 0.0;
            // Two sweeps over the parameters. Each step changes one parameter.
            for _ in 0..2 {
                log_width = 0.0;
                for (k, p) in described.iter().enumerate() {
                    let here = self.change(c, base, &theta);
                    let mut moved = theta.clone();
                    moved[k] += p.step;
                    let there = self.change(c, base, &moved);
                    let slope: Vec<(usize, f64)> = here
                        .iter()
                        .zip(&there)
                        .map(|(a, b)| (a.0, (b.1 - a.1) / p.step))
                        .collect();
                    let (own, cross) = products(base.precision, &slope, &here);
                    let curvature = own + 1.0 / (p.prior_sd * p.prior_sd);
                    let pull: f64 = slope
                        .iter()
                        .map(|&(i, v)| v * base.weighted[i])
                        .sum::<f64>()
                        - cross
                        - (theta[k] - p.neutral) / (p.prior_sd * p.prior_sd);
                    theta[k] += pull / curvature;
                    log_width += 0.5 * curvature.ln() + p.prior_sd.ln();
                }
            }
            let prior: f64 = described
                .iter()
                .zip(&theta)
                .map(|(p, t)| 0.5 * ((t - p.neutral) / p.prior_sd).powi(2))
                .sum();
            let value = gain(&self.change(c, base, &theta)) - prior - log_width;
            if value > best.0 {
                best = (value, theta);
            }
        }
        best
    }

    /// Screens a candidate with one parameter and one pattern whose amplitude scatters from run to run. For each of a few scatter sizes, the
    /// parameter follows from a linear step with this scatter. The size with the largest gain is used. Let s = p' P r and h = p' P p in a run.
    /// Scatter of variance v then gains the sum over runs of `s^2 v / (2 (1 + v h)) - ln(1 + v h) / 2`.
    fn screen_scattering(
        &self,
        c: usize,
        amplitudes: &Amplitudes,
        base: &Base<'_>,
        alone: &[RunPrecision<'_>],
    ) -> (f64, Vec<f64>, Vec<f64>) {
        /// Sizes tried, of the usual one.
        const SIZES: [f64; 9] = [0.1, 0.2, 0.35, 0.6, 1.0, 1.7, 3.0, 6.0, 12.0];
        let nothing = (f64::NEG_INFINITY, Vec::new(), Vec::new());
        let (Some(candidate), [pattern], [usual]) = (
            self.candidates.get(c),
            amplitudes.patterns.as_slice(),
            amplitudes.usual.as_slice(),
        ) else {
            return nothing;
        };
        let described = candidate.effect.parameters();
        let [p] = described.as_slice() else {
            return nothing;
        };
        let slope: Vec<(usize, f64)> = {
            let mut change = self.change(c, base, &[p.neutral + p.step]);
            change.iter_mut().for_each(|e| e.1 /= p.step);
            change
        };
        let at: BTreeMap<usize, f64> = slope.into_iter().collect();
        // By run: p'Pr, p'Px, p'Pp, x'Pr and x'Px, with r the residual and x the slope of the parameter.
        let sums: Vec<[f64; 5]> = alone
            .iter()
            .map(|run| {
                let of =
                    |f: &dyn Fn(usize) -> f64| run.at.iter().map(|i| f(*i)).collect::<Vec<f64>>();
                let r = of(&|i| base.scored.fit.residual[i]);
                let x = of(&|i| at.get(&i).copied().unwrap_or(0.0));
                let own: Vec<f64> = run.gauges.iter().map(|&g| pattern[g]).collect();
                let (wp, wx) = (run.precision.apply(&own), run.precision.apply(&x));
                [
                    dot(&wp, &r),
                    dot(&wp, &x),
                    dot(&wp, &own),
                    dot(&wx, &r),
                    dot(&wx, &x),
                ]
            })
            .collect();
        let variance = p.prior_sd * p.prior_sd;
        let mut best = nothing;
        for size in SIZES.map(|s| s * usual) {
            let v = size * size;
            let (mut pull, mut own, mut gain) = (0.0, 1.0 / variance, 0.0);
            for [pr, px, pp, xr, xx] in &sums {
                let share = v / (1.0 + v * pp);
                pull += xr - share * px * pr;
                own += xx - share * px * px;
                gain += 0.5 * pr * pr * share - 0.5 * (v * pp).ln_1p();
            }
            gain += 0.5 * pull * pull / own - 0.5 * (own * variance).ln();
            gain -= 0.5 * (sums.len().max(1) as f64).ln();
            if gain > best.0 {
                best = (gain, vec![p.neutral + pull / own], vec![size, 0.0]);
            }
        }
        best
    }

    /// Returns the run-by-run log likelihood with the amplitudes of `c` in addition to the amplitudes of `base`, and the sizes of all these
    /// amplitudes.
    fn run_by_run(&self, c: usize, base: &Base<'_>) -> (f64, Vec<f64>) {
        let families = [base.families.as_slice(), &[c]].concat();
        let sizes = self.sizes_from(&families, &base.members, &base.scored.fit.residual);
        let unknown = self.sized_amplitudes(&sizes, &base.members);
        let value = run_by_run_log_likelihood(&self.blocks, &base.scored.fit.residual, &unknown);
        (value, sizes.last().map(|s| s.1.clone()).unwrap_or_default())
    }
}

/// Returns x' P x and x' P y for few entries at the same indices.
fn products(precision: &Precision, x: &[(usize, f64)], y: &[(usize, f64)]) -> (f64, f64) {
    if x.len() < precision.n() / 3 {
        let (mut own, mut cross) = (0.0, 0.0);
        for (&(i, a), &(_, b)) in x.iter().zip(y) {
            let row: f64 = x.iter().map(|&(j, v)| v * precision.entry(i, j)).sum();
            own += a * row;
            cross += b * row;
        }
        return (own, cross);
    }
    let px = precision.apply_sparse(x);
    (
        x.iter().map(|&(i, v)| v * px[i]).sum(),
        y.iter().map(|&(i, v)| v * px[i]).sum(),
    )
}

fn quadratic_form(precision: &Precision, x: &[(usize, f64)]) -> f64 {
    products(precision, x, x).0
}
