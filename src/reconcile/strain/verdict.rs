//! Verdict on the best set of effects: whether it is named, and its alternative explanations.

use super::adequacy::{Adequacy, adequacy, deviate_estimated};
use super::alternatives::{
    AlternativeSet, WORTH_NAMING, find_alternative_sets, report_alternatives, without_own,
};
use super::companions::without_companions;
use super::detect::find_detectable_sizes;
use super::explanation::{Explanation, discrepancy, is_unmodelled, named_part};
use super::frame::StrainFrame;
use super::likelihood::Fit;
use super::neighbours::neighbours_that_fail;
use super::next::next_measurement;
use super::no_drift::no_drift;
use super::outlier::but_for_one;
use super::own_covariance::{own_evidence, under_own_covariance};
use super::prediction::predict;
use super::recovered_loads::loads_before_after;
use super::recurring_effects::Recurrence;
use super::remains::{remains, sits};
use super::resampled_runs::RESAMPLED_SETS;
use super::sizes_found::effects_with_sizes;
use super::smooth_alternative::{curve, is_smooth};
use super::unproven_effects::remove_unproven;
use super::validation::{Proofs, validate_set};
use crate::reconcile::checks::{Check, describe_better_alternative, reasons, verdict};
use crate::reconcile::effect::{Candidate, Discrepancy};
use crate::reconcile::outcome::{Gap, Misfit, NamedEffect, Outcome, Verdict};
use crate::reconcile::search::ScoredSet;

/// Returns whether the residual of a set is within its expected size from noise and stated uncertainty.
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

fn worst_first(parts: &[Misfit], limit: f64) -> Vec<Misfit> {
    let mut off: Vec<Misfit> = parts
        .iter()
        .filter(|m| m.deviate > limit)
        .cloned()
        .collect();
    off.sort_by(|a, b| b.deviate.total_cmp(&a.deviate));
    off
}

/// Returns the ratio of the noise of a set to the stated noise; 1 if the set contains no additional noise.
fn noise_factor(frame: &StrainFrame, candidates: &[Candidate], scored: &ScoredSet<Fit>) -> f64 {
    let is_noise = |c: usize| matches!(discrepancy(candidates, c), Some(Discrepancy::Noise(_)));
    let added = scored.fit.sizes.iter().filter(|s| is_noise(s.0));
    let added: f64 = added.filter_map(|s| s.1.first()).map(|s| s * s).sum();
    (1.0 + added / frame.noise.max(f64::MIN_POSITIVE).powi(2)).sqrt()
}

/// Returns the adequacy of a set, given the number of its parameters.
pub(super) fn adequacy_of(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
) -> Adequacy {
    let e = Explanation::from_fit(frame, candidates, scored);
    let n_parameters: usize = scored.fit.parameters.iter().map(Vec::len).sum();
    adequacy(frame, &e.members, &e.unknown, n_parameters)
}

/// Returns the adequacy of a set, and the ratio of its noise to the stated noise.
fn reach(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
    before: &Adequacy,
) -> (Adequacy, f64) {
    let after = if scored.set.is_empty() {
        before.clone()
    } else {
        adequacy_of(frame, candidates, scored)
    };
    (after, noise_factor(frame, candidates, scored))
}

/// Returns whether a set with the residual `after` and `noise` times the stated noise is at the floor. If it is only so without one reading, the
/// second value is a message on that reading.
fn reaches_floor(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
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

/// Returns the set with the most log evidence among the sets of one or more effects without general forms.
fn best_of_names<'a>(
    candidates: &[Candidate],
    all: &'a [ScoredSet<Fit>],
) -> Option<&'a ScoredSet<Fit>> {
    let is_name = |c: &usize| discrepancy(candidates, *c).is_none();
    all.iter()
        .filter(|s| !s.set.is_empty() && s.set.iter().all(is_name))
        .max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
}

/// Tests the best set and returns the outcome. Effects are removed from fit and gap if they do not recur in resampled run sets, or do not reduce
/// the gap on validation runs. The smaller set is tested against its own expected residual.
pub(super) fn test_best_set(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    all: &[ScoredSet<Fit>],
    best: &ScoredSet<Fit>,
) -> Outcome {
    let frame = proofs.frame;
    let rules = &frame.rules;
    let before = adequacy(frame, &[], &[], 0);
    let (fewer, needless) = without_companions(frame, candidates, best)
        .map_or((None, None), |(set, words)| (Some(set), Some(words)));
    let best = fewer.as_ref().unwrap_or(best);
    let mut rivals = find_alternative_sets(frame, candidates, all, best);
    // The best set is compared under its own covariance, as the alternative explanations are.
    let level = |s: &ScoredSet<Fit>| own_evidence(frame, candidates, s);
    let alike = ScoredSet {
        log_evidence: level(best),
        ..best.clone()
    };
    let standing = Recurrence::compare(frame, candidates, all, &alike, &rivals);
    let stands = standing.keep_recurring_effects(frame, candidates, best);
    let proven = remove_unproven(proofs, candidates, stands.as_ref().unwrap_or(best));
    let few = standing.doubt.clone().filter(|_| stands.is_some());
    let (taken_out, fewer) = match proven {
        Some(p) => (Some(p.doubt), Some(p.set)),
        None => (None, stands),
    };
    let (fewer, no_zero) = without_false_zeros(frame, candidates, fewer.as_ref().unwrap_or(best))
        .map_or((fewer, None), |(set, told)| (Some(set), Some(told)));
    let best = fewer.as_ref().unwrap_or(best);
    let level = fewer.as_ref().map_or(alike.log_evidence, level);
    let explained = Explanation::from_fit(frame, candidates, best);
    let (after, noise) = reach(frame, candidates, best, &before);
    let (reached, alone) = reaches_floor(frame, candidates, best, &after, noise);
    let unsure: Vec<String> = [needless, few, taken_out.clone(), no_zero, alone]
        .into_iter()
        .flatten()
        .collect();
    without_own(candidates, best, &mut rivals);
    let names = named_part(candidates, &best.set);
    let attempt = effects_with_sizes(frame, candidates, best);
    let (gap, channels) = validate_set(proofs, candidates, best);
    let null_evidence = (all.iter().find(|s| s.set.is_empty())).map_or(0.0, |s| s.log_evidence);
    let hint = best_of_names(candidates, all);
    let hinted = hint.is_some_and(|s| s.log_evidence > null_evidence.max(best.log_evidence));
    let unmodelled = is_unmodelled(candidates, &best.set);
    let wins = standing.wins(&names);
    let checks = checks_of(&EffectSetChecks {
        proofs,
        candidates,
        best,
        attempt: &attempt,
        rivals: &rivals,
        level,
        lost: alike.log_evidence - level,
        taken_out,
        standing: &standing,
        gap: &gap,
        noise,
        reached,
    });
    let agrees = match attempt.is_empty() {
        true => reached,
        false => agrees_without(frame, candidates, best, &before),
    };
    let verdict = verdict(attempt.is_empty(), &checks, agrees, hinted);
    let withheld = (verdict == Verdict::Unknown).then(|| match attempt.is_empty() {
        true => Vec::new(),
        false => reasons(&checks),
    });
    let next = match rivals.first().map(|r| &r.1).or(hint) {
        Some(s) => next_measurement(
            frame,
            &explained,
            &Explanation::from_fit(frame, candidates, s),
        ),
        None if verdict == Verdict::Unknown => look_again(&after),
        None => "none needed".into(),
    };
    let rivals = report_alternatives(proofs, candidates, &rivals, level);
    let left = remains(
        frame,
        &explained.members,
        &after,
        unmodelled,
        withheld.as_deref(),
    );
    Outcome {
        verdict,
        effects: match verdict {
            Verdict::Named => attempt.clone(),
            _ => Vec::new(),
        },
        best_attempt: attempt,
        replaced: Vec::new(),
        rivals,
        evidence: best.log_evidence - null_evidence,
        wins,
        covariance: covariance_of(candidates, best),
        smooth: curve(frame, candidates, best),
        noise_factor: noise,
        gap,
        sits: sits(&channels, &worst_first(&before.gauges, rules.part)),
        channels,
        loads: loads_before_after(frame, &explained.members, &explained.unknown),
        reduced_chi2: [before.fit, after.fit, after.held_out],
        gauges_off_before: worst_first(&before.gauges, rules.part),
        gauges_off: worst_first(&after.gauges, rules.part),
        runs_off: worst_first(&after.runs, rules.part),
        remains: [vec![left], unsure].concat().join("; "),
        predicted: predict(frame, &explained.members),
        next_measurement: next,
        detectable: find_detectable_sizes(
            frame,
            candidates,
            hint.map_or(&[], |h| h.set.as_slice()),
        ),
        input_faults: Vec::new(),
    }
}

/// Returns the covariance of the parameters of a set. It is empty for a set with a smooth error, whose single coefficients have no meaning.
/// [`Outcome::smooth`] contains their sum.
fn covariance_of(candidates: &[Candidate], set: &ScoredSet<Fit>) -> Vec<f64> {
    match set.set.iter().any(|c| is_smooth(candidates, *c)) {
        true => Vec::new(),
        false => set.fit.covariance.clone(),
    }
}

/// Set of effects with the data for its checks.
struct EffectSetChecks<'a> {
    proofs: &'a Proofs<'a>,
    candidates: &'a [Candidate],
    best: &'a ScoredSet<Fit>,
    attempt: &'a [NamedEffect],
    rivals: &'a [AlternativeSet],
    /// Log evidence of the set under its own covariance.
    level: f64,
    /// Log evidence lost with the removed effects.
    lost: f64,
    /// Message on the removed effects.
    taken_out: Option<String>,
    standing: &'a Recurrence,
    gap: &'a Gap,
    noise: f64,
    /// Whether the set reaches its own floor.
    reached: bool,
}

/// Returns the checks that a set must pass to be named.
fn checks_of(set: &EffectSetChecks<'_>) -> [Check; 10] {
    let (frame, gap, noise) = (set.proofs.frame, set.gap, set.noise);
    let rules = &frame.rules;
    let wins = set
        .standing
        .wins(&named_part(set.candidates, &set.best.set));
    [
        Check::unless(neighbours_that_fail(frame, set.attempt)),
        Check::unless(no_drift(frame, set.candidates, set.best).map(|n| n.words)),
        // The removed effect explains the fitted runs that much better, but does not predict other runs better. The cause then has a form that the
        // library lacks.
        Check::unless(set.taken_out.clone().filter(|_| set.lost > WORTH_NAMING)),
        Check::from_condition(
            wins as f64 >= rules.drawings * RESAMPLED_SETS as f64,
            || {
                set.standing.doubt.clone().unwrap_or_else(|| {
                    format!(
                        "{wins} of {RESAMPLED_SETS} resampled run sets contain every effect of it"
                    )
                })
            },
        ),
        Check::unless(describe_better_alternative(
            (set.attempt.len(), set.level),
            [rules.indistinguishable, rules.decisive],
            (set.rivals.iter()).map(|r| (r.0.as_slice(), r.1.log_evidence)),
        )),
        Check::from_condition(set.attempt.iter().all(|e| e.plausible), || {
            format!(
                "the size of {} is not plausible",
                list_implausible_sizes(set.attempt)
            )
        }),
        Check::from_condition(gap.falls && gap.is_above_floor(), || {
            format!(
                "on runs that were not fitted, the gap does not fall significantly from above its floor ({:.2} % before, {:.2} % after, floor {:.2} %)",
                100.0 * gap.before,
                100.0 * gap.after,
                100.0 * gap.floor
            )
        }),
        Check::from_condition(noise <= rules.noise, || {
            format!("it requires noise of {noise:.2} times the stated noise")
        }),
        Check::from_condition(
            is_unmodelled(set.candidates, &set.best.set).is_none(),
            || "the pattern that closes the gap is not an effect of the library".into(),
        ),
        Check::from_condition(set.reached, || {
            "gauges or runs are above their floor".into()
        }),
    ]
}

/// Returns the effects whose size is not plausible, with their sizes, as a message.
fn list_implausible_sizes(attempt: &[NamedEffect]) -> String {
    let far = attempt.iter().filter(|e| !e.plausible);
    let words = far.map(|e| match e.size.first() {
        Some(_) => {
            let sizes: Vec<String> = e.size.iter().map(|s| format!("{s:.4}")).collect();
            format!("{} ({} {})", e.id, sizes.join(", "), e.unit)
        }
        None => e.id.clone(),
    });
    words.collect::<Vec<String>>().join(", ")
}

/// Returns whether the residual of the analyst's model, with the noise of `best`, does not exceed its expected size.
fn agrees_without(
    frame: &StrainFrame,
    candidates: &[Candidate],
    best: &ScoredSet<Fit>,
    before: &Adequacy,
) -> bool {
    if at_floor(frame, before) {
        return true;
    }
    let names = named_part(candidates, &best.set);
    let noise: Vec<usize> = (best.set.iter().copied())
        .filter(|c| !names.contains(c))
        .collect();
    let alone = (!noise.is_empty()).then(|| under_own_covariance(frame, candidates, &noise, best));
    alone.flatten().is_some_and(|s| {
        let (after, noise) = reach(frame, candidates, &s, before);
        noise <= frame.rules.noise && at_floor(frame, &after)
    })
}

/// Returns the set without its zeros that do not drift, and a message on them. `None` if it has no such zero, or if the smaller set does not reach
/// the expected residual or contains no identified effect.
fn without_false_zeros(
    frame: &StrainFrame,
    candidates: &[Candidate],
    best: &ScoredSet<Fit>,
) -> Option<(ScoredSet<Fit>, String)> {
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

/// Returns the measurement that separates faults of gauges from faults of runs, for a gap that no effect of the library explains.
fn look_again(after: &Adequacy) -> String {
    /// Number of gauges that can be shunted in an hour.
    const MOST: usize = 4;
    let names = |parts: &[Misfit]| -> Vec<String> {
        let worst = worst_first(parts, 0.0);
        worst.iter().take(MOST).map(|m| m.name.clone()).collect()
    };
    let run = names(&after.runs).into_iter().next();
    format!(
        "shunt gauges {} before and after {}, and repeat this run: readings that do not repeat are not an effect of the loads",
        names(&after.gauges).join(", "),
        run.map_or("a run".into(), |r| format!("run {r}"))
    )
}
