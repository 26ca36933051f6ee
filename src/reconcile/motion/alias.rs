//! Sets that differ from the best one by which channel is at fault: scored whether or not the search came by them, so that channels
//! which the record can't tell apart are all on the table.

use super::change::Change;
use super::design::BinEquation;
use super::evidence::{beside_shaking, evidence};
use super::fit::{Effort, fit};
use super::fitted::MotionFit;
use super::frame::MotionFrame;
use super::scorer::MotionScorer;
use super::unexplained_background::of_fit;
use crate::reconcile::search::{Scored, Scorer, settle};

/// Joins to `all` the best set with each of its channel faults moved to every other channel of the kind; best first again.
///
/// The background stands in the units of the equations, whose scale the gain of a channel may change; where no force fixes it, models that
/// differ by that scale alone are alike. So each of these sets is held against the best one with the background that it leaves itself, and
/// the lead is that of both likelihoods at their largest.
///
/// Constants of forms (the velocity below which friction fades) were found before the fault came, or with another channel at fault, and are as
/// wrong there as the channel is. Each of these sets finds its own, so that none leads by them.
pub fn with_aliases(scorer: &mut MotionScorer, all: &mut Vec<Scored<MotionFit>>, decisive: f64) {
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
    let beside = |fit: &MotionFit| beside_shaking(scorer.frame, fit);
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
                Scored {
                    log_evidence: best.log_evidence + lead,
                    ..alias
                }
            }));
        }
    }
    all.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
}

/// A set with the background that it leaves itself, as long as that makes its record likelier.
fn with_own_background(scorer: &MotionScorer, of: &Scored<MotionFit>) -> Scored<MotionFit> {
    /// Times that the background is found anew.
    const ROUNDS: usize = 4;
    /// A rise of the log evidence that is none.
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
            best = Scored {
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

/// Whether the scale of all that was measured is free: two channels, both of motion, and neither a force nor the weight beside them. A gain
/// of the one and the inverse gain of the other are then one and the same model of the shaken part, whatever a finite record seems to
/// prefer.
fn has_no_scale(frame: &MotionFrame, fit: &MotionFit) -> bool {
    /// Channels of which one gain is the inverse of another.
    const PAIR: usize = 2;
    let equations = &fit.design.equations;
    let driven = |e: &BinEquation| e.target.iter().any(|t| t.norm_sqr() > 0.0);
    // A force that is no multiple of the motion, and known.
    let mut terms = frame.vehicle.links.iter().flat_map(|l| &l.terms);
    let fixed = !frame.known.is_empty() && terms.any(|t| !t.is_linear());
    !fixed
        && fit.rest.is_none()
        && fit.design.channels.len() == PAIR
        && !equations.iter().any(driven)
}

/// Whether the gain that one fit finds by a candidate is the inverse of what the other finds by another, within 3.3 standard deviations of
/// both (one in a thousand): with something else in the set that has a size of its own it need not be.
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
