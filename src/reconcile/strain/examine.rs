//! Workflow on static strain: search, identify, test, report.

use super::explanation::{is_unmodelled, named_part};
use super::frame::StrainFrame;
use super::input_fault_search::wrong_records;
use super::likelihood::{Fit, Likelihood};
use super::own_covariance::best_by_own_covariance;
use super::sizes_found::effects_with_sizes;
use super::smooth_alternative::smooth_instead;
use super::validation::{Proofs, validate_set};
use super::verdict::{adequacy_of, at_floor, test_best_set};
use crate::finding::Finding;
use crate::reconcile::effect::{Candidate, Discrepancy, library};
use crate::reconcile::outcome::{Outcome, Verdict};
use crate::reconcile::search::{Breadth, ScoredSet, Scorer, search, search_near, settle};

/// Returns the breadth of the search in static problems. A few runs can separate at most three effects at once, with noise as a fourth.
fn breadth(frame: &StrainFrame) -> Breadth {
    Breadth {
        largest: 4,
        beam: 4,
        tries: 6,
        decisive: frame.rules.decisive,
    }
}

/// Examines `frame` with the effects of the library that `only` lists (all, if it is empty). If recorded loads have the wrong sign or unit, or are
/// exchanged, the outcome contains these findings and no effect is searched for.
pub fn examine(frame: &StrainFrame, only: &[String]) -> Outcome {
    let wrong = wrong_records(frame);
    if wrong.is_empty() {
        return examine_with(frame, &library(frame, only));
    }
    outcome_of_wrong_inputs(frame, wrong)
}

/// Returns the outcome of a frame with wrong inputs, reported by the findings `wrong`. No effect is searched for.
pub fn outcome_of_wrong_inputs(frame: &StrainFrame, wrong: Vec<Finding>) -> Outcome {
    let words: Vec<&str> = wrong.iter().map(|f| f.message.as_str()).collect();
    let remedies: Vec<&str> = wrong.iter().map(|f| f.remedy.as_str()).collect();
    Outcome {
        verdict: Verdict::Unknown,
        remains: words.join(" "),
        next_measurement: remedies.join(" "),
        input_faults: wrong,
        ..examine_with(frame, &[])
    }
}

/// Examines `frame` with `candidates`, which may include effects outside the library.
///
/// The stated uncertainty of the model is first an error of the strain predicted at a gauge. If no effect explains the gap beyond it, each influence
/// coefficient may have an error of this size as well. Errors of coefficients do not cancel if the strains of loads do.
pub fn examine_with(frame: &StrainFrame, candidates: &[Candidate]) -> Outcome {
    let outcome = examine_candidates(frame, candidates);
    let is_open = outcome.verdict == Verdict::Unknown && !frame.stop.is_asked();
    if !is_open || frame.model_rel <= frame.coefficient_rel {
        return outcome;
    }
    let by_coefficient = StrainFrame {
        coefficient_rel: frame.model_rel,
        ..frame.clone()
    };
    let second = examine_candidates(&by_coefficient, candidates);
    match second.verdict {
        Verdict::Unknown => outcome,
        _ => second,
    }
}

fn examine_candidates(frame: &StrainFrame, candidates: &[Candidate]) -> Outcome {
    let fit_runs = frame.observations.fit_runs();
    let mut reference: Vec<(usize, Vec<f64>)> = Vec::new();
    let mut all: Vec<ScoredSet<Fit>> = Vec::new();
    let mut best: Option<ScoredSet<Fit>> = None;
    /// Largest number of passes. The covariance follows the best prediction, and the set is stable after two passes in practice.
    const PASSES: usize = 3;
    /// Number of best sets of a pass from which the next pass starts.
    const KEPT: usize = 8;
    for _ in 0..PASSES {
        let mut likelihood = Likelihood::new(frame, candidates, &fit_runs, &reference);
        all = match all.len() {
            0 => search(&mut likelihood, breadth(frame)),
            n => search_near(&mut likelihood, breadth(frame), &all[..n.min(KEPT)]),
        };
        if frame.stop.is_asked() {
            break;
        }
        let found = settle(&all, frame.rules.decisive).and_then(|found| {
            let contenders = &all[..all.len().min(KEPT)];
            best_by_own_covariance(frame, candidates, &mut likelihood, contenders, &found)
        });
        let stable = match (&found, &best) {
            (Some(new), Some(old)) => new.set == old.set,
            (Some(new), None) => new.set.is_empty(),
            _ => true,
        };
        reference = found
            .iter()
            .flat_map(|s| s.set.iter().copied().zip(s.fit.parameters.clone()))
            .collect();
        if let Some(found) = &found
            && all.iter().all(|s| s.set != found.set)
        {
            all.insert(0, found.clone());
        }
        best = found;
        if stable {
            break;
        }
    }
    let empty = ScoredSet {
        set: Vec::new(),
        log_evidence: 0.0,
        fit: Fit::default(),
    };
    let best = best.unwrap_or(empty);
    let proofs = Proofs::from_frame(frame);
    if is_unmodelled(candidates, &best.set).is_some() && !frame.stop.is_asked() {
        // A general form is used only if no set of named effects reaches the expected residual.
        let likelihood = Likelihood::new(frame, candidates, &fit_runs, &reference);
        let mut names = likelihood.names_only();
        let mut named = named_instead(&mut names, candidates, &all[..all.len().min(KEPT)]);
        // The effects that a general form replaced need not be near it in the search, so a second search begins with the empty set.
        named.extend(search(&mut names, breadth(frame)));
        named.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
        named.dedup_by(|a, b| a.set == b.set);
        let found = settle(&named, frame.rules.decisive)
            .filter(|s| at_floor(frame, &adequacy_of(frame, candidates, s)));
        all.extend(named);
        all.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
        all.dedup_by(|a, b| a.set == b.set);
        if let Some(found) = found {
            return test_with_smooth_alternative(&proofs, candidates, all, found);
        }
    }
    let best = without_needless_noise(frame, candidates, &all, best);
    let best = without_needless_names(&proofs, candidates, &all, best);
    test_with_smooth_alternative(&proofs, candidates, all, best)
}

/// Tests `best`, or the smooth error of the model if it explains as much.
fn test_with_smooth_alternative(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    mut all: Vec<ScoredSet<Fit>>,
    best: ScoredSet<Fit>,
) -> Outcome {
    let Some(smooth) = smooth_instead(proofs.frame, candidates, &best) else {
        return test_best_set(proofs, candidates, &all, &best);
    };
    let replaced = effects_with_sizes(proofs.frame, candidates, &best);
    if all.iter().all(|s| s.set != best.set) {
        all.push(best);
    }
    all.push(smooth.clone());
    all.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    Outcome {
        replaced,
        ..test_best_set(proofs, candidates, &all, &smooth)
    }
}

/// Returns the best sets that contain only named effects, searched from the best sets with general forms.
fn named_instead(
    likelihood: &mut Likelihood<'_>,
    candidates: &[Candidate],
    known: &[ScoredSet<Fit>],
) -> Vec<ScoredSet<Fit>> {
    let form = |c: &usize| {
        matches!(
            candidates.get(*c).and_then(|c| c.effect.discrepancy()),
            Some(Discrepancy::Form(_))
        )
    };
    let mut plain: Vec<ScoredSet<Fit>> = Vec::new();
    for s in known {
        let set: Vec<usize> = s.set.iter().copied().filter(|c| !form(c)).collect();
        if plain.iter().all(|p| p.set != set) {
            plain.extend(likelihood.score(&set, Some((s, None))));
        }
    }
    search_near(likelihood, breadth(likelihood.frame), &plain)
}

/// Returns the set without the effects of understated noise, if it reaches the expected residual without them. Noise that is correlated between runs
/// stays in the set. A constant offset that is significant in ten independent runs may not be significant in ten correlated runs.
fn without_needless_noise(
    frame: &StrainFrame,
    candidates: &[Candidate],
    all: &[ScoredSet<Fit>],
    best: ScoredSet<Fit>,
) -> ScoredSet<Fit> {
    let kept = named_part(candidates, &best.set);
    let wanders = |c: &usize| {
        let own = candidates.get(*c).and_then(|c| c.effect.amplitudes(frame));
        own.is_some_and(|a| a.correlation > 0.0)
    };
    if best.set.iter().any(wanders) {
        return best;
    }
    let plain = all
        .iter()
        .find(|s| s.set == kept && s.set.len() < best.set.len());
    plain
        .filter(|s| at_floor(frame, &adequacy_of(frame, candidates, s)))
        .cloned()
        .unwrap_or(best)
}

/// Returns the set without unnecessary effects. Without them, the other effects reach the expected residual, and the prediction of the held-out runs
/// is no worse.
fn without_needless_names(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    all: &[ScoredSet<Fit>],
    mut best: ScoredSet<Fit>,
) -> ScoredSet<Fit> {
    while best.set.len() > 1 {
        let fewer = |s: &&ScoredSet<Fit>| {
            s.set.len() + 1 == best.set.len()
                && s.set.iter().all(|c| best.set.contains(c))
                && !named_part(candidates, &s.set).is_empty()
                && at_floor(proofs.frame, &adequacy_of(proofs.frame, candidates, s))
        };
        let left: Vec<&ScoredSet<Fit>> = all.iter().filter(fewer).collect();
        if left.is_empty() {
            break;
        }
        let after = validate_set(proofs, candidates, &best).0.after;
        let no_worse = |s: &&&ScoredSet<Fit>| validate_set(proofs, candidates, s).0.after <= after;
        let Some(enough) = left.iter().find(no_worse) else {
            break;
        };
        best = (*enough).clone();
    }
    best
}
