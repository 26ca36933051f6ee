//! Recovers loads from the samples of a record. Each sample is a run, except for gaps: a missing reading affects only its own sample.

use super::dynamic::AddedCovariance;
use super::errors::ErrorModel;
use super::gain::Gain;
use super::misfit::Alternatives;
use super::missing_readings::MissingReadings;
use super::reading_plausibility;
use super::runs::{Order, recover_beyond};
use super::types::{Readings, Recovery};
use super::verdict::NOT_SOLVABLE;
use crate::finding::{Finding, Severity, list_few};
use crate::input_faults::FaultTreatment;
use crate::sensitivity::Sensitivity;

/// Recovers samples without further errors and alternatives.
pub fn recover_samples(s: &Sensitivity, samples: Vec<Readings>, errors: ErrorModel) -> Recovery {
    recover_samples_with_alternatives(s, samples, errors, (Vec::new(), &mut Vec::new))
}

/// Recovers the loads of samples of a record. Samples without any reading are dropped, unless all samples lack readings.
///
/// The loads that the gauges of a sample don't determine are blank in that sample. Whether a load can be recovered depends on the whole record
/// ([`check_gaps`]), not on the selected samples. `run-not-solvable` remains only if all gauges together don't determine a load: this is no gap.
///
/// Readings may have errors beyond noise, and gauges may be installed otherwise. `beyond` is by sample, or
/// empty. All gauges contribute to the record's loads, even if some contradict other gauges.
pub fn recover_samples_with_alternatives(
    s: &Sensitivity,
    samples: Vec<Readings>,
    errors: ErrorModel,
    (beyond, alternatives): (Vec<AddedCovariance>, &mut Alternatives),
) -> Recovery {
    let reads = |r: &Readings| r.strain.iter().any(|v| v.is_finite());
    let taken: Vec<bool> = samples.iter().map(reads).collect();
    let some = taken.contains(&true);
    let samples: Vec<Readings> = samples.into_iter().filter(|r| !some || reads(r)).collect();
    let beyond = beyond.into_iter().zip(taken);
    let beyond: Vec<AddedCovariance> = beyond.filter(|(_, t)| !some || *t).map(|b| b.0).collect();
    let mut recovery = recover_beyond(
        s,
        &samples,
        errors,
        (&beyond, Order::Samples),
        (FaultTreatment::AsMeasured, alternatives),
    );
    if recovery.findings.iter().any(|f| f.code == NOT_SOLVABLE)
        && determine_wanted_loads(s, errors, &recovery)
    {
        recovery.findings.retain(|f| f.code != NOT_SOLVABLE);
    }
    recovery
}

/// Returns whether all gauges together determine the wanted loads.
fn determine_wanted_loads(s: &Sensitivity, errors: ErrorModel, recovery: &Recovery) -> bool {
    let all: Vec<usize> = (0..s.gauges.len()).collect();
    let wanted = (0..s.loads.len()).filter(|&l| s.loads[l].wanted);
    Gain::new(s, &all, errors, 1.0, &recovery.typical)
        .is_some_and(|gain| wanted.into_iter().all(|l| gain.is_seen(l)))
}

/// Returns the findings on gaps of a record: their number, impossible readings, and, as an error, loads that no sample determines.
pub fn check_gaps(subject: &str, s: &Sensitivity, missing: &MissingReadings) -> Vec<Finding> {
    let mut out = Vec::new();
    if missing.gaps > 0 {
        let known = missing.known_in_gaps.iter().take(s.loads.len());
        let blank = missing.gaps - known.copied().min().unwrap_or(0).min(missing.gaps);
        out.push(
            Finding::new(
                Severity::Warning,
                "samples-with-gaps",
                subject,
                format!(
                    "in {} of {} samples at least one gauge has no reading. Loads of these samples are computed from the other gauges, with wider \
                     intervals. At least {blank} of these samples have a blank load",
                    missing.gaps,
                    missing.samples()
                ),
                "repair the channel, or exclude its gauge: [[correction]] ignore = true",
            )
            .with_numbers(missing.gaps as f64, 0.0),
        );
    }
    if missing.impossible > 0 {
        out.push(reading_plausibility::impossible_in_record(
            subject,
            missing.impossible,
        ));
    }
    let unknown: Vec<&str> = s
        .loads
        .iter()
        .zip(&missing.known_in_gaps)
        .filter(|(load, known)| load.wanted && missing.whole + **known == 0)
        .map(|(load, _)| load.name.as_str())
        .collect();
    if !unknown.is_empty() {
        out.push(Finding::new(
            Severity::Error,
            "loads-without-values",
            list_few(&unknown),
            "in no sample do the gauges with readings determine these loads",
            "repair the gauges without readings, or drop these loads",
        ));
    }
    out
}
