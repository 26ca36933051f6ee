//! What samples of a record say together: runs, but for gaps. A gap blanks what it touches and no more.

use super::dynamic::Beyond;
use super::errors::ErrorModel;
use super::gain::Gain;
use super::misfit::Alternatives;
use super::missing::Missing;
use super::plausible;
use super::runs::{Order, recover_beyond};
use super::types::{Readings, Recovery};
use super::verdict::NOT_SOLVABLE;
use crate::finding::{Finding, Severity, few};
use crate::input_faults::Handling;
use crate::sensitivity::Sensitivity;

/// What recovery makes of samples of a record; samples in which no gauge gave anything say nothing, unless there are no others.
///
/// A sample whose gauges don't tell a load is blank there. Whether a load can be had is asked of the whole record ([`check_gaps`]), not of
/// the samples that happen to be looked at: `run-not-solvable` stays only where all gauges together don't tell a load, which is no gap.
pub fn recover_samples(s: &Sensitivity, samples: Vec<Readings>, errors: ErrorModel) -> Recovery {
    recover_samples_with_alternatives(s, samples, errors, (Vec::new(), &mut Vec::new))
}

/// The same where readings have errors beyond noise, by sample (none where `beyond` is empty), and gauges may be installed otherwise. The record is
/// recovered from all gauges, whatever contradicts the others.
pub fn recover_samples_with_alternatives(
    s: &Sensitivity,
    samples: Vec<Readings>,
    errors: ErrorModel,
    (beyond, alternatives): (Vec<Beyond>, &mut Alternatives),
) -> Recovery {
    let reads = |r: &Readings| r.strain.iter().any(|v| v.is_finite());
    let taken: Vec<bool> = samples.iter().map(reads).collect();
    let some = taken.contains(&true);
    let samples: Vec<Readings> = samples.into_iter().filter(|r| !some || reads(r)).collect();
    let beyond = beyond.into_iter().zip(taken);
    let beyond: Vec<Beyond> = beyond.filter(|(_, t)| !some || *t).map(|b| b.0).collect();
    let mut recovery = recover_beyond(
        s,
        &samples,
        errors,
        (&beyond, Order::Samples),
        (Handling::AsMeasured, alternatives),
    );
    if recovery.findings.iter().any(|f| f.code == NOT_SOLVABLE) && all_tell(s, errors, &recovery) {
        recovery.findings.retain(|f| f.code != NOT_SOLVABLE);
    }
    recovery
}

/// Whether all gauges together tell the loads that are asked for.
fn all_tell(s: &Sensitivity, errors: ErrorModel, recovery: &Recovery) -> bool {
    let all: Vec<usize> = (0..s.gauges.len()).collect();
    let wanted = (0..s.loads.len()).filter(|&l| s.loads[l].wanted);
    Gain::new(s, &all, errors, 1.0, &recovery.typical)
        .is_some_and(|gain| wanted.into_iter().all(|l| gain.is_seen(l)))
}

/// What is to be said of a record's gaps: that there are some, readings that are none, and loads that no sample tells, which is an error.
pub fn check_gaps(subject: &str, s: &Sensitivity, missing: &Missing) -> Vec<Finding> {
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
                    "in {} of {} samples some gauge gives nothing: their loads are those of the others, with wider intervals; in at least {blank} of them \
                     some load is blank",
                    missing.gaps,
                    missing.samples()
                ),
                "repair the channel, or leave its gauge out: [[correction]] ignore = true",
            )
            .with_numbers(missing.gaps as f64, 0.0),
        );
    }
    if missing.impossible > 0 {
        out.push(plausible::impossible_in_record(subject, missing.impossible));
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
            few(&unknown),
            "in no sample do the gauges that read tell these loads",
            "bring the silent gauges back, or drop these loads",
        ));
    }
    out
}
