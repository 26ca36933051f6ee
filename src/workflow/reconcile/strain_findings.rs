//! Findings on a gap of strain.

use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity};
use crate::host::work::Work;
use crate::reconcile::{Outcome, SmoothAt, Verdict};
use crate::units::number;

/// Gap over readings, and gap over expected residual, above which numbers are in another unit. The model then gives ten times the readings, and no
/// effect of the library does that.
const OTHER_UNIT: f64 = 10.0;

/// Returns the finding on a model that gives far more strain than the readings. No effect is named then.
pub(super) fn far_above_readings(outcome: &Outcome) -> Option<Finding> {
    let gap = &outcome.gap;
    let far = gap.before > OTHER_UNIT && gap.before > OTHER_UNIT * gap.floor;
    far.then(|| {
        Finding::new(
            Severity::Error,
            "model-far-above-readings",
            "runs",
            format!(
                "the recorded loads and payloads give {} times the measured strain: a column of the runs file, or the readings, are in \
                 another unit, and no effect is named",
                number(gap.before)
            ),
            "state the units of the runs file, [runs] units = { force = \"N\" } or after a column\'s name; readings are in microstrain",
        )
        .with_numbers(gap.before, OTHER_UNIT)
    })
}

/// Adds the findings on the verdict.
pub(super) fn findings(work: &mut Work, outcome: &Outcome) {
    /// Factor on the stated noise above which the noise of the readings is reported. A stated noise is known to 15 %.
    const NOISE_KNOWN: f64 = 1.15;
    if !outcome.input_faults.is_empty() {
        work.findings.extend(outcome.input_faults.iter().cloned());
        return;
    }
    if outcome.noise_factor > NOISE_KNOWN {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "noise-above-stated",
                "measured.noise_microstrain",
                format!("the readings scatter {:.2} times as much as their stated noise allows, equally at all gauges", outcome.noise_factor),
                "find the cause of the scatter (repeat a run three times), or state the noise that the repeats show",
            )
            .with_numbers(outcome.noise_factor, NOISE_KNOWN),
        );
    }
    if !outcome.smooth.is_empty() {
        work.findings.push(smooth_curve_finding(outcome));
    }
    match outcome.verdict {
        Verdict::Unknown => work.findings.push(
            Finding::new(
                Severity::Warning,
                "gap-unexplained",
                "model",
                format!(
                    "the model has a gap, and no effect of the library explains it: {}",
                    outcome.remains
                ),
                outcome.next_measurement.clone(),
            )
            .with_numbers(outcome.reduced_chi2[1], 1.0),
        ),
        Verdict::BelowDetectability => {
            let hint = outcome
                .rivals
                .first()
                .map(|r| r.ids.join(" + "))
                .unwrap_or_default();
            let size = outcome.detectable.iter().find(|d| d.id == hint).map(|d| {
                format!(
                    "; the smallest size that would be seen: {:.3} {}",
                    d.size, d.unit
                )
            });
            work.findings.push(Finding::new(
                Severity::Info,
                "below-detectability",
                hint,
                format!(
                    "the readings indicate an effect that is too small to identify{}",
                    size.unwrap_or_default()
                ),
                outcome.next_measurement.clone(),
            ));
        }
        Verdict::Named => {
            for r in outcome.rivals.iter().filter(|r| r.indistinguishable) {
                work.findings.push(
                    Finding::new(
                        Severity::Warning,
                        "rival",
                        r.ids.join(" + "),
                        "this alternative fits the data equally well. If it is the true cause, the extended model gives wrong loads for \
                         other load cases",
                        outcome.next_measurement.clone(),
                    )
                    .with_numbers(r.evidence_difference, 3.0),
                );
            }
            for l in outcome.loads.iter().filter(|l| l.is_significant()) {
                work.findings.push(
                    Finding::new(
                        Severity::Info,
                        "load-changed-by-effect",
                        format!("{} in {}", l.load, l.run),
                        format!(
                            "with the effect, the recovered load changes from {:.2} to {:.2} {}",
                            l.before, l.after, l.unit
                        ),
                        "use the extended model",
                    )
                    .with_numbers((l.after - l.before).abs(), 2.0 * l.sigma),
                );
            }
        }
        Verdict::None => {}
    }
}

/// Returns the finding on the curve, from the smallest to the largest factor.
fn smooth_curve_finding(outcome: &Outcome) -> Finding {
    let by_factor = |a: &&SmoothAt, b: &&SmoothAt| a.factor.total_cmp(&b.factor);
    let at = |s: Option<&SmoothAt>| {
        s.map_or(String::new(), |s| {
            let load = s
                .load
                .as_ref()
                .map_or(String::new(), |l| format!(" under {l}"));
            format!(
                "{:.3} ± {:.3} at {}{load}",
                s.factor,
                NORMAL_95 * s.sd,
                s.gauge
            )
        })
    };
    let farthest = (outcome.smooth.iter())
        .map(|s| (s.factor - 1.0).abs())
        .fold(0.0, f64::max);
    Finding::new(
        Severity::Warning,
        "smooth",
        "model",
        format!(
            "the model is wrong by a factor that changes smoothly with position, from {} to {}: no single effect explains these runs clearly better",
            at(outcome.smooth.iter().min_by(by_factor)),
            at(outcome.smooth.iter().max_by(by_factor)),
        ),
        "where the factor differs from 1, compare mesh, sections, supports and load paths with the structure, or add gauges between these places",
    )
    .with_numbers(farthest, 0.0)
}
