//! A payload weighed by all there is: single gauges, all gauges together, wheel forces; checked by sign and equilibrium.

use super::evidence::{PayloadModel, PayloadRun, Place, Refusal, Support, WeighSpec, WeighedRun};
use super::locate::{Balance, Located, Location, locate};
use super::robust::{
    GaugeEstimates, GaugeVerdict, RobustSpec, SIGN_SIGMAS, robust_payload, verdict_words,
};
use crate::recovery::NORMAL_95;

/// The answer for all runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Weighing {
    /// By run.
    pub runs: Vec<WeighedRun>,
    /// By gauge; empty without strain.
    pub gauges: Vec<GaugeVerdict>,
}

/// Gauge factors are good to this: the least scatter between good gauges that is proportional to the load.
const GAUGE_FACTOR_REL: f64 = 0.01;
/// Strain and wheel forces disagree from this many standard deviations and this share of the weight on.
const OUT_OF_BALANCE: (f64, f64) = (4.0, 0.05);
/// A payload outside the region by more standard deviations is refused.
const OUTSIDE: f64 = 3.0;
/// A weight is below zero beyond doubt from this many standard deviations on.
const SURELY: f64 = 2.0;
/// A gauge alone that leaves the weight this uncertain (share, 1 sd) is too weak for the job.
const WEAK_SHARE: f64 = 1.0 / 3.0;

/// Weighs the payload of every run.
///
/// With a known place and strain alone the posterior of [`robust_payload`]; else [`locate`]. Interval: 95 %. An answer that breaks sign,
/// region or equilibrium keeps its numbers and says why it is refused.
pub fn weigh(model: &PayloadModel, runs: &[PayloadRun], spec: &WeighSpec) -> Weighing {
    let n = model.gauges.len();
    let has_strain = runs.iter().any(|r| r.strain.iter().any(|v| v.is_finite()));
    let has_wheels = runs.iter().any(|r| !r.reactions.is_empty());
    if has_strain && !has_wheels && spec.place == Place::Known {
        return by_strain(model, runs, spec);
    }
    let Some(location) = locate(model, runs, spec, Balance::Kept) else {
        return Weighing {
            runs: runs.iter().map(|r| undetermined(r, n)).collect(),
            gauges: Vec::new(),
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
            let mut w = weighed(model, run, found, spec);
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
    Weighing { runs: out, gauges }
}

fn undetermined(run: &PayloadRun, n: usize) -> WeighedRun {
    WeighedRun {
        run: run.run.clone(),
        force: f64::NAN,
        sigma: f64::NAN,
        interval: [f64::NAN; 2],
        shift: run.shift,
        shift_covariance: [0.0; 4],
        refused: Some(Refusal::Undetermined),
        estimates: vec![f64::NAN; n],
        estimate_sigma: vec![f64::NAN; n],
    }
}

/// What each gauge alone says of a run: its reading, less what measured wheel forces cause, over its answer to a unit weight.
fn alone(
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

/// Known place, strain alone.
fn by_strain(model: &PayloadModel, runs: &[PayloadRun], spec: &WeighSpec) -> Weighing {
    let n = model.gauges.len();
    // Sizes for the model's error: from the gauges' median first, then from the answer.
    let mut sizes: Vec<f64> = runs
        .iter()
        .map(|r| {
            let (e, _) = alone(model, r, r.shift, &[], 0.0, spec);
            let mut e: Vec<f64> = e
                .into_iter()
                .filter(|v| *v > 0.0 && *v <= spec.largest)
                .collect();
            e.sort_by(f64::total_cmp);
            e.get(e.len() / 2).copied().unwrap_or(0.0)
        })
        .collect();
    let mut answer = None;
    let mut singles: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    for _ in 0..2 {
        singles = runs
            .iter()
            .zip(&sizes)
            .map(|(r, size)| {
                let p = [*size, size * r.shift[0], size * r.shift[1]];
                let reactions: Vec<f64> = model.floor.as_ref().map_or_else(Vec::new, |floor| {
                    (0..floor.nrows())
                        .map(|w| (0..3).map(|k| floor[(w, k)] * p[k]).sum())
                        .collect()
                });
                alone(model, r, r.shift, &reactions, *size, spec)
            })
            .collect();
        let gauges: Vec<GaugeEstimates> = (0..n)
            .map(|g| GaugeEstimates {
                name: model.gauges[g].clone(),
                estimates: singles.iter().map(|s| s.0[g]).collect(),
                sigma: Some(singles.iter().map(|s| s.1[g]).collect()),
            })
            .collect();
        answer = robust_payload(
            &gauges,
            &RobustSpec {
                relative_scatter: spec.model_rel.max(GAUGE_FACTOR_REL),
                largest: spec.largest,
            },
        );
        if let Some(a) = &answer {
            sizes = a.runs.iter().map(|r| r.value).collect();
        }
    }
    let Some(answer) = answer else {
        // No gauge says a possible payload.
        let runs = runs
            .iter()
            .zip(singles)
            .map(|(r, (estimates, estimate_sigma))| {
                let mut finite: Vec<f64> = estimates
                    .iter()
                    .copied()
                    .filter(|v| v.is_finite())
                    .collect();
                finite.sort_by(f64::total_cmp);
                let middle = finite.get(finite.len() / 2).copied();
                WeighedRun {
                    force: middle.unwrap_or(f64::NAN),
                    refused: Some(
                        middle.map_or(Refusal::Undetermined, |force| Refusal::Negative { force }),
                    ),
                    estimates,
                    estimate_sigma,
                    ..undetermined(r, n)
                }
            })
            .collect();
        return Weighing {
            runs,
            gauges: Vec::new(),
        };
    };
    let out: Vec<WeighedRun> = runs
        .iter()
        .zip(&answer.runs)
        .zip(singles)
        .map(|((run, a), (estimates, estimate_sigma))| {
            // The model's error as a whole widens what the gauges say between them.
            let whole = spec.model_rel * a.value;
            let widen = |edge: f64| {
                let half = edge - a.value;
                a.value + half.signum() * half.hypot(NORMAL_95 * whole)
            };
            WeighedRun {
                run: run.run.clone(),
                force: a.value,
                sigma: a.sigma.hypot(whole),
                interval: a.interval.map(widen),
                shift: run.shift,
                shift_covariance: [0.0; 4],
                refused: negative_by_most(&estimates, &estimate_sigma),
                estimates,
                estimate_sigma,
            }
        })
        .collect();
    let mut gauges = answer.gauges;
    for (g, v) in gauges.iter_mut().enumerate() {
        say_weak(v, g, &out);
    }
    Weighing { runs: out, gauges }
}

/// Refused where the gauges, weighed by what each can tell, say a weight below zero beyond doubt.
fn negative_by_most(estimates: &[f64], sigma: &[f64]) -> Option<Refusal> {
    let mut pairs: Vec<(f64, f64)> = estimates
        .iter()
        .zip(sigma)
        .filter(|(e, s)| e.is_finite() && **s > 0.0)
        .map(|(e, s)| (*e, 1.0 / s))
        .collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = pairs.iter().map(|p| p.1).sum();
    let mut sum = 0.0;
    for (e, w) in &pairs {
        sum += w;
        if sum >= total / 2.0 {
            let doubt = 3.0 * pairs.len() as f64 / total / (pairs.len() as f64).sqrt();
            return (*e < -doubt).then_some(Refusal::Negative { force: *e });
        }
    }
    None
}

fn weighed(
    model: &PayloadModel,
    run: &PayloadRun,
    found: &Located,
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
    // By strain alone an error of the payload's column as a whole reads as a shift of its line of action: `model_rel` of how far the wheels
    // spread. Measured wheel forces fix that line by statics.
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
        alone(model, run, shift, &found.reactions, force, spec)
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
    WeighedRun {
        run: run.run.clone(),
        force,
        sigma,
        interval: [force - NORMAL_95 * sigma, force + NORMAL_95 * sigma],
        shift,
        shift_covariance,
        refused,
        estimates,
        estimate_sigma,
    }
}

fn out_of_balance(run: &PayloadRun, alone: &Located, spec: &WeighSpec) -> Option<Refusal> {
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
            // A sign is against a gauge only where its noise can't have made it.
            let slack: Vec<f64> = runs
                .iter()
                .map(|r| SIGN_SIGMAS * r.estimate_sigma.get(g).copied().unwrap_or(f64::NAN))
                .collect();
            let mut v = verdict_words(&model.gauges[g], &estimates, &slack, &forces, good);
            say_weak(&mut v, g, runs);
            v
        })
        .collect()
}

/// Says so where a gauge agrees only because it can't tell.
fn say_weak(v: &mut GaugeVerdict, g: usize, runs: &[WeighedRun]) {
    let share = runs
        .iter()
        .filter_map(|r| Some(r.estimate_sigma.get(g)? / r.force.abs()))
        .filter(|s| s.is_finite())
        .fold(f64::INFINITY, f64::min);
    if v.used && share > WEAK_SHARE && share.is_finite() {
        v.reason = format!(
            "too weak to tell: alone it leaves the payload uncertain by {:.0} %",
            100.0 * share
        );
    }
}
