//! Search for faults of measured channels. Each fault is undone in turn, and the fault that makes the other readings agree is reported.

use super::fault::{AlternativeRows, Channels, DetectedFault, InputFault, Inputs};
use crate::estimate::{chi_square_tail, median};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Misfit of readings, measured relative to their errors.
pub trait Misfit: Sync {
    /// Returns the inputs as they are.
    fn inputs(&self) -> Inputs;
    /// Returns the noise of a reading, strain, 1 sd.
    fn noise(&self) -> f64;
    /// Returns how well changed inputs fit.
    fn fit(&self, inputs: &Inputs) -> InputFit;
    /// Returns whether the loads are known, so that a fault of all readings shows.
    fn knows_loads(&self) -> bool {
        false
    }
}

/// A fit of inputs.
#[derive(Clone, Debug, Default)]
pub struct InputFit {
    /// Sum of squares of the residual, in units of the errors.
    pub chi2: f64,
    /// Degrees of freedom of the sum of squares.
    pub dof: usize,
    /// Predicted strain by run and gauge.
    pub predicted: Vec<Vec<f64>>,
    /// Value and half width of the interval of each requested load, by run. Empty if the loads are known.
    pub loads: Vec<Vec<[f64; 2]>>,
}

impl InputFit {
    /// Returns the sum of squares divided by its degrees of freedom. It is infinite without degrees of freedom.
    pub fn reduced_chi2(&self) -> f64 {
        match self.dof {
            0 => f64::INFINITY,
            n => self.chi2 / n as f64,
        }
    }

    /// Returns the largest shift of a load over the half width of its interval; `None` if the loads are known.
    fn moved_by(&self, other: &Self) -> Option<f64> {
        let runs = self.loads.iter().zip(&other.loads);
        let each = runs.flat_map(|(a, b)| a.iter().zip(b));
        let ratios = each.map(|([a, half], [b, _])| (a - b).abs() / half);
        ratios.filter(|r| r.is_finite()).reduce(f64::max)
    }
}

/// Limits of the search.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// Reduced sum of squares up to which errors explain the readings, and the probability of such a sum from which errors explain them.
    pub explained: [f64; 2],
    /// Largest share of the reduced sum of squares that remains after correction of a fault.
    pub remains: f64,
    /// Sigmas above which a gauge contradicts the others, root mean square over the runs, if errors come from scatter. The limit grows if the
    /// residuals of the other gauges exceed their errors. All runs may have the same error, so that they count as one. `None`: [`Self::remains`]
    /// decides.
    pub sigmas: Option<f64>,
    /// Sigmas above which a gauge is reported, regardless of its limit from the scatter. A few repeats determine their own scatter to a factor of two
    /// at best. Healthy gauges near a wheel reach five sigmas in calibrations with two runs for each lane, on two measured bridges.
    pub named: f64,
    /// Largest share of the reduction that a cause may fail to reach. The reduction is the fall of the residual sum of squares if the gauge is left
    /// out.
    pub cause_leaves: f64,
    /// Difference of the sums of squares of two explanations, divided by the reduced sum of squares, from which the readings distinguish the
    /// explanations: three sigmas.
    pub apart: f64,
    /// Share of the expected strain below which a gauge has no signal.
    pub nothing: f64,
    /// Largest reading of a dead gauge, and smallest prediction from the other gauges, in noise sd.
    pub dead: [f64; 2],
    /// Largest distance of a factor from a power of ten at which the factor indicates a unit.
    pub near: f64,
    /// Gauges that are tried for a cause, and for an exchange with every other gauge.
    pub tried: usize,
    /// Largest number of faults that are searched for in sequence.
    pub most: usize,
}

impl Rules {
    /// Limits if noise and model error are stated.
    pub const STATED: Self = Self {
        explained: [2.0, 1e-3],
        remains: 0.2,
        sigmas: None,
        named: 8.0,
        cause_leaves: 0.05,
        apart: 9.0,
        nothing: 0.1,
        dead: [3.0, 10.0],
        near: 0.15,
        tried: 6,
        most: 3,
    };

    /// Returns the limits if errors come from scatter. With a small probability, one of all sound gauges exceeds `sigmas`.
    pub fn of_scatter(sigmas: f64) -> Self {
        Self {
            sigmas: Some(sigmas),
            ..Self::STATED
        }
    }

    /// Returns the sigmas above which a gauge is reported if the squared residuals of the other gauges are `excess` times their expected value.
    fn limit(&self, sigmas: f64, excess: f64) -> f64 {
        self.named.min(sigmas * excess.max(1.0).sqrt())
    }

    fn explains(&self, fit: &InputFit, runs: usize) -> bool {
        match self.sigmas {
            None => {
                let by_chance = chi_square_tail(fit.chi2, fit.dof as f64) > self.explained[1];
                fit.dof == 0 || by_chance || fit.reduced_chi2() < self.explained[0]
            }
            // A single gauge does not exceed the sum of all.
            Some(sigmas) => fit.chi2 / runs.max(1) as f64 <= self.limit(sigmas, 1.0).powi(2),
        }
    }

    /// Returns whether undoing the fault of `step` reduces the residuals of `base` enough to accept the fault.
    fn accepts(&self, base: &InputFit, step: &Step) -> bool {
        match step.found.sigmas {
            Some(sigmas) => sigmas > step.found.limit,
            None => step.after.reduced_chi2() < self.remains * base.reduced_chi2(),
        }
    }
}

/// Returns the faults of the channels, with the fault that explains most first. The list is empty if errors explain the readings, or if no fault
/// does.
///
/// Gauges are left out one by one. The search then tries each cause and each exchange for the gauges whose removal improves the agreement most. It
/// also tries faults of all gauges. A fault counts if the readings agree after its correction ([`Rules`]), or after the correction of up to three
/// faults together. `alternatives` is called only if the readings are not explained.
pub fn search_faults(
    misfit: &dyn Misfit,
    alternatives: &mut dyn FnMut() -> Vec<AlternativeRows>,
    rules: &Rules,
) -> Vec<DetectedFault> {
    let mut inputs = misfit.inputs();
    let runs = inputs.strain.len();
    let mut now = misfit.fit(&inputs);
    if rules.explains(&now, runs) {
        return Vec::new();
    }
    let search = Search {
        misfit,
        rules,
        alternatives: alternatives(),
    };
    let (mut found, mut pending): (Vec<DetectedFault>, Vec<DetectedFault>) =
        (Vec::new(), Vec::new());
    let mut base = now.clone();
    while found.len() + pending.len() < rules.most && !rules.explains(&now, runs) {
        let Some(step) = search.step(&inputs, &now) else {
            break;
        };
        let accepted = rules.accepts(&base, &step);
        // Two faults can hide each other, so that neither alone makes the other readings agree.
        if !accepted && (rules.sigmas.is_some() || step.found.share > PROGRESS) {
            break;
        }
        inputs = step
            .found
            .fault
            .correct_inputs(&inputs, &search.alternatives);
        now = step.after;
        pending.push(step.found);
        if accepted {
            let group = pending.len() > 1;
            for f in &mut pending {
                if group {
                    (f.share, f.together) = (now.reduced_chi2() / base.reduced_chi2(), true);
                }
            }
            found.append(&mut pending);
            base.clone_from(&now);
        }
    }
    found
}

/// Largest share of the reduced sum of squares that may remain after each of several faults that hide each other.
const PROGRESS: f64 = 0.8;

struct Search<'a> {
    misfit: &'a dyn Misfit,
    rules: &'a Rules,
    alternatives: Vec<AlternativeRows>,
}

/// One fault undone.
struct Step {
    found: DetectedFault,
    after: InputFit,
}

/// A fault that may explain the readings.
struct CandidateFault {
    fault: InputFault,
    fit: InputFit,
    /// 0: a fault with a definite correction; 1: one with a fitted size; 2: no cause.
    rank: u8,
}

impl Search<'_> {
    fn try_fault(&self, inputs: &Inputs, fault: InputFault, rank: u8) -> CandidateFault {
        let fit = self
            .misfit
            .fit(&fault.correct_inputs(inputs, &self.alternatives));
        CandidateFault { fault, fit, rank }
    }

    /// Returns the fault that explains most of the residuals of `now`.
    fn step(&self, inputs: &Inputs, now: &InputFit) -> Option<Step> {
        let n = inputs.rows.nrows();
        let reads = |g: &usize| inputs.strain.iter().any(|r| r[*g].is_finite());
        let gauges: Vec<usize> = (0..n).filter(reads).collect();
        let mut order: Vec<(usize, InputFit)> = gauges
            .par_iter()
            .map(|&g| (g, self.try_fault(inputs, InputFault::Unlike(g), 2).fit))
            .filter(|(_, fit)| fit.dof > 0)
            .collect();
        order.sort_by(|a, b| a.1.reduced_chi2().total_cmp(&b.1.reduced_chi2()));
        order.truncate(self.rules.tried);
        let (worst, least) = order.first().map(|(g, fit)| (*g, fit.clone()))?;
        let scale = least.reduced_chi2().max(1.0);
        let mut tried: Vec<CandidateFault> = Vec::new();
        for (i, (g, without)) in order.iter().enumerate() {
            let best = tried.iter().filter(|t| t.rank < 2).map(|t| t.fit.chi2);
            let best = best.fold(f64::INFINITY, f64::min).min(now.chi2);
            if i > 0 && without.chi2 > best + self.rules.apart * scale {
                break;
            }
            tried.extend(self.causes(inputs, now, *g, without));
        }
        tried.extend(self.of_all(inputs, now, scale, &least));
        tried.extend(self.exchanges(inputs, now, (&gauges, &order), &tried));
        let best = (tried.iter()).min_by(|a, b| {
            let by_rank = a.rank.cmp(&b.rank);
            by_rank.then(a.fit.chi2.total_cmp(&b.fit.chi2))
        })?;
        let rivals = tried.iter().filter(|t| {
            let same =
                t.fault == best.fault || (t.rank > 0 && t.fault.gauges() == best.fault.gauges());
            let close = t.fit.chi2 < best.fit.chi2 + self.rules.apart * scale;
            !same && close && t.rank <= best.rank.max(1)
        });
        let of = best.fault.gauges();
        let at = of.first().copied().unwrap_or(worst);
        let without = order
            .iter()
            .find(|(g, _)| *g == at)
            .map_or(&least, |o| &o.1);
        let runs = inputs
            .strain
            .iter()
            .filter(|r| r[at].is_finite())
            .count()
            .max(1);
        let sigmas = ((now.chi2 - without.chi2.min(best.fit.chi2)) / runs as f64)
            .max(0.0)
            .sqrt();
        let sizes = sizes_of(inputs, without, at);
        let by_scatter = self.rules.sigmas.filter(|_| !of.is_empty());
        Some(Step {
            found: DetectedFault {
                fault: best.fault,
                share: best.fit.reduced_chi2() / now.reduced_chi2(),
                limit: by_scatter.map_or(self.rules.remains, |s| {
                    self.rules.limit(s, without.reduced_chi2())
                }),
                sigmas: by_scatter.map(|_| sigmas),
                sizes,
                moves: now.moved_by(&best.fit),
                together: false,
                alternatives: rivals.map(|t| t.fault).collect(),
            },
            after: best.fit.clone(),
        })
    }

    /// Returns the causes that explain as much as leaving the gauge out, followed by [`InputFault::Unlike`].
    fn causes(
        &self,
        inputs: &Inputs,
        now: &InputFit,
        g: usize,
        without: &InputFit,
    ) -> Vec<CandidateFault> {
        let (rules, noise) = (self.rules, self.misfit.noise());
        let pairs: Vec<[f64; 2]> = pairs_of(inputs, without, g);
        let sum = |f: &dyn Fn(&[f64; 2]) -> f64| pairs.iter().map(f).sum::<f64>();
        let gain = sum(&|[y, p]| y * p) / sum(&|[_, p]| p * p);
        let offset = sum(&|[y, p]| y - p) / pairs.len() as f64;
        let [reads, expected] = sizes_of(inputs, without, g);
        let nothing = rules.dead[0] * noise;
        let live = expected > rules.dead[1] * noise;
        let without = |fault: InputFault, rank| CandidateFault {
            fault,
            fit: without.clone(),
            rank,
        };
        if live && reads < nothing.max(rules.nothing * expected) {
            return vec![without(InputFault::Dead(g), 0)];
        }
        if pairs.len() > 2 && sd(&pairs, 0) < nothing && sd(&pairs, 1) > rules.dead[1] * noise {
            return vec![without(InputFault::Stuck(g), 0)];
        }
        let one = Channels::One(g);
        let mut faults = vec![(InputFault::Sign(one), 0)];
        let installed = self.alternatives.iter().filter(|a| a.applies[g]);
        faults.extend(installed.map(|a| ((a.fault)(one), 0)));
        let power = |f: &&f64| (gain.abs() / **f - 1.0).abs() < rules.near;
        if let Some(unit) = [1e3, 1e-3, 1e6, 1e-6].iter().find(power) {
            faults.push((InputFault::Unit(g, unit.copysign(gain)), 0));
        } else if gain.is_finite() && gain.abs() > rules.nothing {
            faults.push((InputFault::Gain(g, gain), 1));
        }
        if pairs.len() > 2 {
            faults.push((InputFault::Offset(g, offset), 1));
        }
        let left = without(InputFault::Unlike(g), 2);
        let fall = now.chi2 - left.fit.chi2;
        let own = 4.0 * pairs.len() as f64 * left.fit.reduced_chi2().max(1.0);
        let limit = left.fit.chi2 + own.max(rules.cause_leaves * fall).min(0.5 * fall);
        let tried = faults
            .into_iter()
            .map(|(f, rank)| self.try_fault(inputs, f, rank));
        let mut out: Vec<CandidateFault> = tried.filter(|t| t.fit.chi2 < limit).collect();
        out.push(left);
        out
    }

    /// Returns the faults common to all gauges that explain the readings as well as a fault of a single gauge does.
    fn of_all(
        &self,
        inputs: &Inputs,
        now: &InputFit,
        scale: f64,
        least: &InputFit,
    ) -> Vec<CandidateFault> {
        let installed = self
            .alternatives
            .iter()
            .filter(|a| a.applies.iter().all(|v| *v));
        let mut faults: Vec<InputFault> = installed.map(|a| (a.fault)(Channels::All)).collect();
        if self.misfit.knows_loads() {
            faults.push(InputFault::Sign(Channels::All));
        }
        let tried = faults.into_iter().map(|f| self.try_fault(inputs, f, 0));
        let limit = least.chi2 + self.rules.apart * scale;
        let remains = self.rules.remains * now.reduced_chi2();
        tried
            .filter(|t| t.fit.chi2 < limit && t.fit.reduced_chi2() < remains)
            .collect()
    }

    /// Returns the exchanges of two gauges that explain more than any fault of one, and as much as the best of them, the best first. One gauge
    /// of each pair is in `order`: the other may agree with the loads that the exchanged readings give.
    fn exchanges(
        &self,
        inputs: &Inputs,
        now: &InputFit,
        (gauges, order): (&[usize], &[(usize, InputFit)]),
        singles: &[CandidateFault],
    ) -> Vec<CandidateFault> {
        let pairs: BTreeSet<(usize, usize)> = order
            .iter()
            .flat_map(|(a, _)| gauges.iter().map(move |b| (*a.min(b), *a.max(b))))
            .filter(|(a, b)| a != b)
            .collect();
        let exchanged = |(a, b)| self.try_fault(inputs, InputFault::Exchanged(a, b), 0);
        // Fits hold a prediction of every reading, so that only their sums are kept.
        let mut tried: Vec<(f64, (usize, usize))> = pairs
            .into_par_iter()
            .map(|pair| (exchanged(pair).fit.chi2, pair))
            .collect();
        tried.sort_by(|x, y| x.0.total_cmp(&y.0));
        let Some(&(best, (a, b))) = tried.first() else {
            return Vec::new();
        };
        let silent = InputFault::Unlike(a).correct_inputs(inputs, &[]);
        let both = self
            .misfit
            .fit(&InputFault::Unlike(b).correct_inputs(&silent, &[]));
        if both.dof == 0 {
            return Vec::new();
        }
        let own = 8.0 * inputs.strain.len() as f64 * both.reduced_chi2().max(1.0);
        let limit = both.chi2 + own.max(self.rules.cause_leaves * (now.chi2 - both.chi2));
        let of_one = singles
            .iter()
            .map(|t| t.fit.chi2)
            .fold(f64::INFINITY, f64::min);
        let scale = both.reduced_chi2().max(1.0);
        let close = limit
            .min(of_one.max(own))
            .min(best + self.rules.apart * scale);
        let found = tried.into_iter().filter(|t| t.0 < close || t.0 == best);
        let found = found.filter(|t| t.0 < limit && t.0 < of_one.max(own));
        found.map(|t| exchanged(t.1)).collect()
    }
}

/// Returns reading and prediction of a gauge by run, if both are known.
fn pairs_of(inputs: &Inputs, fit: &InputFit, g: usize) -> Vec<[f64; 2]> {
    let runs = inputs.strain.iter().zip(&fit.predicted);
    let pairs = runs.map(|(y, p)| [y[g], p[g]]);
    pairs.filter(|p| p.iter().all(|v| v.is_finite())).collect()
}

/// Returns the median size of a gauge's readings and of the predictions over the last half of the runs. This half shows gauges that failed during the
/// test.
fn sizes_of(inputs: &Inputs, fit: &InputFit, g: usize) -> [f64; 2] {
    let pairs = pairs_of(inputs, fit, g);
    let last = &pairs[pairs.len() / 2..];
    [0, 1].map(|i| median(last.iter().map(|p| p[i].abs()).collect()).unwrap_or(f64::NAN))
}

/// Returns the standard deviation of readings (0) or predictions (1).
fn sd(pairs: &[[f64; 2]], i: usize) -> f64 {
    let n = pairs.len() as f64;
    let mean = pairs.iter().map(|p| p[i]).sum::<f64>() / n;
    (pairs.iter().map(|p| (p[i] - mean).powi(2)).sum::<f64>() / n).sqrt()
}
