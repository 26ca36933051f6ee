//! Weight of a payload from single gauges, all gauges together and wheel forces, with checks of sign and equilibrium.

use super::by_calibration;
use super::evidence::{PayloadModel, PayloadRun, Place, Refusal, Support, WeighSpec, WeighedRun};
use super::locate::{Location, determines_payload, locate};
use super::one_run::{Balance, PayloadFit};
use super::robust::{
    GaugeEstimates, GaugeVerdict, RobustSpec, SIGN_SIGMAS, cut_at_zero, joint_uncertainty,
    robust_payload, verdict_words,
};
use crate::estimate::NORMAL_95;
use crate::estimate::weighted_median;
use crate::finding::Finding;
use crate::sensitivity::GaugeNoise;

/// The answer for all runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Weighing {
    /// Result for each run.
    pub runs: Vec<WeighedRun>,
    /// Result for each gauge. Empty without strain.
    pub gauges: Vec<GaugeVerdict>,
    /// Findings on runs whose strain no payload explains with a calibrated S.
    pub unlike: Vec<Finding>,
}

/// Gauge factors are good to this: the least scatter between good gauges that is proportional to the load.
const GAUGE_FACTOR_REL: f64 = 0.01;
/// Strain and wheel forces disagree from this many standard deviations and this share of the weight on.
const OUT_OF_BALANCE: (f64, f64) = (4.0, 0.05);
/// A payload outside the region by more standard deviations is refused.
const OUTSIDE: f64 = 3.0;
/// Number of standard deviations below zero from which a weight is significantly negative. Noise alone exceeds it for one empty structure in 700.
const SURELY: f64 = 3.0;
/// Standard deviation over the largest estimate under which a gauge counts as exact.
const EXACT: f64 = 1e-9;
/// A gauge alone that leaves the weight this uncertain (share, 1 sd) is too weak for the job.
const WEAK_SHARE: f64 = 1.0 / 3.0;

/// Weighs the payload of every run.
///
/// With a known position and strain alone, the result is the posterior of [`robust_payload`], otherwise the result of `locate`. The 95 % interval is
/// the interval of a payload that can't be negative (value `max(0, v)`, ends `max(0, low)` and `max(0, v) + high - v`, see `cut_at_zero`). An answer
/// that violates sign, region or equilibrium keeps its numbers and states why it is refused. Runs are tested separately: a run without an answer does
/// not affect the answers of other runs.
pub fn weigh(model: &PayloadModel, runs: &[PayloadRun], spec: &WeighSpec) -> Weighing {
    let n = model.gauges.len();
    let has_strain = runs.iter().any(|r| r.strain.iter().any(|v| v.is_finite()));
    let has_wheels = runs.iter().any(|r| !r.reactions.is_empty());
    // Gauges with correlated noise are not independent, so their single estimates are not combined here.
    let is_correlated = model.noise.as_ref().is_some_and(GaugeNoise::is_correlated);
    if has_strain && !has_wheels && spec.place == Place::Known && !is_correlated {
        return apply_calibration(model, runs, spec, by_strain(model, runs, spec));
    }
    let is_determined: Vec<bool> = runs
        .iter()
        .map(|r| determines_payload(model, r, spec))
        .collect();
    if is_determined.contains(&false) && is_determined.contains(&true) {
        let some = runs.iter().zip(&is_determined).filter(|(_, t)| **t);
        let some: Vec<PayloadRun> = some.map(|(r, _)| r.clone()).collect();
        let found = weigh(model, &some, spec);
        let mut weighed = found.runs.into_iter();
        let of = |(r, t): (&PayloadRun, &bool)| {
            let found = if *t { weighed.next() } else { None };
            found.unwrap_or_else(|| undetermined_run(r, n))
        };
        return Weighing {
            runs: runs.iter().zip(&is_determined).map(of).collect(),
            gauges: found.gauges,
            unlike: found.unlike,
        };
    }
    let Some(location) = locate(model, runs, spec, Balance::Kept) else {
        return Weighing {
            runs: runs.iter().map(|r| undetermined_run(r, n)).collect(),
            gauges: Vec::new(),
            unlike: Vec::new(),
        };
    };
    let apart = (has_strain && has_wheels)
        .then(|| locate(model, runs, spec, Balance::Open))
        .flatten();
    let out: Vec<WeighedRun> = runs
        .iter()
        .zip(&location.runs)
        .enumerate()
        .map(|(i, (run, found))| {
            let mut w = weigh_run(model, run, found, spec);
            let strain_alone = apart.as_ref().and_then(|a| a.runs.get(i));
            if let (None, Some(alone)) = (w.refused, strain_alone) {
                w.refused = out_of_balance(run, alone, spec);
            }
            w
        })
        .collect();
    let gauges = if has_strain {
        verdicts(model, &out, &location)
    } else {
        Vec::new()
    };
    let found = Weighing {
        runs: out,
        gauges,
        unlike: Vec::new(),
    };
    match has_wheels {
        true => found,
        false => apply_calibration(model, runs, spec, found),
    }
}

/// Replaces weight and place by estimates with the whole covariance of a calibrated S, if the payload's columns are its own. It uses the gauges that
/// count, like `recover`. A place without a column in the calibration is unchanged.
fn apply_calibration(
    model: &PayloadModel,
    runs: &[PayloadRun],
    spec: &WeighSpec,
    mut weighing: Weighing,
) -> Weighing {
    let Some(known) = &model.calibrated else {
        return weighing;
    };
    let used: Vec<bool> = match weighing.gauges.is_empty() {
        true => vec![true; model.gauges.len()],
        false => weighing.gauges.iter().map(|v| v.used).collect(),
    };
    for (w, run) in weighing.runs.iter_mut().zip(runs) {
        let answered = matches!(w.refused, None | Some(Refusal::OutsideRegion { .. }));
        let found = by_calibration::estimate_payload(model, known, run, spec.place, |g| used[g]);
        let Some(found) = found.filter(|_| answered) else {
            continue;
        };
        weighing.unlike.extend(found.unlike);
        let mut located = PayloadFit::zeros();
        // Components without a column in the calibration keep their previous values.
        let force = w.force;
        for k in 1..3 {
            located.p[k] = force * w.shift[k - 1];
            located.covariance[4 * k] = force * force * w.shift_covariance[3 * (k - 1)];
        }
        let m = found.p.len();
        for (i, (k, value)) in found.p.iter().enumerate() {
            located.p[*k] = *value;
            for (j, (l, _)) in found.p.iter().enumerate() {
                located.covariance[3 * k + l] = found.covariance[i * m + j];
            }
        }
        let old = (w.estimates.clone(), w.estimate_sigma.clone());
        *w = weigh_run(model, run, &located, spec);
        (w.estimates, w.estimate_sigma) = old;
        w.dof = found.dof;
        let free = located.p[0];
        let half = found.coverage_factor * w.sigma;
        (w.force, w.interval) = match w.refused {
            None => cut_at_zero(free, [free - half, free + half]),
            Some(_) => (free, [free - half, free + half]),
        };
    }
    weighing
}

fn undetermined_run(run: &PayloadRun, n: usize) -> WeighedRun {
    WeighedRun {
        run: run.run.clone(),
        force: f64::NAN,
        sigma: f64::NAN,
        dof: f64::INFINITY,
        interval: [f64::NAN; 2],
        shift: run.shift,
        shift_covariance: [0.0; 4],
        refused: Some(Refusal::Undetermined),
        estimates: vec![f64::NAN; n],
        estimate_sigma: vec![f64::NAN; n],
    }
}

/// Estimates the payload of a run from each gauge alone: reading, less strain by measured wheel forces, over the response to a unit weight.
fn estimate_by_gauge(
    model: &PayloadModel,
    run: &PayloadRun,
    shift: [f64; 2],
    reactions: &[f64],
    force: f64,
    spec: &WeighSpec,
) -> (Vec<f64>, Vec<f64>) {
    let measured = !run.reactions.is_empty();
    let support = if measured {
        Support::Free
    } else {
        Support::Floor
    };
    let unit = model.unit_strain(shift, support);
    let p = [1.0, shift[0], shift[1]];
    (0..model.gauges.len())
        .map(|g| {
            let y = run.strain.get(g).copied().unwrap_or(f64::NAN);
            let own = run.sigma.get(g).copied().unwrap_or(f64::NAN);
            let wheel = |w: usize| model.wheels[(g, w)] * reactions.get(w).copied().unwrap_or(0.0);
            let by_wheels: f64 = (0..model.wheels.ncols()).map(wheel).sum();
            let parts: f64 = (0..model.wheels.ncols())
                .map(|w| wheel(w).powi(2))
                .sum::<f64>()
                + (0..3)
                    .map(|k| (model.payload[(g, k)] * p[k] * force).powi(2))
                    .sum::<f64>();
            let less = if measured { by_wheels } else { 0.0 };
            let sd = own.hypot(spec.model_rel * parts.sqrt());
            if unit[g] == 0.0 {
                (f64::NAN, f64::NAN)
            } else {
                ((y - less) / unit[g], sd / unit[g].abs())
            }
        })
        .unzip()
}

/// Estimates the payload of a run on the floor from each gauge alone, with the model's error for a payload of about this size.
fn alone_on_floor(
    model: &PayloadModel,
    run: &PayloadRun,
    size: f64,
    spec: &WeighSpec,
) -> (Vec<f64>, Vec<f64>) {
    let p = [size, size * run.shift[0], size * run.shift[1]];
    let reactions: Vec<f64> = model.floor.as_ref().map_or_else(Vec::new, |floor| {
        (0..floor.nrows())
            .map(|w| (0..3).map(|k| floor[(w, k)] * p[k]).sum())
            .collect()
    });
    estimate_by_gauge(model, run, run.shift, &reactions, size, spec)
}

/// Known place, strain alone.
fn by_strain(model: &PayloadModel, runs: &[PayloadRun], spec: &WeighSpec) -> Weighing {
    let n = model.gauges.len();
    // First each run is tested separately. A run with a significantly negative payload, or without a payload, must not reduce the weight of its
    // gauges in other runs. The noise level of a gauge is common to all runs.
    let mut out: Vec<WeighedRun> = Vec::new();
    let mut accepted: Vec<usize> = Vec::new();
    // The model error is proportional to the payload. The first round uses the median of the gauges as payload, later rounds use the answer.
    let mut sizes: Vec<f64> = Vec::new();
    for (i, run) in runs.iter().enumerate() {
        let (estimates, estimate_sigma) = estimate_by_gauge(model, run, run.shift, &[], 0.0, spec);
        let possible = |e: &f64| *e > 0.0 && *e <= spec.largest;
        let size = median_of(&estimates, &estimate_sigma, possible).unwrap_or(0.0);
        let (estimates, estimate_sigma) = match size > 0.0 {
            true => alone_on_floor(model, run, size, spec),
            false => (estimates, estimate_sigma),
        };
        let refused = refused_by_itself(&estimates, &estimate_sigma, spec.largest);
        if refused.is_none() {
            accepted.push(i);
            sizes.push(size);
        }
        let force = match refused {
            Some(Refusal::Negative { force }) => force,
            _ => f64::NAN,
        };
        out.push(WeighedRun {
            force,
            refused,
            estimates,
            estimate_sigma,
            ..undetermined_run(run, n)
        });
    }
    let mut answer = None;
    for _ in 0..2 {
        for (i, size) in accepted.iter().zip(&sizes) {
            let found = alone_on_floor(model, &runs[*i], size.max(0.0), spec);
            (out[*i].estimates, out[*i].estimate_sigma) = found;
        }
        let of_gauge = |g: usize| GaugeEstimates {
            name: model.gauges[g].clone(),
            estimates: accepted.iter().map(|i| out[*i].estimates[g]).collect(),
            sigma: Some(accepted.iter().map(|i| out[*i].estimate_sigma[g]).collect()),
        };
        let gauges: Vec<GaugeEstimates> = (0..n).map(of_gauge).collect();
        let robust = RobustSpec {
            relative_scatter: spec.model_rel.max(GAUGE_FACTOR_REL),
            largest: spec.largest,
        };
        answer = match accepted.is_empty() {
            true => None,
            false => robust_payload(&gauges, &robust),
        };
        if let Some(a) = &answer {
            sizes = a.runs.iter().map(|r| r.value).collect();
        }
    }
    let Some(answer) = answer else {
        for i in &accepted {
            out[*i].refused = Some(Refusal::Undetermined);
        }
        return Weighing {
            runs: out,
            gauges: Vec::new(),
            unlike: Vec::new(),
        };
    };
    for (i, a) in accepted.iter().zip(&answer.runs) {
        // The common model error widens the joint interval of the gauges.
        let whole = spec.model_rel * a.value;
        let widen = |edge: f64| {
            let half = edge - a.value;
            a.value + half.signum() * half.hypot(NORMAL_95 * whole)
        };
        let run = &mut out[*i];
        run.sigma = a.sigma.hypot(whole);
        // With the final size of the model error, a run may have to be refused that passed the first test, or the reverse.
        run.refused = refused_by_itself(&run.estimates, &run.estimate_sigma, spec.largest);
        let free = (a.value, a.interval.map(widen));
        (run.force, run.interval) = match run.refused {
            None => cut_at_zero(free.0, free.1),
            Some(_) => free,
        };
    }
    let mut gauges = answer.gauges;
    for (g, v) in gauges.iter_mut().enumerate() {
        report_weak_gauge(v, g, &out);
    }
    Weighing {
        runs: out,
        gauges,
        unlike: Vec::new(),
    }
}

/// Returns the median of the estimates that `take` accepts, weighted by the inverse of their standard deviations. Without stated noise all
/// gauges have the same weight.
fn median_of(estimates: &[f64], sigma: &[f64], take: impl Fn(&f64) -> bool) -> Option<f64> {
    let known = |(e, s): &(&f64, &f64)| e.is_finite() && s.is_finite();
    let pairs = || estimates.iter().zip(sigma).filter(known);
    let least = EXACT * pairs().fold(f64::MIN_POSITIVE, |a, p| a.max(p.0.abs()));
    let taken = pairs().filter(|p| take(p.0));
    let mut weighted: Vec<(f64, f64)> = taken.map(|(e, s)| (*e, 1.0 / s.max(least))).collect();
    weighted_median(&mut weighted)
}

/// Returns the reason if a run can't have an answer, independent of the other runs. Either the weighted median of its gauges is significantly below
/// zero, or no gauge gives a possible weight. Weights are the inverse standard deviations.
fn refused_by_itself(estimates: &[f64], sigma: &[f64], largest: f64) -> Option<Refusal> {
    let known = |(e, s): &(&f64, &f64)| e.is_finite() && s.is_finite();
    let pairs = || estimates.iter().zip(sigma).filter(known);
    let possible = |(e, s): (&f64, &f64)| *e > -SIGN_SIGMAS * s && *e <= largest;
    let Some(force) = median_of(estimates, sigma, |_| true) else {
        return Some(Refusal::Undetermined);
    };
    if force < -joint_uncertainty(pairs().map(|p| *p.1)) {
        return Some(Refusal::Negative { force });
    }
    (!pairs().any(possible)).then_some(Refusal::Undetermined)
}

fn weigh_run(
    model: &PayloadModel,
    run: &PayloadRun,
    found: &PayloadFit,
    spec: &WeighSpec,
) -> WeighedRun {
    let force = found.p[0];
    let c = &found.covariance;
    let sigma = c[0].max(0.0).sqrt();
    let free = spec.place == Place::Free;
    let shift = if free {
        [found.p[1] / force, found.p[2] / force]
    } else {
        run.shift
    };
    // Delta method: d = M / F.
    let mut shift_covariance = [0.0; 4];
    if free {
        for i in 0..2 {
            for j in 0..2 {
                shift_covariance[2 * i + j] =
                    (c[3 * (i + 1) + j + 1] - shift[i] * c[j + 1] - shift[j] * c[i + 1]
                        + shift[i] * shift[j] * c[0])
                        / (force * force);
            }
        }
    }
    // With strain alone, a common error of the payload column appears as a shift of the line of action. Its size is `model_rel` times the spread of
    // the wheels. Measured wheel forces determine this line by statics.
    if let (true, true, Some(arms)) = (free, run.reactions.is_empty(), &model.arms) {
        for k in 0..2 {
            let n = arms.len().max(1) as f64;
            let mean = arms.iter().map(|a| a[k]).sum::<f64>() / n;
            let square = arms.iter().map(|a| (a[k] - mean).powi(2)).sum::<f64>() / n;
            shift_covariance[3 * k] += spec.model_rel.powi(2) * square;
        }
    }
    let (estimates, estimate_sigma) = if run.strain.is_empty() {
        (Vec::new(), Vec::new())
    } else {
        estimate_by_gauge(model, run, shift, &found.reactions, force, spec)
    };
    let outside = spec.region.filter(|_| free).map(|region| {
        (0..2)
            .map(|k| {
                let by = (region[k][0] - shift[k]).max(shift[k] - region[k][1]);
                by / shift_covariance[3 * k].max(f64::MIN_POSITIVE).sqrt()
            })
            .fold(f64::NEG_INFINITY, f64::max)
    });
    let refused = if !force.is_finite() || !sigma.is_finite() {
        Some(Refusal::Undetermined)
    } else if force < -SURELY * sigma {
        Some(Refusal::Negative { force })
    } else {
        outside
            .filter(|s| *s > OUTSIDE)
            .map(|sigmas| Refusal::OutsideRegion { sigmas })
    };
    let free_interval = [force - NORMAL_95 * sigma, force + NORMAL_95 * sigma];
    let (force, interval) = match refused {
        None => cut_at_zero(force, free_interval),
        Some(_) => (force, free_interval),
    };
    WeighedRun {
        run: run.run.clone(),
        force,
        sigma,
        dof: f64::INFINITY,
        interval,
        shift,
        shift_covariance,
        refused,
        estimates,
        estimate_sigma,
    }
}

fn out_of_balance(run: &PayloadRun, alone: &PayloadFit, spec: &WeighSpec) -> Option<Refusal> {
    if run.reactions.iter().any(|r| !r.is_finite()) {
        return None;
    }
    let wheels: f64 = run.reactions.iter().sum();
    let sd = spec.reaction_sigma * (run.reactions.len() as f64).sqrt();
    let strain = alone.p[0];
    let sigma = sd.hypot(alone.covariance[0].max(0.0).sqrt());
    let off = (strain - wheels).abs();
    (off > OUT_OF_BALANCE.0 * sigma && off > OUT_OF_BALANCE.1 * wheels.abs()).then_some(
        Refusal::OutOfBalance {
            strain,
            wheels,
            sigmas: off / sigma,
        },
    )
}

fn verdicts(model: &PayloadModel, runs: &[WeighedRun], location: &Location) -> Vec<GaugeVerdict> {
    let forces: Vec<f64> = runs.iter().map(|r| r.force).collect();
    (0..model.gauges.len())
        .map(|g| {
            let estimates: Vec<f64> = runs
                .iter()
                .map(|r| r.estimates.get(g).copied().unwrap_or(f64::NAN))
                .collect();
            let good = location.good.get(g).copied().unwrap_or(0.0);
            // A negative sign counts against a gauge only if noise can't have caused it.
            let slack: Vec<f64> = runs
                .iter()
                .map(|r| SIGN_SIGMAS * r.estimate_sigma.get(g).copied().unwrap_or(f64::NAN))
                .collect();
            let mut v = verdict_words(&model.gauges[g], &estimates, &slack, &forces, good);
            report_weak_gauge(&mut v, g, runs);
            v
        })
        .collect()
}

/// States in the reason of a used gauge that it is too weak to determine the payload alone.
fn report_weak_gauge(v: &mut GaugeVerdict, g: usize, runs: &[WeighedRun]) {
    let share = runs
        .iter()
        .filter(|r| r.refused.is_none())
        .filter_map(|r| Some(r.estimate_sigma.get(g)? / r.force.abs()))
        .filter(|s| s.is_finite())
        .fold(f64::INFINITY, f64::min);
    if v.used && share > WEAK_SHARE && share.is_finite() {
        v.reason = format!(
            "too weak: this gauge alone leaves the payload uncertain by {:.0} %",
            100.0 * share
        );
    }
}
