//! Evidence of a set of effects: exact prediction, parameters optimised, amplitudes integrated out.

use super::covariance::{Selection, SizedAmplitudes, covariance, read_patterns};
use super::frame::StrainFrame;
use super::size::{RunBlocks, run_by_run_log_likelihood, usual_sizes};
use super::state::{Part, predict};
use crate::linalg::precision::Precision;
use crate::reconcile::effect::{Candidate, Member, Parameter, Stage, full_id};
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
    /// Members with amplitudes: candidate number and size of each kind.
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
            let usual = self.candidates.get(c)?.effect.amplitudes(self.frame)?.usual;
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
        let mut log_evidence = -best.value - 0.5 * precision.log_det();
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
        }
        let runs = self.runs.len();
        for (_, s) in &sizes {
            // Each size is a parameter, known to a factor from as many runs.
            log_evidence -= 0.5 * (runs.max(1) as f64).ln() * s.len() as f64;
        }
        log_evidence += set
            .iter()
            .filter_map(|&c| self.candidates.get(c))
            .map(|c| c.log_prior)
            .sum::<f64>();
        let fit = Fit {
            parameters: best.theta,
            sigma,
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
        let pr = precision.apply(&base.fit.residual);
        let members = self.members(&base.set, &base.fit.parameters);
        let predicted = predict(self.frame, &members);
        let families: Vec<usize> = base.fit.sizes.iter().map(|s| s.0).collect();
        let mut without = None;
        let mut out = Vec::new();
        for (c, candidate) in self.candidates.iter().enumerate() {
            if base.set.contains(&c) {
                continue;
            }
            let (gain, parameters, sizes) = if candidate.effect.amplitudes(self.frame).is_some() {
                let before =
                    *without.get_or_insert_with(|| self.run_by_run(&families, &members, base).0);
                let (after, sizes) =
                    self.run_by_run(&[families.as_slice(), &[c]].concat(), &members, base);
                (after - before, Vec::new(), sizes)
            } else {
                let (gain, theta) = self.screen_parameters(c, base, &predicted, &precision, &pr);
                (gain, theta, Vec::new())
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

    fn compatible(&self, a: usize, b: usize) -> bool {
        let (Some(a), Some(b)) = (self.candidates.get(a), self.candidates.get(b)) else {
            return false;
        };
        let (a, b) = (&a.effect, &b.effect);
        if full_id(a.as_ref()) == full_id(b.as_ref()) {
            return false;
        }
        // On one gauge a zero may drift besides another fault; two other faults are told as one.
        let drift = a.id() == "zero_drift" || b.id() == "zero_drift";
        let shared = a.gauges().iter().any(|g| b.gauges().contains(g));
        let dead = a.id() == "dead_channel" || b.id() == "dead_channel";
        !shared || (drift && !dead)
    }

    fn kin(&self, candidate: usize) -> usize {
        let Some(c) = self.candidates.get(candidate) else {
            return usize::MAX;
        };
        match c.effect.gauges().as_slice() {
            [one] => *one,
            _ => self.frame.n_gauges() + candidate,
        }
    }
}

impl Likelihood<'_> {
    /// Change of the prediction of the selection from `predicted` (that of `base`), as few entries where the effect touches few gauges.
    fn change(
        &self,
        c: usize,
        base: &Scored<Fit>,
        predicted: &[f64],
        theta: &[f64],
    ) -> Vec<(usize, f64)> {
        let Some(candidate) = self.candidates.get(c) else {
            return Vec::new();
        };
        let n_g = self.frame.n_gauges();
        let gauges = candidate.effect.gauges();
        let mut out = Vec::new();
        if candidate.effect.stage() == Stage::Reading {
            // Reading effects come last: they act on what is predicted.
            let gauges = if gauges.is_empty() {
                (0..n_g).collect()
            } else {
                gauges
            };
            for &run in &self.runs {
                let Some(before) = predicted.get(run * n_g..(run + 1) * n_g) else {
                    continue;
                };
                let mut row = before.to_vec();
                candidate
                    .effect
                    .read(self.frame, theta, run, &mut row, Part::Whole);
                out.extend(gauges.iter().filter_map(|&g| {
                    Some((
                        *self.index.get(run * n_g + g)?.as_ref()?,
                        row[g] - before[g],
                    ))
                }));
            }
            return out;
        }
        let mut set = base.set.clone();
        let mut parameters = base.fit.parameters.clone();
        set.push(c);
        parameters.push(theta.to_vec());
        let now = predict(self.frame, &self.members(&set, &parameters));
        if gauges.is_empty() {
            return self
                .selection
                .0
                .iter()
                .enumerate()
                .map(|(i, &(r, g))| (i, now[r * n_g + g] - predicted[r * n_g + g]))
                .collect();
        }
        for &run in &self.runs {
            let at = |&g: &usize| {
                Some((
                    *self.index.get(run * n_g + g)?.as_ref()?,
                    now[run * n_g + g] - predicted[run * n_g + g],
                ))
            };
            out.extend(gauges.iter().filter_map(at));
        }
        out
    }

    /// Approximate gain of log evidence by adding candidate `c`: one Newton step per parameter from each start, then exact.
    fn screen_parameters(
        &self,
        c: usize,
        base: &Scored<Fit>,
        predicted: &[f64],
        precision: &Precision,
        pr: &[f64],
    ) -> (f64, Vec<f64>) {
        let Some(candidate) = self.candidates.get(c) else {
            return (f64::NEG_INFINITY, Vec::new());
        };
        let described = candidate.effect.parameters();
        let gain = |change: &[(usize, f64)]| {
            let along: f64 = change.iter().map(|&(i, v)| v * pr[i]).sum();
            along - 0.5 * quadratic(precision, change)
        };
        if described.is_empty() {
            return (gain(&self.change(c, base, predicted, &[])), Vec::new());
        }
        let mut best = (f64::NEG_INFINITY, Vec::new());
        let starts: Vec<Vec<f64>> = match described.as_slice() {
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
                    let here = self.change(c, base, predicted, &theta);
                    let mut moved = theta.clone();
                    moved[k] += p.step;
                    let there = self.change(c, base, predicted, &moved);
                    let slope: Vec<(usize, f64)> = here
                        .iter()
                        .zip(&there)
                        .map(|(a, b)| (a.0, (b.1 - a.1) / p.step))
                        .collect();
                    let (own, cross) = products(precision, &slope, &here);
                    let curvature = own + 1.0 / (p.prior_sd * p.prior_sd);
                    let pull: f64 = slope.iter().map(|&(i, v)| v * pr[i]).sum::<f64>()
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
            let value = gain(&self.change(c, base, predicted, &theta)) - prior - log_width;
            if value > best.0 {
                best = (value, theta);
            }
        }
        best
    }

    /// Log likelihood with the amplitudes of `families`, run by run, and the sizes of the last of them.
    fn run_by_run(
        &self,
        families: &[usize],
        members: &[Member<'_>],
        base: &Scored<Fit>,
    ) -> (f64, Vec<f64>) {
        let list: Vec<_> = families
            .iter()
            .filter_map(|&c| self.candidates.get(c)?.effect.amplitudes(self.frame))
            .collect();
        let sized = self.sizes_from(families, members, &base.fit.residual);
        let unknown: Vec<SizedAmplitudes> = list
            .into_iter()
            .zip(&sized)
            .map(|(amplitudes, s)| SizedAmplitudes {
                amplitudes,
                sizes: s.1.clone(),
            })
            .collect();
        let last = sized.last().map(|s| s.1.clone()).unwrap_or_default();
        let value = run_by_run_log_likelihood(&self.blocks, &base.fit.residual, &unknown);
        (value, last)
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
