//! Findings of `payload`: refusals, wheels without contact, undetermined places, and gauges that are not used.

use super::model::Parts;
use super::stated_payload::REFUTED;
use super::task::Task;
use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity, list_few};
use crate::host::words::format_number;
use crate::host::work::Work;
use crate::input_faults::identical_columns::identical_readings;
use crate::measured::zero::subtract_and_test_zero;
use crate::payload::{PayloadRun, Place, Refusal, WeighSpec, WeighedRun, Weighing};
use crate::recovery::Readings;
use crate::units::MICROSTRAIN;

/// Width of the 95 % interval, as a share of the payload, above which the answer is too uncertain.
const VAGUE: f64 = 0.5;

/// Returns the reason of a refusal as text.
pub(super) fn words(task: &Task, refusal: &Refusal) -> String {
    let unit = task.job.report_units.force.name;
    match refusal {
        Refusal::Negative { force } => format!(
            "the readings give {} {unit}, and a payload cannot be negative",
            format_number(*force)
        ),
        Refusal::OutsideRegion { sigmas } => format!(
            "the computed place is {} standard deviations outside the region of the payload",
            format_number(*sigmas)
        ),
        Refusal::OutOfBalance {
            strain,
            wheels,
            sigmas,
        } => format!(
            "strain gives {} {unit} and the wheel forces give {} {unit}: they differ by {} standard deviations, so forces are not in balance",
            format_number(*strain),
            format_number(*wheels),
            format_number(*sigmas)
        ),
        Refusal::Undetermined => "the readings do not determine the weight".to_owned(),
    }
}

/// Returns the finding on a refused payload.
fn refusal_finding(task: &Task, run: &str, refusal: &Refusal) -> Finding {
    let (code, remedy) = match refusal {
        Refusal::Negative { .. } => (
            "payload-negative",
            "check the signs of gauges and wheel forces, the zero, and which run is the unloaded one",
        ),
        Refusal::OutsideRegion { .. } => (
            "payload-outside-region",
            "check `region`, signs and names of gauges, and whether another load than the payload acts",
        ),
        Refusal::OutOfBalance { .. } => (
            "payload-out-of-balance",
            "check scale and sign of the channels, the zero of both, and `use` only one of them",
        ),
        Refusal::Undetermined => (
            "payload-undetermined",
            "add gauges where the payload strains the structure, or measure wheel forces",
        ),
    };
    Finding::new(Severity::Error, code, run, words(task, refusal), remedy)
}

/// Reports wheels that carry no load under structure and payload together.
fn lift_off(work: &mut Work, task: &Task, parts: &Parts, run: &PayloadRun, r: &WeighedRun) {
    // Wheel forces from structure and payload together.
    let total: Vec<f64> = match (&parts.model.floor, run.reactions.is_empty()) {
        (Some(floor), true) => {
            let p = [r.force, r.force * r.shift[0], r.force * r.shift[1]];
            task.empty
                .iter()
                .enumerate()
                .map(|(w, e)| e + (0..3).map(|k| floor[(w, k)] * p[k]).sum::<f64>())
                .collect()
        }
        _ => task
            .empty
            .iter()
            .zip(&run.reactions)
            .map(|(e, r)| e + r)
            .collect(),
    };
    for (w, t) in total.iter().enumerate().filter(|t| *t.1 < 0.0) {
        work.findings.push(
            Finding::new(
                Severity::Error,
                "wheel-lifts-off",
                format!("{}: {}", r.run, task.wheels[w]),
                "this payload at this place lifts the wheel off the floor: the support of the structure differs from the model",
                "check the place of the payload, and the model's masses (`ballast`)",
            )
            .with_numbers(*t, 0.0),
        );
    }
}

/// Adds a warning if the readings do not determine a free place.
fn report_undetermined_place(work: &mut Work, spec: &WeighSpec, r: &WeighedRun) {
    let (axes, _) = r.ellipse();
    let room = spec.region.map_or(f64::INFINITY, |v| {
        (v[0][1] - v[0][0]).max(v[1][1] - v[1][0]) / 2.0
    });
    if axes[0] > room {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "place-not-determined",
                &r.run,
                "the 95 % region of the place is as large as the region of the payload: the readings do not determine it",
                "add gauges between the axles on both rails, or wheel forces",
            )
            .with_numbers(axes[0], room),
        );
    }
}

/// Moments of measured wheel forces against the place that the job states.
fn check_stated_place(
    work: &mut Work,
    task: &Task,
    spec: &WeighSpec,
    arms: &[[f64; 2]],
    run: &PayloadRun,
    r: &WeighedRun,
) {
    let sum: f64 = run.reactions.iter().sum();
    let at = [0, 1].map(|k| {
        run.reactions
            .iter()
            .zip(arms)
            .map(|(r, a)| r * a[k])
            .sum::<f64>()
            / sum
    });
    let sd = [0, 1].map(|k| {
        arms.iter()
            .map(|a| ((a[k] - at[k]) * spec.reaction_sigma / sum).powi(2))
            .sum::<f64>()
            .sqrt()
    });
    let worst = (0..2)
        .map(|k| (at[k] - r.shift[k]).abs() / sd[k])
        .fold(0.0, f64::max);
    if worst > REFUTED {
        let unit = task.job.report_units.length.name;
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "payload-place-differs",
                &r.run,
                format!(
                    "the moments of the wheel forces put the payload at {}, {} {unit}, not at the place in the job",
                    format_number(task.nominal[0] + at[0]),
                    format_number(task.nominal[1] + at[1])
                ),
                "correct the place, or let the payload be anywhere: position = \"free\"",
            )
            .with_numbers(worst, REFUTED),
        );
    }
}

/// Tests, as `recover` does, whether readings can be strain in their stated unit. Impossible readings become missing readings.
pub(super) fn readings(work: &mut Work, task: &Task, parts: &Parts, runs: &mut [PayloadRun]) {
    let (Some(measured), Some(prepared)) = (&task.job.measured, &parts.prepared) else {
        return;
    };
    let noise = measured.noise_microstrain * MICROSTRAIN;
    // This test uses one noise factor for a run: the mean over its gauges.
    let noise_factor = |r: &PayloadRun| {
        let factors = r.sigma.iter().map(|s| (s / noise).powi(2));
        let (sum, n) = factors
            .filter(|f| f.is_finite())
            .fold((0.0, 0.0_f64), |a, f| (a.0 + f, a.1 + 1.0));
        if n > 0.0 { sum / n } else { 1.0 }
    };
    let read: Vec<Readings> = runs
        .iter()
        .filter(|r| !r.strain.is_empty())
        .map(|r| Readings {
            run: r.run.clone(),
            strain: r.strain.clone(),
            noise_factor: noise_factor(r),
        })
        .collect();
    let gauges = &prepared.sensitivity.gauges;
    let of_gauge = |g: usize| read.iter().map(|r| r.strain[g]).collect();
    let columns: Vec<Vec<f64>> = (0..gauges.len()).map(of_gauge).collect();
    work.findings.extend(identical_readings(gauges, &columns));
    let kept = subtract_and_test_zero(work, measured, gauges, &read);
    let strained = runs.iter_mut().filter(|r| !r.strain.is_empty());
    for (run, kept) in strained.zip(kept) {
        run.strain = kept.strain;
    }
}

/// Reports the findings on every run, and on the gauges that are not used.
pub(super) fn findings(
    work: &mut Work,
    task: &Task,
    parts: &Parts,
    runs: &[PayloadRun],
    spec: &WeighSpec,
    weighing: &Weighing,
) {
    work.findings.extend(weighing.unlike.iter().cloned());
    for (r, run) in weighing.runs.iter().zip(runs) {
        if let Some(refusal) = &r.refused {
            work.findings.push(refusal_finding(task, &r.run, refusal));
            continue;
        }
        let wide = (r.interval[1] - r.interval[0]) / r.force;
        if r.interval[0] <= 0.0 {
            work.findings.push(
                Finding::new(
                    Severity::Warning,
                    "payload-uncertain",
                    &r.run,
                    format!(
                        "the readings do not distinguish a payload from an empty structure: it is at most {} {}, with 97.5 % probability",
                        format_number(r.interval[1]),
                        task.job.report_units.force.name
                    ),
                    "nothing, if the structure is empty; otherwise add gauges where the payload strains it, longer means, or wheel forces",
                )
                .with_numbers(r.force / r.sigma, NORMAL_95),
            );
        } else if wide > VAGUE {
            work.findings.push(
                Finding::new(
                    Severity::Warning,
                    "payload-uncertain",
                    &r.run,
                    "the 95 % interval is wider than half of the payload",
                    "add gauges where the payload strains the structure, longer means, or wheel forces",
                )
                .with_numbers(wide, VAGUE),
            );
        }
        lift_off(work, task, parts, run, r);
        if spec.place == Place::Free {
            report_undetermined_place(work, spec, r);
        } else if let (Some(arms), false) = (&parts.model.arms, run.reactions.is_empty()) {
            check_stated_place(work, task, spec, arms, run, r);
        }
    }
    let rejected: Vec<&str> = weighing
        .gauges
        .iter()
        .filter(|v| !v.used)
        .map(|v| v.name.as_str())
        .collect();
    if !rejected.is_empty() {
        // With most of the gauges left out, the answer comes from a few gauges that agree by chance.
        let most = 2 * rejected.len() > weighing.gauges.len();
        work.findings.push(
            Finding::new(
                if most { Severity::Error } else { Severity::Warning },
                "gauges-not-used",
                list_few(&rejected),
                "these gauges disagree with the others and are not used in the answer (reasons in by_gauge)",
                "check their wiring, place and sign; if they are the majority, check the place of the payload and the model",
            )
            .with_numbers(rejected.len() as f64, 0.0),
        );
    }
}
