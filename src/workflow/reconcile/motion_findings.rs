//! Findings on a gap of motion.

use crate::finding::{Finding, Severity};
use crate::host::work::Work;
use crate::reconcile::Verdict;
use crate::reconcile::motion::MotionOutcome;
use crate::reconcile::motion::gap::Proof;
use crate::units::number;

/// Ratio of noise and tolerances to the measured quantity above which model and record are not compared.
const DROWNED: f64 = 1.0;

/// Adds the findings on the verdict.
pub(super) fn findings(work: &mut Work, outcome: &MotionOutcome) {
    if outcome.verdict == Verdict::Unknown {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "gap-unexplained",
                "model",
                format!(
                    "No effect of the library explains the gap. {}",
                    outcome.remains
                ),
                outcome.next_measurement.clone(),
            )
            .with_numbers(outcome.reduced_chi2[1], 1.0),
        );
    }
    let floor = outcome.gap.floor;
    if floor >= DROWNED {
        work.findings.push(
            Finding::new(
                Severity::Error,
                "readings-below-noise",
                "vehicle.data",
                format!(
                    "The stated noise and tolerances are {} times the measured quantity: model and record cannot be compared. The assumed \
                     unit of a channel is wrong, the stated noise is too large, or the vehicle did not move.",
                    number(floor)
                ),
                "State the unit after the name of the channel, `f_wheel [kN]`, or the noise of the sensors.",
            )
            .with_numbers(floor, DROWNED),
        );
    }
    let is_reported = work.findings.iter().any(|f| f.code == "no-hold-out");
    if outcome.judged_by != Proof::HeldOut && !is_reported {
        work.findings.push(Finding::new(
            Severity::Warning,
            "no-hold-out",
            "vehicle.hold_out",
            format!(
                "The job has no `hold_out` record: the stated gaps are gaps of {}.",
                outcome.judged_by.words()
            ),
            "Name a record of another stretch of road as `hold_out` in [vehicle].",
        ));
    }
    if outcome.verdict == Verdict::BelowDetectability
        && let Some(hint) = outcome.rivals.first()
    {
        let sizes: Vec<String> = outcome
            .smallest
            .iter()
            .filter(|s| hint.ids.contains(&s.id))
            .map(|s| format!("`{}` {:.3e} {}", s.id, s.size, s.unit))
            .collect();
        work.findings.push(
            Finding::new(
                Severity::Info,
                "below-detectability",
                hint.ids.join(" + "),
                format!(
                    "The record indicates an effect that is too small to identify. The smallest size that would be identified: {}.",
                    sizes.join(", ")
                ),
                outcome.next_measurement.clone(),
            )
            .with_numbers(-hint.evidence_difference, outcome.decisive),
        );
    }
    if outcome.verdict == Verdict::Named {
        for r in outcome.rivals.iter().filter(|r| r.indistinguishable) {
            work.findings.push(
                Finding::new(
                    Severity::Warning,
                    "rival",
                    r.ids.join(" + "),
                    "This alternative fits the data equally well. If it is the true cause, the parameters of the extended model are wrong.",
                    outcome.next_measurement.clone(),
                )
                .with_numbers(r.evidence_difference, 3.0),
            );
        }
    }
}
