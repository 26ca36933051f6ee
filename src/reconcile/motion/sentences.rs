//! What remains, and what to measure next, in words.

use super::floor::NOISE_FACTOR;
use super::gap::{Proof, RecordGap};
use super::scorer::MotionScorer;
use super::sits::gap_sits;
use crate::reconcile::outcome::{Rival, Verdict};

/// What remains and where it sits; `chi` and `left` are before, after (and floor).
pub(super) fn remains(
    verdict: Verdict,
    chi: [f64; 2],
    left: [f64; 3],
    proof: Proof,
    gap: Option<&RecordGap>,
) -> String {
    let worst = gap.and_then(|g| gap_sits(g).into_iter().next());
    let place = worst.map_or_else(String::new, |w| format!(" Largest in {}.", w.words()));
    let noise = NOISE_FACTOR * NOISE_FACTOR;
    let state = match verdict {
        Verdict::Named if chi[1] < noise => "What is left is at the floor of sensor noise.",
        Verdict::None | Verdict::BelowDetectability if chi[0] < noise => {
            "Model and record agree within sensor noise."
        }
        Verdict::Unknown => "A gap remains that nothing in the library explains.",
        _ => {
            "What is left is above sensor noise, within what the declared tolerances leave in one complete model of a hundred."
        }
    };
    let judged = match proof {
        Proof::HeldOut => String::new(),
        p => format!(
            " There is no `hold_out` to judge by: gaps are those of {}.",
            p.words()
        ),
    };
    format!(
        "{state} Left on the fitted record: {:.2} % of the measured quantity, noise and tolerances {:.2} %.{place}{judged}",
        100.0 * left[1],
        100.0 * left[2]
    )
}

/// What would separate the first two explanations.
pub(super) fn next_measurement(
    scorer: &MotionScorer,
    verdict: Verdict,
    rivals: &[Rival],
) -> String {
    let close: Vec<&Rival> = rivals.iter().filter(|r| r.indistinguishable).collect();
    let channel = |r: &&Rival| {
        r.ids.iter().all(|id| {
            scorer
                .candidates
                .iter()
                .any(|c| c.id == *id && c.is_channel())
        })
    };
    match (verdict, close.first()) {
        (Verdict::Named, Some(r)) if channel(r) => format!(
            "Turn the accelerometers over (2 g) or tap all of them at once: that tells it from {}.",
            r.ids.join(" + ")
        ),
        (Verdict::Named, Some(r)) => format!(
            "Drive a rougher and a smoother road: {} scales with amplitude in another way.",
            r.ids.join(" + ")
        ),
        (Verdict::Named, None) => "None needed; another road would confirm it.".into(),
        (Verdict::Unknown, _) => {
            "Measure what the model leaves out: the other side and axle, spring travel, a second accelerometer on each body.".into()
        }
        _ => "A rougher road or longer record would show smaller effects.".into(),
    }
}
