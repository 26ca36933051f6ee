//! Sets that differ from the best one by the channel at fault. They are scored even if the search did not reach them, so that all indistinguishable
//! channels are compared.

use super::change::Change;
use super::design::BinEquation;
use super::evidence::{evidence, evidence_outside_shaking};
use super::fit::{Effort, fit};
use super::frame::MotionFrame;
use super::motion_fit::MotionFit;
use super::scorer::MotionScorer;
use super::unexplained_background::of_fit;
use crate::reconcile::search::{ScoredSet, Scorer, settle};

/// Adds to `all` the best set with each of its channel faults moved to every other channel of the kind, and sorts `all`, best first.
///
/// The background is in the units of the equations, whose scale the gain of a channel may change. If no force fixes the scale, models that differ
/// only by that scale are indistinguishable. Each of these sets is therefore compared with the best one under its own background. The lead is the
/// difference of both likelihoods at their largest.
///
/// Constants of forms (such as the velocity below which friction fades) were estimated before the fault was added, or with another channel at fault.
/// They then contain the error of that channel. The constants are therefore estimated again for each of these sets, so that no set leads only because
/// of them.
pub fn add_indistinguishable_causes(
    scorer: &mut MotionScorer,
    all: &mut Vec<ScoredSet<MotionFit>>,
    decisive: f64,
) {
    let Some(best) = settle(all, decisive) else {
        return;
    };
    let candidates = scorer.candidates;
    if !best.set.iter().any(|&m| candidates[m].is_channel()) {
        return;
    }
    let best = scorer.with_own_constants(best);
    all.retain(|s| s.set != best.set);
    all.push(best.clone());
    let beside = |fit: &MotionFit| evidence_outside_shaking(scorer.frame, fit);
    let of_best = with_own_background(scorer, &best).log_evidence;
    for &member in &best.set {
        let own = &candidates[member];
        if !own.is_channel() {
            continue;
        }
        for (c, other) in candidates.iter().enumerate() {
            if best.set.contains(&c) || other.family() != own.family() {
                continue;
            }
            let mut set: Vec<usize> = best.set.iter().copied().filter(|m| *m != member).collect();
            set.push(c);
            set.sort_unstable();
            let known = all.iter().position(|s| s.set == set);
            let scored = known.map(|at| all.swap_remove(at));
            let scored = scored.or_else(|| scorer.score(&set, Some((&best, None))));
            all.extend(scored.map(|s| {
                let alias = with_own_background(scorer, &scorer.with_own_constants(s));
                let free = has_no_scale(scorer.frame, &best.fit);
                let lead = match free && is_inverse((&best.fit, member), (&alias.fit, c)) {
                    true => beside(&alias.fit) - beside(&best.fit),
                    false => alias.log_evidence - of_best,
                };
                ScoredSet {
                    log_evidence: best.log_evidence + lead,
                    ..alias
                }
            }));
        }
    }
    all.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
}

/// Fits a set under the background from its own residual, again as long as the log evidence rises.
fn with_own_background(scorer: &MotionScorer, of: &ScoredSet<MotionFit>) -> ScoredSet<MotionFit> {
    /// Largest number of updates of the background.
    const ROUNDS: usize = 4;
    /// Rise of the log evidence that counts as settled.
    const SETTLED: f64 = 0.1;
    let mut best = of.clone();
    if scorer.background.power.is_empty() {
        return best;
    }
    for _ in 0..ROUNDS {
        let own = of_fit(scorer.frame, &best.fit);
        let again = fit(
            scorer.frame,
            scorer.candidates,
            &scorer.frame.data,
            best.fit.parts.clone(),
            Some(&best.fit),
            &own,
            Effort::Settled,
        );
        let Some(fit) = again else { break };
        let log_evidence = evidence(scorer.frame, scorer.candidates, &fit);
        let rise = log_evidence - best.log_evidence;
        if rise > 0.0 {
            best = ScoredSet {
                log_evidence,
                fit,
                set: best.set,
            };
        }
        if !(rise > SETTLED) {
            break;
        }
    }
    best
}

/// Returns whether the scale of all measured quantities is free. This is the case for two channels that both measure motion, without a force and
/// without the weight. A gain of one channel and the inverse gain of the other are then the same model of the shaken part. A finite record may still
/// seem to prefer one of them.
fn has_no_scale(frame: &MotionFrame, fit: &MotionFit) -> bool {
    /// Channels of which one gain is the inverse of another.
    const PAIR: usize = 2;
    let equations = &fit.design.equations;
    let driven = |e: &BinEquation| e.target.iter().any(|t| t.norm_sqr() > 0.0);
    // A known nonlinear force fixes the scale, since it is not proportional to the motion. The test requires a known parameter and a nonlinear term
    // of any link.
    let mut terms = frame.vehicle.links.iter().flat_map(|l| &l.terms);
    let fixed = !frame.known.is_empty() && terms.any(|t| !t.is_linear());
    !fixed
        && fit.rest.is_none()
        && fit.design.channels.len() == PAIR
        && !equations.iter().any(driven)
}

/// Returns whether the gains of two candidates in two fits are inverse to each other. The limit is 3.3 standard deviations of both (probability one
/// in a thousand). Another member of the set with a free size can make them differ.
fn is_inverse(one: (&MotionFit, usize), other: (&MotionFit, usize)) -> bool {
    const DEVIATIONS: f64 = 3.3;
    let gain = |(fit, candidate): (&MotionFit, usize)| -> Option<[f64; 2]> {
        let at = fit.parts.iter().position(|p| p.candidate == candidate)?;
        let is_gain = matches!(fit.parts.get(at)?.shape, Change::Gain { .. });
        fit.sizes.get(at)?.first().copied().filter(|_| is_gain)
    };
    let (Some([a, of_a]), Some([b, of_b])) = (gain(one), gain(other)) else {
        return false;
    };
    (a * b).ln().abs() <= DEVIATIONS * (of_a / a).hypot(of_b / b)
}
