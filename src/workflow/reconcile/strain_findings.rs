//! Findings on a gap of strain.

use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity};
use crate::host::work::Work;
use crate::reconcile::{Outcome, SmoothAt, Verdict};
use crate::units::number;

/// Gap over readings, and over its floor, from which numbers are in another unit: the model makes ten times what was read, and no effect of
/// the library does that.
const OTHER_UNIT: f64 = 10.0;

/// The finding on a model that makes far more than was read.
fn far_above_readings(outcome: &Outcome) -> Option<Finding> {
    let gap = &outcome.gap;
    let far = gap.before > OTHER_UNIT && gap.before > OTHER_UNIT * gap.floor;
    far.then(|| {
        Finding::new(
            Severity::Error,
            "model-far-above-readings",
            "runs",
            format!(
                "the noted loads and payloads make {} times the strain that was read: a column of the runs file, or the readings, are in \
                 another unit, and no effect found here means anything",
                number(gap.before)
            ),
            "state the units of the runs file: [runs] units = { force = \"N\" }, or beside a column's name; readings count in microstrain",
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
    work.findings.extend(far_above_readings(outcome));
    if outcome.noise_factor > NOISE_KNOWN {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "noise-above-stated",
                "measured.noise_microstrain",
                format!("the readings scatter {:.2} times as much as their stated noise allows, alike at all gauges", outcome.noise_factor),
                "find what scatters (repeat a run three times), or state the noise that the repeats show",
            )
            .with_numbers(outcome.noise_factor, NOISE_KNOWN),
        );
    }
    if !outcome.smooth.is_empty() {
        work.findings.push(smooth(outcome));
    }
    match outcome.verdict {
        Verdict::Unknown => work.findings.push(
            Finding::new(
                Severity::Warning,
                "gap-unexplained",
                "model",
                format!(
                    "there is a gap, and no effect of the library is named for it: {}",
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
                    "; the smallest that would be seen: {:.3} {}",
                    d.size, d.unit
                )
            });
            work.findings.push(Finding::new(
                Severity::Info,
                "below-detectability",
                hint,
                format!(
                    "a hint of an effect, too small to name{}",
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
                        "explains these data as well as what was named: where this is what is wrong, loads unlike those of these runs are \
                         recovered wrong by a model that holds what was named",
                        outcome.next_measurement.clone(),
                    )
                    .with_numbers(r.evidence_difference, 3.0),
                );
            }
            for l in outcome.loads.iter().filter(|l| l.moved()) {
                work.findings.push(
                    Finding::new(
                        Severity::Info,
                        "load-moved",
                        format!("{} in {}", l.load, l.run),
                        format!(
                            "the recovered load moves from {:.2} to {:.2} {} with the effect in",
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

/// The curve in words: from the least factor to the greatest.
fn smooth(outcome: &Outcome) -> Finding {
    let by_factor = |a: &&SmoothAt, b: &&SmoothAt| a.factor.total_cmp(&b.factor);
    let at = |s: Option<&SmoothAt>| {
        s.map_or(String::new(), |s| {
            let load = s
                .load
                .as_ref()
                .map_or(String::new(), |l| format!(" under {l}"));
            format!(
                "{:.3} +- {:.3} at {}{load}",
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
            "the model is off by a factor that changes smoothly from place to place, from {} to {}: no single effect explains these runs clearly better",
            at(outcome.smooth.iter().min_by(by_factor)),
            at(outcome.smooth.iter().max_by(by_factor)),
        ),
        "compare mesh, sections, supports and load paths with the structure where the factor leaves one, or add gauges between these places",
    )
    .with_numbers(farthest, 0.0)
}
