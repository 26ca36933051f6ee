//! What is said of the best set of effects: named or not, and what else could be.

use super::adequacy::{Adequacy, adequacy, deviate_estimated};
use super::detect::detectable;
use super::explanation::{Explanation, discrepancy, ids, is_unmodelled, named_part};
use super::frame::StrainFrame;
use super::likelihood::Fit;
use super::neighbours::neighbours_that_fail;
use super::next::next_measurement;
use super::no_drift::no_drift;
use super::outlier::but_for_one;
use super::own_covariance::{own_evidence, under_own_covariance, with_members};
use super::prediction::predict;
use super::proven::proven;
use super::recovered::loads_before_after;
use super::remains::{Withheld, remains, sits};
use super::smooth::{curve, is_smooth};
use super::standing::Standing;
use super::validation::{Proofs, validated};
use crate::estimate::rms;
use crate::reconcile::effect::{Candidate, Discrepancy, StrainEffect, full_id};
use crate::reconcile::outcome::{Misfit, NamedEffect, Outcome, Rival, Verdict};
use crate::reconcile::search::Scored;
use rayon::prelude::*;

/// Rivals beyond this log evidence are not worth naming.
const WORTH_NAMING: f64 = 25.0;

/// Whether what a set leaves is what noise and stated uncertainty leave.
pub(super) fn at_floor(frame: &StrainFrame, a: &Adequacy) -> bool {
    let rules = &frame.rules;
    let inside = |reduced: f64, n: f64| {
        let known = rules.noise_known * rules.noise_known;
        deviate_estimated(reduced * n / known, n, a.from) <= rules.deviate
    };
    let held = a.n_held_out == 0.0 || inside(a.held_out, a.n_held_out);
    let parts = a
        .gauges
        .iter()
        .chain(&a.runs)
        .all(|m| m.deviate <= rules.part);
    inside(a.fit, a.n_fit) && held && parts
}

/// The effects of a set with their sizes, noise left out.
pub(super) fn named(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
) -> Vec<NamedEffect> {
    let mut out = Vec::new();
    for (m, &c) in scored.set.iter().enumerate() {
        let Some(candidate) = candidates
            .get(c)
            .filter(|c| !matches!(c.effect.discrepancy(), Some(Discrepancy::Noise(_))))
        else {
            continue;
        };
        let effect = candidate.effect.as_ref();
        if effect.smooth().is_some() {
            out.push(smooth_found(frame, candidates, scored, effect));
            continue;
        }
        let parameters = scored.fit.parameters.get(m).cloned().unwrap_or_default();
        let described = effect.parameters();
        let mut size = parameters.clone();
        let mut sigma = scored.fit.sigma.get(m).cloned().unwrap_or_default();
        let mut unit = described.first().map_or("1", |p| p.unit);
        let mut plausible = described
            .iter()
            .zip(&parameters)
            .all(|(p, v)| (v - p.neutral).abs() <= p.plausible);
        let sizes = scored.fit.sizes.iter().find(|s| s.0 == c);
        if let (Some(a), Some((_, sizes))) = (effect.amplitudes(frame), sizes) {
            // Root mean square over the runs, what repeats and what scatters together; from n amplitudes it is known to one part in the
            // root of 2 n.
            let n = (frame.observations.fit_runs().len() * a.patterns.len()).max(1) as f64;
            let kinds = a.usual.len();
            let rms = |k: usize| {
                sizes
                    .get(k)
                    .copied()
                    .unwrap_or(0.0)
                    .hypot(sizes.get(kinds + k).copied().unwrap_or(0.0))
            };
            let whole: Vec<f64> = (0..kinds).map(rms).collect();
            plausible &= whole.iter().all(|s| *s <= a.plausible);
            sigma.extend(whole.iter().map(|s| s / (2.0 * n).sqrt()));
            size.extend(whole);
            unit = a.unit;
        }
        out.push(NamedEffect {
            id: full_id(effect),
            place: effect.place(),
            size,
            sigma,
            unit,
            plausible,
            extension: effect.extension(frame, &parameters),
        });
    }
    out
}

/// A smooth error with the root mean square of what its factors are off by, and of their deviations.
fn smooth_found(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
    effect: &dyn StrainEffect,
) -> NamedEffect {
    let curve = curve(frame, candidates, scored);
    NamedEffect {
        id: full_id(effect),
        place: None,
        size: vec![rms(curve.iter().map(|c| c.factor - 1.0))],
        sigma: vec![rms(curve.iter().map(|c| c.sd))],
        unit: "1",
        plausible: true,
        extension: effect.extension(frame, &[]),
    }
}

fn worst_first(parts: &[Misfit], limit: f64) -> Vec<Misfit> {
    let mut off: Vec<Misfit> = parts
        .iter()
        .filter(|m| m.deviate > limit)
        .cloned()
        .collect();
    off.sort_by(|a, b| b.deviate.total_cmp(&a.deviate));
    off
}

/// Noise over the stated one where a set holds noise besides.
fn noise_factor(frame: &StrainFrame, candidates: &[Candidate], scored: &Scored<Fit>) -> f64 {
    let is_noise = |c: usize| matches!(discrepancy(candidates, c), Some(Discrepancy::Noise(_)));
    let added = scored
        .fit
        .sizes
        .iter()
        .find(|s| is_noise(s.0))
        .and_then(|s| s.1.first().copied());
    (1.0 + (added.unwrap_or(0.0) / frame.noise.max(f64::MIN_POSITIVE)).powi(2)).sqrt()
}

/// Judges a set: how far it comes, how many parameters it took.
pub(super) fn adequacy_of(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
) -> Adequacy {
    let e = Explanation::of(frame, candidates, scored);
    let n_parameters: usize = scored.fit.parameters.iter().map(Vec::len).sum();
    adequacy(frame, &e.members, &e.unknown, n_parameters)
}

/// How far a set comes, and the noise that it takes over the stated one.
fn reach(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
    before: &Adequacy,
) -> (Adequacy, f64) {
    let after = if scored.set.is_empty() {
        before.clone()
    } else {
        adequacy_of(frame, candidates, scored)
    };
    (after, noise_factor(frame, candidates, scored))
}

/// Whether a set that leaves `after`, with `noise` times the stated one, is at the floor; what is said of a reading but for which it is.
fn reaches_floor(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
    after: &Adequacy,
    noise: f64,
) -> (bool, Option<String>) {
    if noise > frame.rules.noise || at_floor(frame, after) {
        return (noise <= frame.rules.noise, None);
    }
    let alone = but_for_one(frame, candidates, scored, |rest| {
        at_floor(rest, &adequacy_of(rest, candidates, scored))
    });
    (alone.is_some(), alone)
}

/// The set of names alone, at least one, that has most evidence.
fn best_of_names<'a>(candidates: &[Candidate], all: &'a [Scored<Fit>]) -> Option<&'a Scored<Fit>> {
    let is_name = |c: &usize| discrepancy(candidates, *c).is_none();
    all.iter()
        .filter(|s| !s.set.is_empty() && s.set.iter().all(is_name))
        .max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
}

/// What is said of the best set. Names of it that do not stand when the runs are drawn anew, or by which the gap does not fall on runs that
/// were not fitted, are not named, and neither fit nor gap has them; that the floor is reached with them still speaks for the others.
pub(super) fn judge(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    all: &[Scored<Fit>],
    best: &Scored<Fit>,
) -> Outcome {
    let frame = proofs.frame;
    let before = adequacy(frame, &[], &[], 0);
    let (after, noise) = reach(frame, candidates, best, &before);
    let (reached, alone) = reaches_floor(frame, candidates, best, &after, noise);
    let rivals = rival_sets(frame, candidates, all, best);
    // As its rivals are.
    let level = |s: &Scored<Fit>| own_evidence(frame, candidates, s);
    let alike = Scored {
        log_evidence: level(best),
        ..best.clone()
    };
    let standing = Standing::of(frame, candidates, all, &alike, &rivals);
    let stands = standing.fewer(frame, candidates, best);
    let proven = proven(proofs, candidates, stands.as_ref().unwrap_or(best));
    let few = standing.doubt.clone().filter(|_| stands.is_some());
    let (taken_out, fewer) = match proven {
        Some(p) => (Some(p.doubt), Some(p.set)),
        None => (None, stands),
    };
    let (fewer, no_zero) = without_false_zeros(frame, candidates, fewer.as_ref().unwrap_or(best))
        .map_or((fewer, None), |(set, told)| (Some(set), Some(told)));
    let unsure: Vec<String> = [few, taken_out.clone(), no_zero, alone]
        .into_iter()
        .flatten()
        .collect();
    let best = fewer.as_ref().unwrap_or(best);
    let level = fewer.as_ref().map_or(alike.log_evidence, level);
    let explained = Explanation::of(frame, candidates, best);
    let (after, noise) = match fewer {
        Some(_) => reach(frame, candidates, best, &before),
        None => (after, noise),
    };
    let attempt = named(frame, candidates, best);
    let (gap, channels) = validated(proofs, candidates, best);
    let plausible = attempt.iter().all(|e| e.plausible);
    let null_evidence = (all.iter().find(|s| s.set.is_empty())).map_or(0.0, |s| s.log_evidence);
    let hint = best_of_names(candidates, all);
    let hinted = hint.is_some_and(|s| s.log_evidence > null_evidence.max(best.log_evidence));
    let unmodelled = is_unmodelled(candidates, &best.set);
    let seldom = standing.doubt.clone().filter(|_| standing.is_none());
    let doubt = neighbours_that_fail(frame, &attempt)
        .or_else(|| no_drift(frame, candidates, best).map(|n| n.words))
        // What explains the fitted runs that much better and runs to come no better is a form that is in no name.
        .or(taken_out.filter(|_| alike.log_evidence - level > WORTH_NAMING))
        .or(seldom);
    let falls = gap.after < gap.before;
    let verdict = match (attempt.is_empty(), reached) {
        (true, true) if hinted => Verdict::BelowDetectability,
        (true, true) => Verdict::None,
        (false, true) if plausible && unmodelled.is_none() && doubt.is_none() && falls => {
            Verdict::Named
        }
        _ => Verdict::Unknown,
    };
    let withheld = (verdict == Verdict::Unknown).then(|| Withheld {
        implausible: (attempt.iter().filter(|e| !e.plausible))
            .map(|e| match e.size.first() {
                Some(size) => format!("{} ({size:.4} {})", e.id, e.unit),
                None => e.id.clone(),
            })
            .collect(),
        no_fall: (!attempt.is_empty() && !falls).then_some([gap.before, gap.after]),
        noise: (noise > frame.rules.noise).then_some(noise),
        doubt,
        is_told: unmodelled.is_some(),
    });
    let next = match rivals.first().or(hint) {
        Some(s) => next_measurement(frame, &explained, &Explanation::of(frame, candidates, s)),
        None if verdict == Verdict::Unknown => look_again(&after),
        None => "none needed".into(),
    };
    let rivals = rivals_told(proofs, candidates, &rivals, level);
    let left = remains(
        frame,
        &explained.members,
        &after,
        unmodelled,
        withheld.as_ref(),
    );
    let is_curve = best.set.iter().any(|c| is_smooth(candidates, *c));
    Outcome {
        verdict,
        effects: if verdict == Verdict::Named {
            attempt.clone()
        } else {
            Vec::new()
        },
        best_attempt: attempt,
        replaced: Vec::new(),
        rivals,
        evidence: best.log_evidence - null_evidence,
        wins: standing.wins(&named_part(candidates, &best.set)),
        // The coefficients of a curve say nothing by themselves: `smooth` has what they make.
        covariance: match is_curve {
            true => Vec::new(),
            false => best.fit.covariance.clone(),
        },
        smooth: curve(frame, candidates, best),
        noise_factor: noise,
        gap,
        sits: sits(&channels, &worst_first(&before.gauges, frame.rules.part)),
        channels,
        loads: loads_before_after(frame, &explained.members, &explained.unknown),
        reduced_chi2: [before.fit, after.fit, after.held_out],
        gauges_off_before: worst_first(&before.gauges, frame.rules.part),
        gauges_off: worst_first(&after.gauges, frame.rules.part),
        runs_off: worst_first(&after.runs, frame.rules.part),
        remains: [vec![left], unsure].concat().join("; "),
        predicted: predict(frame, &explained.members),
        next_measurement: next,
        detectable: detectable(frame, candidates, hint.map_or(&[], |h| h.set.as_slice())),
        input_faults: Vec::new(),
    }
}

/// A set without the zeros of it that do not drift, where it reaches the floor without them and has another name; what is said of them.
fn without_false_zeros(
    frame: &StrainFrame,
    candidates: &[Candidate],
    best: &Scored<Fit>,
) -> Option<(Scored<Fit>, String)> {
    let mut set = best.clone();
    let mut told = Vec::new();
    while let Some(doubted) = no_drift(frame, candidates, &set) {
        let rest: Vec<usize> = (set.set.iter().copied())
            .filter(|c| *c != doubted.candidate)
            .collect();
        if named_part(candidates, &rest).is_empty() {
            return None;
        }
        set = under_own_covariance(frame, candidates, &rest, &set)?;
        told.push(doubted.words);
    }
    let reaches = || {
        let left = adequacy_of(frame, candidates, &set);
        let noise = noise_factor(frame, candidates, &set);
        reaches_floor(frame, candidates, &set, &left, noise).0
    };
    (!told.is_empty() && reaches()).then(|| (set, told.join("; ")))
}

/// What to measure where no effect of the library comes near: is it the gauges or the runs?
fn look_again(after: &Adequacy) -> String {
    /// As many gauges as one shunts in an hour.
    const MOST: usize = 4;
    let names = |parts: &[Misfit]| -> Vec<String> {
        let worst = worst_first(parts, 0.0);
        worst.iter().take(MOST).map(|m| m.name.clone()).collect()
    };
    let run = names(&after.runs).into_iter().next();
    format!(
        "shunt gauges {} before and after {}, made twice: readings that do not repeat are no effect of the loads",
        names(&after.gauges).join(", "),
        run.map_or("a run".into(), |r| format!("run {r}"))
    )
}

/// Rivals of a set of log evidence `level`, in words and numbers.
fn rivals_told(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    rivals: &[Scored<Fit>],
    level: f64,
) -> Vec<Rival> {
    let one = |s: &Scored<Fit>| Rival {
        ids: ids(candidates, &s.set),
        evidence_difference: level - s.log_evidence,
        gap_after: validated(proofs, candidates, s).0.after,
        indistinguishable: level - s.log_evidence < proofs.frame.rules.indistinguishable,
    };
    rivals.par_iter().map(one).collect()
}

/// Other sets of at most the same number of effects, nearest first, that do not contain the best one; each under its own covariance, as the
/// best one is.
fn rival_sets(
    frame: &StrainFrame,
    candidates: &[Candidate],
    all: &[Scored<Fit>],
    best: &Scored<Fit>,
) -> Vec<Scored<Fit>> {
    const MOST: usize = 5;
    /// Of twice as many, since under their own covariance they come in another order.
    const TRIED: usize = 2 * MOST;
    let own = named_part(candidates, &best.set);
    // Beside a curve, which can take many shapes, sets of any number of names stand.
    let curved = own.iter().any(|c| is_smooth(candidates, *c));
    let is_near = |s: &Scored<Fit>| best.log_evidence - s.log_evidence < WORTH_NAMING;
    let other = |s: &&Scored<Fit>| {
        let named = named_part(candidates, &s.set);
        !named.is_empty()
            && is_unmodelled(candidates, &s.set).is_none()
            && named != own
            && (curved || named.len() <= own.len().max(1))
            && is_near(s)
    };
    let near: Vec<&Scored<Fit>> = all.iter().filter(other).take(TRIED).collect();
    // What the best set takes of noise stands for no name: a rival may take it, too.
    let besides: Vec<usize> = (best.set.iter().copied())
        .filter(|c| !own.contains(c))
        .collect();
    let alike = |s: &&Scored<Fit>| {
        let alone = under_own_covariance(frame, candidates, &s.set, s);
        let mut set = named_part(candidates, &s.set);
        set.extend(&besides);
        set.sort_unstable();
        let beside = (set != s.set).then(|| with_members(frame, candidates, &set, s));
        let better = |a: &Scored<Fit>, b: &Scored<Fit>| a.log_evidence.total_cmp(&b.log_evidence);
        let both = alone.into_iter().chain(beside.flatten());
        both.max_by(better).unwrap_or_else(|| (*s).clone())
    };
    let mut out: Vec<Scored<Fit>> = near.par_iter().map(alike).collect();
    out.retain(is_near);
    out.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    out.truncate(MOST);
    out
}
