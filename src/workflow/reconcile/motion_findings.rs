//! Findings on a gap of motion.

use crate::finding::{Finding, Severity};
use crate::host::work::Work;
use crate::reconcile::Verdict;
use crate::reconcile::motion::MotionOutcome;
use crate::reconcile::motion::gap::Proof;
use crate::units::number;

/// Share of the measured quantity that noise and tolerances leave, from which nothing is compared at all.
const DROWNED: f64 = 1.0;

/// Notes what is to be known of the verdict.
pub(super) fn findings(work: &mut Work, outcome: &MotionOutcome) {
    if outcome.verdict == Verdict::Unknown {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "gap-unexplained",
                "model",
                format!(
                    "There is a gap that nothing in the library closes. {}",
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
                    "The stated noise and tolerances leave {} times what was measured: model and record can't be compared. A channel is not in \
                     the unit that is taken, its noise is stated too large, or nothing moved.",
                    number(floor)
                ),
                "State the unit after the name of the channel, `f_wheel [kN]`, or the noise that the sensors have.",
            )
            .with_numbers(floor, DROWNED),
        );
    }
    let said = work.findings.iter().any(|f| f.code == "no-hold-out");
    if outcome.judged_by != Proof::HeldOut && !said {
        work.findings.push(Finding::new(
            Severity::Warning,
            "no-hold-out",
            "vehicle.hold_out",
            format!(
                "There is no `hold_out` to judge by: gaps are those of {}.",
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
                    "There is a hint, too small for this record to name. The smallest size that would have been named: {}.",
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
                    "Explains these data as well as what was named: where this is what is wrong, the parameters of a model that holds what was \
                     named are off.",
                    outcome.next_measurement.clone(),
                )
                .with_numbers(r.evidence_difference, 3.0),
            );
        }
    }
}
