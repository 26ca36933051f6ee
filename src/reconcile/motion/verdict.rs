//! Verdict on the best set of a search: named, none, unknown or below detectability.

use super::change::Change;
use super::channel_check::BrokenChannel;
use super::corrections::state_corrections;
use super::detection_limits::smallest_sizes;
use super::effect_units::unit_of_change;
use super::fit::{Effort, fit};
use super::gap::{Proof, RecordGap, fitted_gap, proof, proof_gap};
use super::limits::{beyond_tolerance, effects_exceed_scatter};
use super::motion_fit::MotionFit;
use super::next::next_measurement;
use super::noise::Background;
use super::outcome::{MotionEffect, MotionOutcome};
use super::ranked_sets::{RankedEffectSets, other_sets};
use super::scorer::MotionScorer;
use super::sentences::remains;
use super::unproven_effects::remove_unproven;
use crate::reconcile::checks::{Check, describe_better_alternative, reasons, verdict};
use crate::reconcile::outcome::{AlternativeExplanation, Gap, GapBasis, Verdict};
use crate::reconcile::rules::MotionRules;
use crate::reconcile::search::{ScoredSet, settle};
use crate::vehicle::motion::VehicleError;

/// Gaps of a model.
struct Gaps {
    fitted: Option<RecordGap>,
    proof: Option<RecordGap>,
    /// Squared residual by degree of freedom under sensor noise alone, with tolerances at their estimates.
    reduced_chi2: f64,
}

impl Gaps {
    fn from_fit(scorer: &MotionScorer, f: &MotionFit) -> Self {
        let alone = refit_under_noise(scorer, f);
        Self {
            fitted: fitted_gap(scorer.frame, f),
            proof: proof_gap(scorer.frame, f),
            reduced_chi2: alone.reduced_chi2(),
        }
    }

    /// Returns whether a complete model may leave these gaps. The reduced chi-square is within its limit, or both the gap on the fitted record and
    /// the validation gap (`proof`) are within their limits. In addition, a known validation gap is within `rules.limits` times its limit. `excess`
    /// is the squared size of the part that identified effects removed, relative to the squared size of the measurement.
    fn at_floor(&self, rules: &MotionRules, excess: f64) -> bool {
        let within = |g: &RecordGap, limits: f64| {
            g.gap.powi(2) <= (limits * g.floor.limit(rules)).powi(2) + rules.form * excess
        };
        let is_at = |g: &Option<RecordGap>| g.as_ref().is_some_and(|g| within(g, 1.0));
        let is_near = |g: &RecordGap| within(g, rules.limits);
        let by_size = is_at(&self.fitted) && is_at(&self.proof);
        let by_residual = self.reduced_chi2 < rules.noise_factor * rules.noise_factor;
        (by_residual || by_size) && self.proof.as_ref().is_none_or(is_near)
    }
}

fn refit_under_noise(scorer: &MotionScorer, old: &MotionFit) -> MotionFit {
    fit(
        scorer.frame,
        scorer.candidates,
        &scorer.frame.data,
        old.parts.clone(),
        Some(old),
        &Background::default(),
        Effort::Settled,
    )
    .unwrap_or_else(|| old.clone())
}

/// Returns the outcome: the verdict with its reasons, sizes and gaps.
pub(super) fn conclude(
    scorer: &mut MotionScorer,
    found: RankedEffectSets,
) -> Result<MotionOutcome, VehicleError> {
    let RankedEffectSets {
        null,
        all,
        best,
        broken,
    } = found;
    let frame = scorer.frame;
    let rules = &frame.rules;
    let empty = all.iter().find(|s| s.set.is_empty()).cloned();
    let null_under_background = empty.as_ref().map_or(&null, |s| &s.fit);
    let best = find_nameable_set(scorer, &all, best);
    let (best, mut remarks) = remove_unproven(scorer, &all, best);
    let before = Gaps::from_fit(scorer, &null);
    let after = if best.set.is_empty() {
        Gaps::from_fit(scorer, null_under_background)
    } else {
        Gaps::from_fit(scorer, &best.fit)
    };
    let null_evidence = empty.as_ref().map_or(best.log_evidence, |s| s.log_evidence);
    let evidence = best.log_evidence - null_evidence;
    let taken = |g: &Option<RecordGap>| g.as_ref().map_or(0.0, |g| g.gap * g.gap);
    let excess = (taken(&before.fitted) - taken(&after.fitted)).max(0.0);
    let gap = gap_of(&before.proof, &after.proof, proof(frame, &best.fit));
    let rivals = list_alternatives(scorer, &best, &all);
    let checks = [
        Check::from_condition(evidence > rules.decisive, || {
            "its evidence is not decisive".into()
        }),
        Check::from_condition(effects_exceed_scatter(rules, &best.fit), || {
            "the size of one of its effects does not exceed its own scatter".into()
        }),
        Check::from_condition(after.at_floor(rules, excess), || {
            "the residual with this effect exceeds the noise floor".into()
        }),
        Check::from_condition(gap.falls && gap.is_above_floor(), || {
            "with this effect, the gap of the proof does not fall from above the noise floor by more than its sampling error".into()
        }),
        Check::unless(describe_better_alternative(
            (best.set.len(), best.log_evidence),
            [rules.indistinguishable, rules.decisive],
            (rivals.iter()).map(|r| (r.ids.as_slice(), best.log_evidence - r.evidence_difference)),
        )),
    ];
    let hint = all
        .iter()
        .find(|s| !s.set.is_empty())
        .is_some_and(|s| s.log_evidence - null_evidence > rules.hint);
    let verdict = match broken.is_empty() {
        true => verdict(
            best.set.is_empty(),
            &checks,
            before.at_floor(rules, 0.0),
            hint,
        ),
        // The record of the channel alone shows that the channel is not reliable.
        false => Verdict::Named,
    };
    if verdict == Verdict::Unknown && !best.set.is_empty() {
        let ids: Vec<&str> = (best.set.iter())
            .map(|&c| scorer.candidates[c].id.as_str())
            .collect();
        remarks.push(format!(
            "{} is nearest and is not identified: {}",
            ids.join(" + "),
            reasons(&checks).join(", ")
        ));
    }
    let attempt: Vec<MotionEffect> = if broken.is_empty() {
        effects_of(scorer, &best.fit)
    } else {
        broken.iter().map(broken_effect).collect()
    };
    let covariance = match broken.is_empty() {
        true => best.fit.covariance.clone(),
        false => vec![],
    };
    let left = shares_left(&before.fitted, &after.fitted);
    let chi = [before.reduced_chi2, after.reduced_chi2];
    let judged_by = proof(frame, &best.fit);
    Ok(MotionOutcome {
        verdict,
        effects: if verdict == Verdict::Named {
            attempt.clone()
        } else {
            vec![]
        },
        best_attempt: attempt,
        covariance,
        corrections: state_corrections(frame, &best.fit.parts),
        remains: remains(
            rules,
            verdict,
            chi,
            left,
            judged_by,
            after.proof.as_ref(),
            &remarks,
        ),
        next_measurement: next_measurement(scorer, verdict, &best, &all),
        rivals,
        evidence,
        decisive: rules.decisive,
        gap,
        judged_by,
        before: before.proof,
        after: after.proof,
        reduced_chi2: chi,
        left,
        smallest: smallest_sizes(scorer, &null),
    })
}

/// Returns the residual shares of the measured quantity on the fitted record before and after, and the expected residual.
pub(super) fn shares_left(before: &Option<RecordGap>, after: &Option<RecordGap>) -> [f64; 3] {
    let share = |g: &Option<RecordGap>, of: fn(&RecordGap) -> f64| g.as_ref().map_or(f64::NAN, of);
    [
        share(before, |g| g.gap),
        share(after, |g| g.gap),
        share(after, |g| g.floor.expected_residual()),
    ]
}

pub(super) fn gap_of(before: &Option<RecordGap>, after: &Option<RecordGap>, by: Proof) -> Gap {
    let of = |g: &Option<RecordGap>| g.as_ref().map_or(f64::NAN, |g| g.gap);
    let floor = after.as_ref().or(before.as_ref());
    Gap {
        before: of(before),
        after: of(after),
        floor: floor.map_or(f64::NAN, |g| g.floor.expected_residual()),
        mesh: None,
        basis: match by {
            Proof::HeldOut => GapBasis::HeldOut,
            Proof::CrossValidated => GapBasis::CrossValidated,
            Proof::Fitted => GapBasis::Fitted,
        },
        loads_found: None,
        falls: match (before, after) {
            (Some(before), Some(after)) => after.fall_from(before).is_seen(),
            _ => false,
        },
    }
}

/// Returns the best set whose members may all be named; `best` if there is no such set. Each size exceeds its own scatter, since a change of mass
/// that only hides the weight on the wheels would make any channel fit. Each channel fault exceeds its tolerance. Each vehicle effect reduces the
/// squared gap by more than declared tolerances leave on average. Each member next to a vehicle effect reduces it by more than the error in the form
/// of that effect leaves.
fn find_nameable_set(
    scorer: &MotionScorer,
    all: &[ScoredSet<MotionFit>],
    best: ScoredSet<MotionFit>,
) -> ScoredSet<MotionFit> {
    let frame = scorer.frame;
    let gaps: Vec<Option<RecordGap>> = all.iter().map(|s| fitted_gap(frame, &s.fit)).collect();
    let power = |set: &[usize]| {
        let at = all.iter().position(|s| s.set == set)?;
        gaps[at].as_ref().map(|g| g.gap * g.gap)
    };
    let material = |s: &ScoredSet<MotionFit>| {
        let Some(at) = all.iter().position(|o| o.set == s.set) else {
            return true;
        };
        let Some(own) = &gaps[at] else { return false };
        let of_vehicle = |m: &usize| !scorer.candidates[*m].is_channel();
        s.set.iter().copied().all(|member| {
            let rest: Vec<usize> = s.set.iter().copied().filter(|m| *m != member).collect();
            let has_other_effect = rest.iter().any(of_vehicle);
            // Two nonlinear functions of the stretch of one spring are one force law. An error in the form of the first function looks like the
            // second one.
            let spring = scorer.candidates[member].bends_spring();
            let one_law = spring.is_some_and(|l| {
                let of_rest = |m: &usize| scorer.candidates[*m].bends_spring() == Some(l);
                rest.iter().any(of_rest)
            });
            let share = if one_law {
                frame.rules.form
            } else {
                frame.rules.next_form
            };
            // Without a vehicle effect, a channel fault is tested by its size against its tolerance (`beyond_tolerance`).
            let tolerance = match (of_vehicle(&member), has_other_effect) {
                (true, _) => own.floor.tolerance,
                (false, true) => 0.0,
                (false, false) => return true,
            };
            power(&rest).is_none_or(|without| {
                // For a single effect, the share refers to the whole squared gap without effects.
                let others =
                    power(&[]).map_or(0.0, |p| if has_other_effect { p - without } else { p });
                let least = tolerance + share * others.max(0.0);
                without - own.gap * own.gap > least
            })
        })
    };
    let fine = |s: &ScoredSet<MotionFit>| {
        material(s)
            && beyond_tolerance(frame, &s.fit)
            && effects_exceed_scatter(&frame.rules, &s.fit)
    };
    if fine(&best) {
        return best;
    }
    let rest: Vec<ScoredSet<MotionFit>> = all.iter().filter(|s| fine(s)).cloned().collect();
    settle(&rest, frame.rules.decisive).unwrap_or(best)
}

/// Returns a channel that is not reliable, as an effect.
pub(super) fn broken_effect(b: &BrokenChannel) -> MotionEffect {
    MotionEffect {
        id: format!("{}:{}", b.id, b.channel),
        place: Some(b.channel.clone()),
        change: Change::Gain {
            channel: b.channel.clone(),
        },
        size: vec![b.measured],
        sigma: vec![f64::NAN],
        unit: String::new(),
        plausible: true,
    }
}

/// Returns the effects of a fit with sizes, standard deviations and units.
fn effects_of(scorer: &MotionScorer, fit: &MotionFit) -> Vec<MotionEffect> {
    fit.parts
        .iter()
        .zip(&fit.sizes)
        .map(|(p, sizes)| {
            let c = &scorer.candidates[p.candidate];
            let size: Vec<f64> = sizes.iter().map(|s| s[0]).collect();
            MotionEffect {
                id: c.id.clone(),
                place: c.place.clone(),
                change: p.shape.clone(),
                sigma: sizes.iter().map(|s| s[1]).collect(),
                unit: unit_of_change(scorer.frame, &p.shape, fit),
                plausible: size.iter().all(|v| v.is_finite()),
                size,
            }
        })
        .collect()
}

/// Returns the first of [`other_sets`] as alternative explanations.
fn list_alternatives(
    scorer: &MotionScorer,
    best: &ScoredSet<MotionFit>,
    all: &[ScoredSet<MotionFit>],
) -> Vec<AlternativeExplanation> {
    /// Largest number of alternative explanations in the outcome.
    const MOST: usize = 4;
    let ids = |s: &ScoredSet<MotionFit>| {
        let ids = s.set.iter().map(|&c| scorer.candidates[c].id.clone());
        let mut ids: Vec<String> = ids.collect();
        ids.sort();
        ids
    };
    let mut seen = vec![ids(best)];
    other_sets(best, all)
        .filter(|s| {
            let own = ids(s);
            let new = !seen.contains(&own);
            seen.push(own);
            new
        })
        .take(MOST)
        .map(|s| {
            let difference = best.log_evidence - s.log_evidence;
            AlternativeExplanation {
                ids: s
                    .set
                    .iter()
                    .map(|&c| scorer.candidates[c].id.clone())
                    .collect(),
                evidence_difference: difference,
                gap_after: proof_gap(scorer.frame, &s.fit).map_or(f64::NAN, |g| g.gap),
                indistinguishable: !best.set.is_empty()
                    && difference.abs() < scorer.frame.rules.indistinguishable,
            }
        })
        .collect()
}
