//! Evidence of a set of effects: exact prediction, parameters optimised, amplitudes integrated out.

use super::covariance::{Selection, covariance, read_patterns};
use super::frame::StrainFrame;
use super::learnt::heavier_tail;
use super::prediction::predict;
use super::size::{RunBlocks, RunPrecision, run_by_run_log_likelihood, usual_sizes};
use super::state::Part;
use crate::linalg::precision::Precision;
use crate::reconcile::effect::{
    Amplitudes, Candidate, Discrepancy, Member, Parameter, SizedAmplitudes, Stage, full_id,
};
use crate::reconcile::search::{Addition, Scored, Scorer};
use std::collections::BTreeMap;
use std::rc::Rc;

/// What fitting a set leaves behind.
#[derive(Clone, Debug, Default)]
pub struct Fit {
    /// By member of the set: its parameters.
    pub parameters: Vec<Vec<f64>>,
    /// By member: standard deviations of its parameters.
    pub sigma: Vec<Vec<f64>>,
    /// Covariance of all parameters, members in order, by rows.
    pub covariance: Vec<f64>,
    /// Members with amplitudes: candidate number and sizes (see [`SizedAmplitudes::sizes`]).
    pub sizes: Vec<(usize, Vec<f64>)>,
    /// Residual of the selection, parameters in.
    pub residual: Vec<f64>,
    /// r' C^-1 r.
    pub chi2: f64,
}

/// Candidates with amplitudes, and the rounded logs of their sizes.
type RoundedSizes = Vec<(usize, Vec<i64>)>;

/// Log evidence of sets of effects on the readings of a selection.
pub struct Likelihood<'a> {
    frame: &'a StrainFrame,
    candidates: &'a [Candidate],
    selection: Selection,
    readings: Vec<f64>,
    /// The covariance is that of the prediction with these effects on.
    reference: &'a [(usize, Vec<f64>)],
    cache: BTreeMap<RoundedSizes, Option<Rc<Precision>>>,
    /// Where a (run, gauge) sits in the selection, by run times gauges plus gauge.
    index: Vec<Option<usize>>,
    /// Runs of the selection.
    runs: Vec<usize>,
    /// Covariance run by run.
    blocks: RunBlocks,
    /// Are general forms of discrepancy left out of the search?
    names_only: bool,
}

/// Sizes of amplitudes are rounded to this step of their natural log, so that sets share a factorisation.
const SIZE_STEP: f64 = 0.35;

impl<'a> Likelihood<'a> {
    /// A likelihood over `runs` with the covariance of the prediction with `reference` (candidates with parameters) on.
    pub fn new(
        frame: &'a StrainFrame,
        candidates: &'a [Candidate],
        runs: &[usize],
        reference: &'a [(usize, Vec<f64>)],
    ) -> Self {
        let selection = Selection::of_runs(frame, runs);
        let readings = selection.pick(&frame.observations.values, frame.n_gauges());
        let mut index = vec![None; frame.n_runs() * frame.n_gauges()];
        for (i, &(r, g)) in selection.0.iter().enumerate() {
            index[r * frame.n_gauges() + g] = Some(i);
        }
        let member = |r: &'a (usize, Vec<f64>)| {
            let effect = candidates.get(r.0)?.effect.as_ref();
            Some(Member {
                effect,
                parameters: &r.1,
            })
        };
        let members: Vec<Member<'_>> = reference.iter().filter_map(member).collect();
        let blocks = RunBlocks::of(frame, &members, &selection);
        Self {
            frame,
            candidates,
            selection,
            readings,
            reference,
            cache: BTreeMap::new(),
            index,
            runs: runs.to_vec(),
            blocks,
            names_only: false,
        }
    }

    /// The same with the general forms of discrepancy left out of the search.
    pub fn names_only(self) -> Self {
        Self {
            names_only: true,
            ..self
        }
    }

    /// The selection.
    pub fn selection(&self) -> &Selection {
        &self.selection
    }

    /// Members of `set` with `parameters`.
    pub fn members<'b>(&'b self, set: &[usize], parameters: &'b [Vec<f64>]) -> Vec<Member<'b>> {
        let member = |(&c, p): (&usize, &'b Vec<f64>)| {
            self.candidates.get(c).map(|c| Member {
                effect: c.effect.as_ref(),
                parameters: p.as_slice(),
            })
        };
        set.iter().zip(parameters).filter_map(member).collect()
    }

    /// Residual of the selection with `set` on.
    pub fn residual(&self, set: &[usize], parameters: &[Vec<f64>]) -> Vec<f64> {
        let predicted = predict(self.frame, &self.members(set, parameters));
        let picked = self.selection.pick(&predicted, self.frame.n_gauges());
        self.readings
            .iter()
            .zip(picked)
            .map(|(y, p)| y - p)
            .collect()
    }

    /// Precision of the residual with amplitudes of these sizes unknown.
    pub fn precision(&mut self, sizes: &[(usize, Vec<f64>)]) -> Option<Rc<Precision>> {
        let rounded = |v: &f64| (v.max(f64::MIN_POSITIVE).ln() / SIZE_STEP).round() as i64;
        let key: RoundedSizes = sizes
            .iter()
            .map(|(c, s)| (*c, s.iter().map(rounded).collect()))
            .collect();
        if let Some(known) = self.cache.get(&key) {
            return known.clone();
        }
        let unrounded = |k: &i64| (*k as f64 * SIZE_STEP).exp();
        let mut unknown = Vec::new();
        for (c, ks) in &key {
            let amplitudes = self.candidates.get(*c)?.effect.amplitudes(self.frame)?;
            unknown.push(SizedAmplitudes {
                amplitudes,
                sizes: ks.iter().map(unrounded).collect(),
            });
        }
        let reference: Vec<usize> = self.reference.iter().map(|r| r.0).collect();
        let parameters: Vec<Vec<f64>> = self.reference.iter().map(|r| r.1.clone()).collect();
        let members = self.members(&reference, &parameters);
        let cov = covariance(self.frame, &members, &self.selection, &unknown);
        let made = Precision::of(&cov, self.selection.len()).map(Rc::new);
        self.cache.insert(key, made.clone());
        made
    }

    fn parameters_of(&self, set: &[usize]) -> Vec<Vec<Parameter>> {
        set.iter()
            .map(|&c| {
                self.candidates
                    .get(c)
                    .map(|c| c.effect.parameters())
                    .unwrap_or_default()
            })
            .collect()
    }

    /// Parameters of `set` that maximise the posterior, by Gauss-Newton from `start` with step halving.
    fn optimise(
        &self,
        set: &[usize],
        start: Vec<Vec<f64>>,
        precision: &Precision,
    ) -> Option<Optimum> {
        /// Steps: a quadratic objective needs two.
        const STEPS: usize = 12;
        /// Gain of log posterior below which the optimum is reached.
        const SETTLED: f64 = 1e-6;
        let described = self.parameters_of(set);
        let flat: Vec<(usize, usize, &Parameter)> = described
            .iter()
            .enumerate()
            .flat_map(|(m, ps)| ps.iter().enumerate().map(move |(k, p)| (m, k, p)))
            .collect();
        let objective = |theta: &[Vec<f64>]| {
            let r = self.residual(set, theta);
            let pr = precision.apply(&r);
            let fit: f64 = r.iter().zip(&pr).map(|(a, b)| a * b).sum();
            let prior: f64 = flat
                .iter()
                .map(|&(m, k, p)| ((theta[m][k] - p.neutral) / p.prior_sd).powi(2))
                .sum();
            (0.5 * (fit + prior), fit, r, pr)
        };
        let mut theta = start;
        let (mut value, mut chi2, mut r, mut pr) = objective(&theta);
        let n = flat.len();
        let mut hessian = Vec::new();
        for _ in 0..STEPS {
            // Columns of -dr/dtheta: the change of the prediction.
            let mut columns = Vec::with_capacity(n);
            for &(m, k, p) in &flat {
                let mut moved = theta.clone();
                moved[m][k] += p.step;
                let rm = self.residual(set, &moved);
                columns.push(
                    r.iter()
                        .zip(&rm)
                        .map(|(a, b)| (a - b) / p.step)
                        .collect::<Vec<f64>>(),
                );
            }
            let weighted: Vec<Vec<f64>> = columns.iter().map(|c| apply_few(precision, c)).collect();
            hessian = vec![0.0; n * n];
            let mut gradient = vec![0.0; n];
            for (i, &(m, k, p)) in flat.iter().enumerate() {
                for (j, w) in weighted.iter().enumerate() {
                    hessian[i * n + j] = columns[i].iter().zip(w).map(|(a, b)| a * b).sum();
                }
                hessian[i * n + i] += 1.0 / (p.prior_sd * p.prior_sd);
                let slope: f64 = columns[i].iter().zip(&pr).map(|(a, b)| a * b).sum();
                gradient[i] = slope - (theta[m][k] - p.neutral) / (p.prior_sd * p.prior_sd);
            }
            if n == 0 {
                break;
            }
            let step = Precision::of(&hessian, n)?.apply(&gradient);
            let mut scale = 1.0;
            let mut improved = false;
            for _ in 0..6 {
                let mut moved = theta.clone();
                for (&(m, k, _), s) in flat.iter().zip(&step) {
                    moved[m][k] += scale * s;
                }
                let (v, c, rm, prm) = objective(&moved);
                if v < value - SETTLED {
                    (theta, value, chi2, r, pr) = (moved, v, c, rm, prm);
                    improved = true;
                    break;
                }
                scale *= 0.4;
            }
            if !improved {
                break;
            }
        }
        Some(Optimum {
            theta,
            value,
            chi2,
            residual: r,
            hessian,
        })
    }

    /// Every combination of the starts of the members' parameters, at most a dozen.
    fn starts(&self, set: &[usize]) -> Vec<Vec<Vec<f64>>> {
        const MOST: usize = 12;
        let mut out: Vec<Vec<Vec<f64>>> = vec![Vec::new()];
        for parameters in self.parameters_of(set) {
            let mut here: Vec<Vec<f64>> = vec![Vec::new()];
            for p in &parameters {
                here = here
                    .iter()
                    .flat_map(|h| p.starts.iter().map(move |s| [h.as_slice(), &[*s]].concat()))
                    .collect();
            }
            out = out
                .iter()
                .flat_map(|o| {
                    here.iter()
                        .map(move |h| [o.as_slice(), std::slice::from_ref(h)].concat())
                })
                .collect();
            out.truncate(MOST);
        }
        out
    }

    /// Parameters of `set` from a fit of a neighbour and of what is added; `None` where a member is in neither.
    fn start_near(
        &self,
        set: &[usize],
        near: &Scored<Fit>,
        addition: Option<&Addition>,
    ) -> Option<Vec<Vec<f64>>> {
        let known = |c: &usize| {
            let at = near.set.iter().position(|n| n == c);
            let from_near = at.and_then(|k| near.fit.parameters.get(k).cloned());
            from_near.or_else(|| {
                addition
                    .filter(|a| a.candidate == *c)
                    .map(|a| a.parameters.clone())
            })
        };
        set.iter().map(known).collect()
    }

    fn best_of_starts(&self, set: &[usize], precision: &Precision) -> Option<Optimum> {
        let found = self
            .starts(set)
            .into_iter()
            .filter_map(|s| self.optimise(set, s, precision));
        found.min_by(|a, b| a.value.total_cmp(&b.value))
    }

    fn with_amplitudes(&self, set: &[usize]) -> Vec<usize> {
        set.iter()
            .copied()
            .filter(|&c| {
                self.candidates
                    .get(c)
                    .is_some_and(|c| c.effect.amplitudes(self.frame).is_some())
            })
            .collect()
    }

    /// Usual sizes of the amplitudes of the members that have some, refined by what `residual` shows.
    fn sizes_from(
        &self,
        families: &[usize],
        members: &[Member<'_>],
        residual: &[f64],
    ) -> Vec<(usize, Vec<f64>)> {
        let list: Vec<_> = families
            .iter()
            .filter_map(|&c| self.candidates.get(c)?.effect.amplitudes(self.frame))
            .collect();
        let read: Vec<_> = list
            .into_iter()
            .map(|mut a| {
                a.patterns = read_patterns(self.frame, members, &a.patterns);
                a
            })
            .collect();
        let sizes = usual_sizes(&self.blocks, residual, &read);
        families.iter().copied().zip(sizes).collect()
    }
}

struct Optimum {
    theta: Vec<Vec<f64>>,
    value: f64,
    chi2: f64,
    residual: Vec<f64>,
    hessian: Vec<f64>,
}

impl Scorer for Likelihood<'_> {
    type Fit = Fit;

    fn score(
        &mut self,
        set: &[usize],
        from: Option<(&Scored<Fit>, Option<&Addition>)>,
    ) -> Option<Scored<Fit>> {
        let families = self.with_amplitudes(set);
        let mut sizes: Vec<(usize, Vec<f64>)> = Vec::new();
        for &c in &families {
            let known = from.and_then(|(near, _)| {
                near.fit
                    .sizes
                    .iter()
                    .find(|s| s.0 == c)
                    .map(|s| s.1.clone())
            });
            let added =
                from.and_then(|(_, a)| a.filter(|a| a.candidate == c).map(|a| a.sizes.clone()));
            let a = self.candidates.get(c)?.effect.amplitudes(self.frame)?;
            let usual = [a.usual, a.steady].concat();
            sizes.push((
                c,
                known
                    .or(added)
                    .filter(|s| s.len() == usual.len())
                    .unwrap_or(usual),
            ));
        }
        let mut precision = self.precision(&sizes)?;
        let mut best = match from.and_then(|(near, addition)| self.start_near(set, near, addition))
        {
            Some(start) => self.optimise(set, start, &precision)?,
            None => self.best_of_starts(set, &precision)?,
        };
        if !families.is_empty() {
            let members = self.members(set, &best.theta);
            sizes = self.sizes_from(&families, &members, &best.residual);
            precision = self.precision(&sizes)?;
            best = self.optimise(set, best.theta, &precision)?;
        }
        let n = best.hessian.len().isqrt();
        let tail = heavier_tail(self.frame, best.chi2, self.selection.len());
        let mut log_evidence = tail - best.value - 0.5 * precision.log_det();
        let mut joint = Vec::new();
        let mut sigma: Vec<Vec<f64>> = best.theta.iter().map(|t| vec![0.0; t.len()]).collect();
        if n > 0 {
            let posterior = Precision::of(&best.hessian, n)?;
            log_evidence -= 0.5 * posterior.log_det();
            let mut i = 0;
            for (m, ps) in self.parameters_of(set).iter().enumerate() {
                for (k, p) in ps.iter().enumerate() {
                    log_evidence -= p.prior_sd.ln();
                    sigma[m][k] = posterior.entry(i, i).max(0.0).sqrt();
                    i += 1;
                }
            }
            joint = (0..n * n).map(|k| posterior.entry(k / n, k % n)).collect();
        }
        let runs = self.runs.len();
        for (_, s) in &sizes {
            // Each size is a parameter, known to a factor from as many runs.
            let n_sizes = s.iter().filter(|s| **s > 0.0).count();
            log_evidence -= 0.5 * (runs.max(1) as f64).ln() * n_sizes as f64;
        }
        log_evidence += set
            .iter()
            .filter_map(|&c| self.candidates.get(c))
            .map(|c| c.log_prior)
            .sum::<f64>();
        let fit = Fit {
            parameters: best.theta,
            sigma,
            covariance: joint,
            sizes,
            residual: best.residual,
            chi2: best.chi2,
        };
        Some(Scored {
            set: set.to_vec(),
            log_evidence,
            fit,
        })
    }

    fn screen(&mut self, base: &Scored<Fit>) -> Vec<Addition> {
        let Some(precision) = self.precision(&base.fit.sizes) else {
            return Vec::new();
        };
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
            .precisions(&self.sized(&base.fit.sizes, &now.members));
        let without = run_by_run_log_likelihood(
            &self.blocks,
            &base.fit.residual,
            &self.sized(&base.fit.sizes, &now.members),
        );
        let mut out = Vec::new();
        for (c, candidate) in self.candidates.iter().enumerate() {
            let form = matches!(candidate.effect.discrepancy(), Some(Discrepancy::Form(_)));
            if base.set.contains(&c) || (form && self.names_only) {
                continue;
            }
            let (gain, parameters, sizes) = match candidate.effect.amplitudes(self.frame) {
                Some(_) if candidate.effect.parameters().is_empty() => {
                    let (after, sizes) = self.run_by_run(c, &now);
                    (after - without, Vec::new(), sizes)
                }
                Some(a) => self.screen_scattering(c, &a, &now, &alone),
                None => {
                    let (gain, theta) = self.screen_parameters(c, &now);
                    (gain, theta, Vec::new())
                }
            };
            out.push(Addition {
                candidate: c,
                gain: gain + candidate.log_prior,
                parameters,
                sizes,
            });
        }
        out.retain(|a| a.gain.is_finite());
        out.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        out
    }

    fn is_stopped(&self) -> bool {
        self.frame.stop.is_asked()
    }

    fn compatible(&self, a: usize, b: usize) -> bool {
        let (Some(a), Some(b)) = (self.candidates.get(a), self.candidates.get(b)) else {
            return false;
        };
        let (a, b) = (&a.effect, &b.effect);
        if full_id(a.as_ref()) == full_id(b.as_ref()) {
            return false;
        }
        let shared = a.gauges().iter().any(|g| b.gauges().contains(g));
        !shared || a.kind().besides(b.kind())
    }

    fn kin(&self, candidate: usize) -> usize {
        let Some(c) = self.candidates.get(candidate) else {
            return usize::MAX;
        };
        if let [one] = c.effect.gauges().as_slice() {
            return *one;
        }
        // One effect at many places that overlap: pairs of gauges, stretches of a card, runs.
        let same = |o: &Candidate| o.effect.id() == c.effect.id() && o.effect.gauges().len() != 1;
        let first = self.candidates.iter().position(same).unwrap_or(candidate);
        let places = !c.effect.gauges().is_empty() || !c.effect.runs().is_empty();
        self.frame.n_gauges() + if places { first } else { candidate }
    }

    fn variants(&self, candidate: usize) -> Vec<usize> {
        let Some(own) = self
            .candidates
            .get(candidate)
            .map(|c| full_id(c.effect.as_ref()))
        else {
            return Vec::new();
        };
        let same = |(c, o): (usize, &Candidate)| {
            (c != candidate && full_id(o.effect.as_ref()) == own).then_some(c)
        };
        self.candidates
            .iter()
            .enumerate()
            .filter_map(same)
            .collect()
    }
}

/// A fitted set that candidates are tried on top of.
struct Base<'b> {
    scored: &'b Scored<Fit>,
    members: Vec<Member<'b>>,
    /// Members with amplitudes.
    families: Vec<usize>,
    /// Its prediction of all readings.
    predicted: Vec<f64>,
    precision: &'b Precision,
    /// Precision times residual.
    weighted: Vec<f64>,
}

impl Likelihood<'_> {
    /// Amplitudes of candidates with their sizes, as `members` let the gauges read them.
    fn sized(&self, sizes: &[(usize, Vec<f64>)], members: &[Member<'_>]) -> Vec<SizedAmplitudes> {
        let one = |(c, s): &(usize, Vec<f64>)| {
            let mut amplitudes = self.candidates.get(*c)?.effect.amplitudes(self.frame)?;
            amplitudes.patterns = read_patterns(self.frame, members, &amplitudes.patterns);
            Some(SizedAmplitudes {
                amplitudes,
                sizes: s.clone(),
            })
        };
        sizes.iter().filter_map(one).collect()
    }

    /// Change of the prediction of the selection by candidate `c`, at the readings that it touches.
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
            // Reading effects come last: they act on what is predicted.
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
        // Members are read in the order of the set, as when it is fitted.
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

    /// Approximate gain of log evidence by adding candidate `c`: one Newton step per parameter from each start.
    fn screen_parameters(&self, c: usize, base: &Base<'_>) -> (f64, Vec<f64>) {
        let Some(candidate) = self.candidates.get(c) else {
            return (f64::NEG_INFINITY, Vec::new());
        };
        let described = candidate.effect.parameters();
        let gain = |change: &[(usize, f64)]| {
            let along: f64 = change.iter().map(|&(i, v)| v * base.weighted[i]).sum();
            along - 0.5 * quadratic(base.precision, change)
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

    /// Gain and parameter of a candidate that is as good as linear in its only parameter, and its slope:
    /// gain = (x' P r)^2 / (2 k) - ln(k s^2) / 2 with k = x' P x + 1 / s^2.
    fn linear_step(
        &self,
        c: usize,
        base: &Base<'_>,
        p: &Parameter,
    ) -> (f64, f64, Vec<(usize, f64)>) {
        let mut slope = self.change(c, base, &[p.neutral + p.step]);
        slope.iter_mut().for_each(|e| e.1 /= p.step);
        let variance = p.prior_sd * p.prior_sd;
        let curvature = quadratic(base.precision, &slope) + 1.0 / variance;
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
            // Two sweeps over the parameters, one at a time.
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

    /// A candidate with one parameter and, besides, one pattern whose amplitude scatters from run to run: the parameter by its linear step
    /// with the scatter in, then the scatter size of a few that gains most. With s = p' P r and h = p' P p of a run, scatter of variance v
    /// gains the sum over runs of s^2 v / (2 (1 + v h)) - ln(1 + v h) / 2.
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
        // By run, of the residual r and the parameter's slope x: p'Pr, p'Px, p'Pp, and x'Pr, x'Px.
        let sums: Vec<[f64; 5]> = alone
            .iter()
            .map(|run| {
                let of =
                    |f: &dyn Fn(usize) -> f64| run.at.iter().map(|i| f(*i)).collect::<Vec<f64>>();
                let r = of(&|i| base.scored.fit.residual[i]);
                let x = of(&|i| at.get(&i).copied().unwrap_or(0.0));
                let own: Vec<f64> = run.gauges.iter().map(|&g| pattern[g]).collect();
                let (wp, wx) = (run.precision.apply(&own), run.precision.apply(&x));
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
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

    /// Log likelihood with the amplitudes of `c` besides those of `base`, run by run, and their sizes.
    fn run_by_run(&self, c: usize, base: &Base<'_>) -> (f64, Vec<f64>) {
        let families = [base.families.as_slice(), &[c]].concat();
        let sizes = self.sizes_from(&families, &base.members, &base.scored.fit.residual);
        let unknown = self.sized(&sizes, &base.members);
        let value = run_by_run_log_likelihood(&self.blocks, &base.scored.fit.residual, &unknown);
        (value, sizes.last().map(|s| s.1.clone()).unwrap_or_default())
    }
}

/// x' P x and x' P y of few entries at the same places.
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

fn quadratic(precision: &Precision, x: &[(usize, f64)]) -> f64 {
    products(precision, x, x).0
}

/// `P x`, quicker where most of `x` is zero.
fn apply_few(precision: &Precision, x: &[f64]) -> Vec<f64> {
    let few: Vec<(usize, f64)> = x
        .iter()
        .copied()
        .enumerate()
        .filter(|e| e.1 != 0.0)
        .collect();
    if few.len() * 2 < x.len() {
        precision.apply_sparse(&few)
    } else {
        precision.apply(x)
    }
}
