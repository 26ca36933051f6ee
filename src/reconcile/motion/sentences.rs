//! Text on the remaining gap.

use super::gap::{Proof, RecordGap};
use super::sits::gap_sits;
use crate::reconcile::outcome::Verdict;
use crate::reconcile::rules::MotionRules;

/// Returns a text on the remaining gap and its place. `chi` and `left` are before, after (and floor), `remarks` the reasons against naming effects.
pub(super) fn remains(
    rules: &MotionRules,
    verdict: Verdict,
    chi: [f64; 2],
    left: [f64; 3],
    proof: Proof,
    gap: Option<&RecordGap>,
    remarks: &[String],
) -> String {
    let worst = gap.and_then(|g| gap_sits(g).into_iter().next());
    let place = worst.map_or_else(String::new, |w| format!(" Largest in {}.", w.words()));
    let noise = rules.noise_factor * rules.noise_factor;
    let state = match verdict {
        Verdict::Named if chi[1] < noise => "The residual is at the noise floor of the sensors.",
        Verdict::None | Verdict::BelowDetectability if chi[0] < noise => {
            "Model and record agree within sensor noise."
        }
        Verdict::Unknown => "A gap remains that no effect of the library explains.",
        _ => {
            "The residual exceeds sensor noise. The declared tolerances explain a residual of this size in one of 100 cases."
        }
    };
    let proof_words = match proof {
        Proof::HeldOut => String::new(),
        p => format!(
            " The job has no `hold_out` record: the stated gaps are gaps of {}.",
            p.words()
        ),
    };
    let remarks: String = remarks.iter().map(|t| format!(" {t}.")).collect();
    format!(
        "{state}{remarks} Residual on the fitted record: {:.2} % of the measured quantity, noise and tolerances {:.2} %.{place}{proof_words}",
        100.0 * left[1],
        100.0 * left[2]
    )
}
