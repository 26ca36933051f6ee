//! Complete dynamic workflow: find, name and test effects.

use super::alias::add_indistinguishable_causes;
use super::candidate::Candidate;
use super::change::Change;
use super::channel_check::{BrokenChannel, broken_channels};
use super::clock_rate::fit_of_clock;
use super::design::design;
use super::effect::library;
use super::fit::{Effort, fit};
use super::frame::MotionFrame;
use super::gap::fitted_gap;
use super::motion_fit::MotionFit;
use super::noise::Background;
use super::outcome::MotionOutcome;
use super::part::Part;
use super::ranked_sets::RankedEffectSets;
use super::scorer::MotionScorer;
use super::sound::outcome_of_dead;
use super::unexplained_background::{of_fit, power, unexplained_background};
use super::verdict::conclude;
use crate::reconcile::search::{Breadth, ScoredSet, Scorer, search, search_near, settle};
use crate::vehicle::adjustment::Adjustment;
use crate::vehicle::motion::VehicleError;

/// Returns the limits of the breadth of the search.
fn breadth(frame: &MotionFrame) -> Breadth {
    Breadth {
        largest: 3,
        beam: 2,
        tries: 4,
        decisive: frame.rules.decisive,
    }
}
/// Rounds of searching under a background that the last best set lowered.
const ROUNDS: usize = 3;
/// Fall of the background's power that makes another round worth while.
const LOWERED: f64 = 0.7;

/// Searches for the effects that explain the difference between a record and its vehicle model; `only` limits the library to some ids.
///
/// # Errors
/// [`VehicleError`] if the record cannot be fitted at all.
pub fn examine(frame: &MotionFrame, only: &[String]) -> Result<MotionOutcome, VehicleError> {
    let broken = broken_channels(frame, &frame.data);
    let first = design(
        frame,
        &frame.vehicle,
        &frame.data,
        &frame.corrections,
        vec![],
    )?;
    if let Some(record) = &frame.hold_out {
        let adjust = Adjustment::without_slips(&frame.corrections);
        design(frame, &frame.vehicle, record, &adjust, vec![])
            .map_err(|e| VehicleError::HeldOut(Box::new(e)))?;
    }
    if let Some(outcome) = outcome_of_dead(frame, &broken, only) {
        return Ok(outcome);
    }
    let candidates = library(frame, &first, only);
    let none = Background::default();
    let null = fit(
        frame,
        &candidates,
        &frame.data,
        vec![],
        None,
        &none,
        Effort::Settled,
    )
    .ok_or_else(|| VehicleError::NoEquation(frame.vehicle.name.clone()))?;
    let mut scorer = MotionScorer {
        frame,
        candidates: &candidates,
        background: none,
        forms: vec![],
    };
    let found = search_effect_sets(&mut scorer, null, broken);
    conclude(&mut scorer, found)
}

/// Sets of effects by evidence, the background found with them.
fn search_effect_sets(
    scorer: &mut MotionScorer,
    null: MotionFit,
    broken: Vec<BrokenChannel>,
) -> RankedEffectSets {
    let empty = ScoredSet {
        set: vec![],
        log_evidence: -0.5 * null.chi2,
        fit: null.clone(),
    };
    let mut all = Vec::new();
    let mut best = None;
    let found = find_dominant_faults(scorer, &null);
    let whole = |s: &ScoredSet<MotionFit>| {
        s.set
            .iter()
            .any(|&c| scorer.candidates[c].is_dominant_fault())
    };
    if let Some(first) = found.first().filter(|s| whole(s)) {
        best = Some(first.clone());
        all = found;
    } else if broken.is_empty() {
        // With a change of mass or a clock fault, further effects may be found. Without it, a search near the empty set has no meaning.
        let mut near = found;
        near.retain(|s| !s.set.is_empty() && !whole(s));
        near.truncate(breadth(scorer.frame).beam);
        if near.is_empty() {
            scorer.background = unexplained_background(scorer, &null);
        }
        for _ in 0..ROUNDS {
            all = if near.is_empty() {
                search(scorer, breadth(scorer.frame))
            } else {
                search_near(scorer, breadth(scorer.frame), &near)
            };
            if scorer.is_stopped() {
                break;
            }
            let decisive = scorer.frame.rules.decisive;
            add_indistinguishable_causes(scorer, &mut all, decisive);
            best = settle(&all, decisive);
            let Some(b) = &best else { break };
            let lower = of_fit(scorer.frame, &b.fit);
            if b.set.is_empty() || power(&lower) > LOWERED * power(&scorer.background) {
                break;
            }
            scorer.background = lower;
            if !near.is_empty() {
                near = vec![b.clone()];
            }
        }
    }
    RankedEffectSets {
        best: best.unwrap_or(empty),
        null,
        all,
        broken,
    }
}

/// Returns sets with a dominant fault, best first, and the empty set last. A dominant fault is an exchange or reversed sign of channels, a changed
/// mass, or a clock fault. Without it, the model explains almost none of the record, and with it almost the whole record.
///
/// Reversed signs of channels can be distinguished. They act differently on the balance of weight, the means of the accelerometers, and the signs of
/// masses and springs.
fn find_dominant_faults(scorer: &mut MotionScorer, null: &MotionFit) -> Vec<ScoredSet<MotionFit>> {
    /// Factor on the squared residual from which a fault is dominant.
    const FALL: f64 = 10.0;
    if fitted_gap(scorer.frame, null).is_none_or(|g| g.gap < scorer.frame.rules.lost) {
        return vec![];
    }
    let tried = |(c, candidate): (usize, &Candidate)| {
        if scorer.is_stopped() {
            return None;
        }
        let fitted = |shape: &Change| {
            if matches!(shape, Change::Clock { .. }) {
                return fit_of_clock(scorer.frame, scorer.candidates, c, shape);
            }
            let part = Part {
                candidate: c,
                shape: shape.clone(),
                fault: 0.0,
            };
            fit(
                scorer.frame,
                scorer.candidates,
                &scorer.frame.data,
                vec![part],
                None,
                &Background::default(),
                Effort::Settled,
            )
        };
        // For a step, the first two forms are the best moments with and without its weight. Only a fit can compare them.
        let starts = match candidate.shapes.first()? {
            Change::Step(_) => 2,
            _ => 1,
        };
        let f = (candidate.shapes.iter().take(starts).filter_map(fitted))
            .min_by(|a, b| a.chi2.total_cmp(&b.chi2))?;
        (FALL * f.chi2 < null.chi2).then_some((c, f))
    };
    let mut found: Vec<(usize, MotionFit)> = scorer
        .candidates
        .iter()
        .enumerate()
        .filter(|(_, c)| c.is_dominant_fault() || c.overturns())
        .filter_map(tried)
        .collect();
    found.sort_by(|a, b| a.1.chi2.total_cmp(&b.1.chi2));
    let Some((_, best)) = found.first() else {
        return vec![];
    };
    // These sets and the empty set are scored under the background of the set with the smallest residual.
    scorer.background = of_fit(scorer.frame, best);
    let mut out: Vec<ScoredSet<MotionFit>> = found
        .iter()
        .filter_map(|(c, f)| {
            let there = ScoredSet {
                set: vec![*c],
                log_evidence: 0.0,
                fit: f.clone(),
            };
            scorer.score(&[*c], Some((&there, None)))
        })
        .collect();
    out.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    if !out.is_empty() {
        out.extend(scorer.score(&[], None));
    }
    out
}
