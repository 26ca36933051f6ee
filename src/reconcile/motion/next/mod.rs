//! Selection of a measurement that separates explanations which the record cannot separate.
//!
//! Each explanation in turn is taken as true. The others predict the same measurement, with parameters as free as in the present record. Their misfit
//! over noise is the expected difference of log evidence ([`evidence_gain`]). [`measurement`] lists the possible measurements. [`view`] and, at rest,
//! [`bench`] give the predictions of an explanation.

mod alternative_misfit;
mod bench;
mod evidence_gain;
mod measurement;
mod parameter_information;
mod view;

use self::evidence_gain::expected_evidence;
use self::measurement::{Measurement, measurements};
use self::parameter_information::ParameterInformation;
use self::view::{View, view};
use super::motion_fit::MotionFit;
use super::ranked_sets::other_sets;
use super::scorer::MotionScorer;
use crate::finding::capitalize;
use crate::reconcile::outcome::Verdict;
use crate::reconcile::search::{ScoredSet, Scorer};

/// Expected difference of log evidence that justifies a measurement. It is the difference that decides between two effects, plus half of it for
/// losses that no model predicts.
const WORTH: f64 = 5.0;
/// Difference of log evidence that counts as certain: odds of 10^10.
const SURE: f64 = 25.0;
/// Largest number of alternative explanations for a measurement to separate.
const MOST: usize = 3;
/// Name of an explanation without effects.
const AS_IT_IS: &str = "the model as it is";
/// Instruction if no measurement separates the nearest explanations.
const LEFT_OUT: &str = "measure quantities that the model does not contain: the other side and axle, spring travel, a second accelerometer on each body";

/// Measurement with the smallest log evidence that it is expected to bring between the first explanation and each other one.
struct MeasurementEvidence {
    measurement: Measurement,
    worth: Vec<f64>,
}

impl MeasurementEvidence {
    /// Returns the number of separated pairs, then the sum of their log evidence. The log evidence of a pair counts up to certainty only. Of several
    /// equally certain measurements, the first one needs the least effort.
    fn rank(&self) -> (usize, f64) {
        let separated = self.worth.iter().filter(|w| **w > WORTH).count();
        (separated, self.worth.iter().map(|w| w.min(SURE)).sum())
    }

    /// Returns whether every pair is separated with certainty.
    fn is_sure(&self) -> bool {
        self.worth.iter().all(|w| *w >= SURE)
    }
}

/// Returns the instruction that separates the nearest explanations, with the expected log evidence if a measurement does.
pub(super) fn next_measurement(
    scorer: &MotionScorer,
    verdict: Verdict,
    best: &ScoredSet<MotionFit>,
    all: &[ScoredSet<MotionFit>],
) -> String {
    let list = explanations(scorer, verdict, best, all);
    let names: Vec<String> = list.iter().map(|s| name(scorer, s)).collect();
    let weighed = match list.len() {
        0 | 1 => None,
        _ if scorer.is_stopped() => None,
        _ => best_of(scorer, &list),
    };
    let others = names.get(1..).unwrap_or_default().join(", ");
    let first = names.first().map_or(AS_IT_IS, String::as_str);
    let proposal = weighed.map(|w| {
        let each: Vec<String> = (names.iter().skip(1).zip(&w.worth))
            .map(|(name, worth)| format!("from {name} {worth:.0}"))
            .collect();
        let words = w.measurement.words(scorer.frame);
        (
            words,
            format!(
                "expected difference of log evidence of {first}: {}",
                each.join(", ")
            ),
        )
    });
    match (verdict, proposal) {
        (Verdict::Named, Some((words, each))) => format!("{} ({each}).", capitalize(&words)),
        (Verdict::Named, None) if !others.is_empty() => format!(
            "No tested road, sensor or mass separates {first} from {others}: treat them as one cause."
        ),
        (Verdict::Named, None) => {
            "No further measurement is needed; another road would confirm the result.".into()
        }
        (Verdict::Unknown, Some((words, each))) => format!(
            "{}. This separates most of the nearest explanations ({each}). Or {LEFT_OUT}.",
            capitalize(&words)
        ),
        (Verdict::Unknown, None) => format!("{}.", capitalize(LEFT_OUT)),
        (Verdict::BelowDetectability, Some((words, each))) => {
            format!(
                "{}. This confirms or excludes the indicated effect ({each}).",
                capitalize(&words)
            )
        }
        (Verdict::None | Verdict::BelowDetectability, _) => {
            "A rougher road or longer record would show smaller effects.".into()
        }
    }
}

/// Returns the explanations to separate, the first from all others. These are the best set and the sets that are indistinguishable from it. If no
/// effect is named, these are the nearest set and the best set of another kind. For a hint, these are the hint and the model without it.
fn explanations<'a>(
    scorer: &MotionScorer,
    verdict: Verdict,
    best: &'a ScoredSet<MotionFit>,
    all: &'a [ScoredSet<MotionFit>],
) -> Vec<&'a ScoredSet<MotionFit>> {
    let empty = all.iter().find(|s| s.set.is_empty());
    let nearest = match best.set.is_empty() {
        true => all.iter().find(|s| !s.set.is_empty()),
        false => Some(best),
    };
    let Some(nearest) = nearest.filter(|_| verdict != Verdict::None) else {
        return vec![];
    };
    let others = || other_sets(nearest, all);
    let level = nearest.log_evidence;
    let close: Vec<_> = others()
        .filter(|s| (level - s.log_evidence).abs() < scorer.frame.rules.indistinguishable)
        .take(MOST)
        .collect();
    let kinds = |s: &ScoredSet<MotionFit>| -> Vec<String> {
        let family = |&c: &usize| scorer.candidates[c].family().to_owned();
        s.set.iter().map(family).collect()
    };
    let rest = match verdict {
        Verdict::BelowDetectability => empty.into_iter().collect(),
        Verdict::Unknown if close.is_empty() => {
            let other_kind = others().find(|s| kinds(s) != kinds(nearest));
            other_kind.or(empty).into_iter().collect()
        }
        Verdict::Named | Verdict::Unknown | Verdict::None => close,
    };
    std::iter::once(nearest).chain(rest).collect()
}

/// Returns the measurement that separates most; `None` if no measurement is worth its effort.
fn best_of(scorer: &MotionScorer, list: &[&ScoredSet<MotionFit>]) -> Option<MeasurementEvidence> {
    let frame = scorer.frame;
    let known: Vec<ParameterInformation> = list
        .iter()
        .map(|s| ParameterInformation::from_fit(frame, &s.fit))
        .collect();
    let mut best: Option<MeasurementEvidence> = None;
    for measurement in measurements(frame, known.first()?.fit) {
        if scorer.is_stopped() {
            return None;
        }
        let seen: Vec<Option<View>> = known
            .iter()
            .map(|k| view(frame, &measurement, k, &scorer.background))
            .collect();
        let between = |a: usize, b: usize| -> f64 {
            let (Some(truth), Some(other)) = (&seen[a], &seen[b]) else {
                return 0.0;
            };
            expected_evidence(&known[b], other, truth).unwrap_or(0.0)
        };
        let worth: Vec<f64> = (1..known.len())
            .map(|k| between(0, k).min(between(k, 0)))
            .collect();
        let weighed = MeasurementEvidence { measurement, worth };
        let better = |b: &MeasurementEvidence| weighed.rank() > b.rank();
        if weighed.rank().0 > 0 && best.as_ref().is_none_or(better) {
            best = Some(weighed);
        }
        if best.as_ref().is_some_and(MeasurementEvidence::is_sure) {
            break;
        }
    }
    best
}

fn name(scorer: &MotionScorer, s: &ScoredSet<MotionFit>) -> String {
    let ids: Vec<&str> = (s.set.iter())
        .map(|&c| scorer.candidates[c].id.as_str())
        .collect();
    match ids.is_empty() {
        true => AS_IT_IS.into(),
        false => ids.join(" + "),
    }
}
