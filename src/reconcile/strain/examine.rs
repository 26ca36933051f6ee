//! The workflow on static strain: find, name, judge, show.

use super::adequacy::{Adequacy, adequacy};
use super::covariance::SizedAmplitudes;
use super::detect::{DECISIVE, detectable};
use super::frame::StrainFrame;
use super::gap::{gap, loads_before_after};
use super::likelihood::{Fit, Likelihood};
use super::next::{Explanation, next_measurement};
use super::remains::{remains, sits};
use crate::reconcile::effect::{Candidate, Extension, Member, full_id, library};
use crate::reconcile::outcome::{Misfit, NamedEffect, Outcome, Rival, Verdict};
use crate::reconcile::search::{Breadth, Scored, search, search_near, settle};

/// How far the search looks in static problems: three effects at once are as many as a few runs can part.
const BREADTH: Breadth = Breadth {
    largest: 3,
    beam: 4,
    tries: 6,
    decisive: DECISIVE,
};
/// Rivals within this log evidence can't be told apart: even odds and their usual scatter.
const INDISTINGUISHABLE: f64 = 3.0;
/// Rivals beyond this log evidence are not worth naming.
const WORTH_NAMING: f64 = 25.0;

/// Judges `frame` with the effects of the library that `only` lists (all, where it is empty).
pub fn examine(frame: &StrainFrame, only: &[String]) -> Outcome {
    let candidates = library(frame, only);
    let fit_runs = frame.observations.fit_runs();
    let mut reference: Vec<(usize, Vec<f64>)> = Vec::new();
    let mut all: Vec<Scored<Fit>> = Vec::new();
    let mut best: Option<Scored<Fit>> = None;
    /// The covariance follows the best prediction; the set is stable after two passes in practice.
    const PASSES: usize = 3;
    for _ in 0..PASSES {
        let mut likelihood = Likelihood::new(frame, &candidates, &fit_runs, &reference);
        /// Of the sets of a pass, those that the next one begins with.
        const KEPT: usize = 8;
        all = match all.len() {
            0 => search(&mut likelihood, BREADTH),
            n => search_near(&mut likelihood, BREADTH, &all[..n.min(KEPT)]),
        };
        let found = settle(&all, DECISIVE);
        let stable = match (&found, &best) {
            (Some(new), Some(old)) => new.set == old.set,
            (Some(new), None) => new.set.is_empty(),
            _ => true,
        };
        reference = found
            .iter()
            .flat_map(|s| s.set.iter().copied().zip(s.fit.parameters.clone()))
            .collect();
        best = found;
        if stable {
            break;
        }
    }
    let empty = Scored {
        set: Vec::new(),
        log_evidence: 0.0,
        fit: Fit::default(),
    };
    let best = best.unwrap_or(empty);
    let best = without_needless_strangers(frame, &candidates, &all, best);
    judge(frame, &candidates, &all, &best)
}

fn is_strange(candidates: &[Candidate], c: usize) -> bool {
    candidates
        .get(c)
        .is_some_and(|c| c.effect.outside().is_some())
}

/// The set without its general forms, where that reaches the floor as well.
fn without_needless_strangers(
    frame: &StrainFrame,
    candidates: &[Candidate],
    all: &[Scored<Fit>],
    best: Scored<Fit>,
) -> Scored<Fit> {
    let kept: Vec<usize> = best
        .set
        .iter()
        .copied()
        .filter(|&c| !is_strange(candidates, c))
        .collect();
    if kept.len() == best.set.len() {
        return best;
    }
    let Some(plain) = all.iter().find(|s| s.set == kept) else {
        return best;
    };
    let n_parameters: usize = plain.fit.parameters.iter().map(Vec::len).sum();
    let members = members_of(candidates, plain);
    let judged = adequacy(
        frame,
        &members,
        &unknown_of(frame, candidates, plain),
        n_parameters,
    );
    if at_floor(&judged) {
        plain.clone()
    } else {
        best
    }
}

fn members_of<'a>(candidates: &'a [Candidate], scored: &'a Scored<Fit>) -> Vec<Member<'a>> {
    let pairs = scored.set.iter().zip(&scored.fit.parameters);
    pairs
        .filter_map(|(&c, p)| {
            candidates.get(c).map(|c| Member {
                effect: c.effect.as_ref(),
                parameters: p,
            })
        })
        .collect()
}

fn unknown_of(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
) -> Vec<SizedAmplitudes> {
    let sized = |(c, sizes): &(usize, Vec<f64>)| {
        let amplitudes = candidates.get(*c)?.effect.amplitudes(frame)?;
        Some(SizedAmplitudes {
            amplitudes,
            sizes: sizes.clone(),
        })
    };
    scored.fit.sizes.iter().filter_map(sized).collect()
}

fn named(frame: &StrainFrame, candidates: &[Candidate], scored: &Scored<Fit>) -> Vec<NamedEffect> {
    let mut out = Vec::new();
    for (m, &c) in scored.set.iter().enumerate() {
        let Some(candidate) = candidates.get(c) else {
            continue;
        };
        let effect = candidate.effect.as_ref();
        let parameters = scored.fit.parameters.get(m).cloned().unwrap_or_default();
        let described = effect.parameters();
        let sizes = scored
            .fit
            .sizes
            .iter()
            .find(|s| s.0 == c)
            .map(|s| s.1.clone());
        let (size, sigma, unit, plausible) = match (effect.amplitudes(frame), sizes) {
            (Some(a), Some(sizes)) => {
                // A size from n amplitudes is known to one part in the root of 2 n.
                let n = (frame.observations.fit_runs().len() * a.patterns.len()).max(1) as f64;
                let sigma = sizes.iter().map(|s| s / (2.0 * n).sqrt()).collect();
                let plausible = sizes.iter().all(|s| *s <= a.plausible);
                (sizes, sigma, a.unit, plausible)
            }
            _ => {
                let plausible = described
                    .iter()
                    .zip(&parameters)
                    .all(|(p, v)| (v - p.neutral).abs() <= p.plausible);
                let sigma = scored.fit.sigma.get(m).cloned().unwrap_or_default();
                (
                    parameters.clone(),
                    sigma,
                    described.first().map_or("1", |p| p.unit),
                    plausible,
                )
            }
        };
        let extension = effect.extension(frame, &parameters);
        out.push(NamedEffect {
            id: full_id(effect),
            place: effect.place(),
            size,
            sigma,
            unit,
            plausible,
            extension,
        });
    }
    out
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

/// Limits of what counts as at the floor.
mod limit {
    /// Reduced chi-square of the fit runs: a misfit of a third more variance than stated.
    pub(super) const FIT: f64 = 1.35;
    /// And its deviate: with few readings a large value is no surprise.
    pub(super) const DEVIATE: f64 = 3.5;
    /// Reduced chi-square of the held-out runs.
    pub(super) const HELD_OUT: f64 = 1.6;
    /// A single gauge or run: one in a thousand over some forty of them.
    pub(super) const PART: f64 = 4.5;
}

fn at_floor(a: &Adequacy) -> bool {
    let overall = a.fit <= limit::FIT || a.fit_deviate <= limit::DEVIATE;
    let held = a.held_out <= limit::HELD_OUT || a.held_out_deviate <= limit::DEVIATE;
    let parts = a
        .gauges
        .iter()
        .chain(&a.runs)
        .all(|m| m.deviate <= limit::PART);
    overall && held && parts
}

fn judge(
    frame: &StrainFrame,
    candidates: &[Candidate],
    all: &[Scored<Fit>],
    best: &Scored<Fit>,
) -> Outcome {
    let members = members_of(candidates, best);
    let unknown = unknown_of(frame, candidates, best);
    let n_parameters: usize = best.fit.parameters.iter().map(Vec::len).sum();
    let before = adequacy(frame, &[], &[], 0);
    let after = if best.set.is_empty() {
        before.clone()
    } else {
        adequacy(frame, &members, &unknown, n_parameters)
    };
    let attempt = named(frame, candidates, best);
    let (gap_now, channels) = gap(frame, &members, &unknown);
    let reached = at_floor(&after);
    let plausible = attempt.iter().all(|e| e.plausible);
    let null = all.iter().find(|s| s.set.is_empty());
    let null_evidence = null.map_or(0.0, |s| s.log_evidence);
    let hint = all
        .iter()
        .filter(|s| !s.set.is_empty() && !s.set.iter().any(|&c| is_strange(candidates, c)))
        .max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence));
    let hinted = hint.is_some_and(|s| s.log_evidence > null_evidence);
    let strange = best
        .set
        .iter()
        .find_map(|&c| candidates.get(c).and_then(|c| c.effect.outside()));
    // Three effects at once that are not all faults of channels are a stranger taken apart.
    let channels_only = attempt
        .iter()
        .all(|e| matches!(e.extension, Extension::Channel { .. }));
    let too_many = best.set.len() > 2 && !channels_only;
    let named = reached && plausible && strange.is_none() && !too_many;
    let verdict = match (best.set.is_empty(), reached) {
        (true, true) if hinted => Verdict::BelowDetectability,
        (true, true) => Verdict::None,
        (false, _) if named => Verdict::Named,
        _ => Verdict::Unknown,
    };
    let second = rival_sets(candidates, all, best);
    let rivals: Vec<Rival> = second
        .iter()
        .map(|s| Rival {
            ids: s
                .set
                .iter()
                .filter_map(|&c| candidates.get(c))
                .map(|c| full_id(c.effect.as_ref()))
                .collect(),
            evidence_difference: best.log_evidence - s.log_evidence,
            gap_after: gap(
                frame,
                &members_of(candidates, s),
                &unknown_of(frame, candidates, s),
            )
            .0
            .after,
            indistinguishable: best.log_evidence - s.log_evidence < INDISTINGUISHABLE,
        })
        .collect();
    let explanation = |s: &'_ Scored<Fit>| unknown_of(frame, candidates, s);
    let first = Explanation {
        members: members_of(candidates, best),
        unknown: explanation(best),
    };
    let next = match second.first().copied().or(hint) {
        Some(s) => {
            let other = Explanation {
                members: members_of(candidates, s),
                unknown: explanation(s),
            };
            next_measurement(frame, &first, &other)
        }
        None if verdict == Verdict::Unknown => look_again(&after),
        None => "none needed".into(),
    };
    Outcome {
        verdict,
        effects: if verdict == Verdict::Named {
            attempt.clone()
        } else {
            Vec::new()
        },
        best_attempt: attempt,
        rivals,
        evidence: best.log_evidence - null_evidence,
        gap: gap_now,
        sits: sits(&channels, &worst_first(&before.gauges, limit::PART)),
        channels,
        loads: loads_before_after(frame, &members, &unknown),
        reduced_chi2: [before.fit, after.fit, after.held_out],
        gauges_off_before: worst_first(&before.gauges, limit::PART),
        gauges_off: worst_first(&after.gauges, limit::PART),
        runs_off: worst_first(&after.runs, limit::PART),
        remains: remains(frame, &members, &after, strange),
        next_measurement: next,
        detectable: detectable(frame, candidates),
    }
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

/// Other sets of at most the same number of effects, nearest first, that do not contain the best one.
fn rival_sets<'a>(
    candidates: &[Candidate],
    all: &'a [Scored<Fit>],
    best: &Scored<Fit>,
) -> Vec<&'a Scored<Fit>> {
    const MOST: usize = 5;
    let other = |s: &&Scored<Fit>| {
        !s.set.is_empty()
            && !s.set.iter().any(|&c| is_strange(candidates, c))
            && s.set != best.set
            && s.set.len() <= best.set.len().max(1)
            && best.log_evidence - s.log_evidence < WORTH_NAMING
    };
    let mut out: Vec<&Scored<Fit>> = all.iter().filter(other).collect();
    out.truncate(MOST);
    out
}
