//! Whether the time of a record can be in seconds, and whether it is even.

use crate::finding::{Finding, Severity};
use crate::series::record::{Clock, EVEN, Evenness, TimeUnit, USUAL_RATES_HZ, is_usual};
use crate::units::number;

/// Step, s, above which a record is slower than any logger of varying loads (2 Hz). If the step is really in milliseconds, half a millisecond is a
/// logger of 2 kHz.
const SLOW: f64 = 0.5;
/// Least number of samples of a record. Fewer samples may be readings recorded by hand.
const ENOUGH: usize = 200;
/// Mean square of the change between samples, over the variance, below which the signal is much slower than the logger. Independent samples give 2. A
/// slow signal is not usually logged with a step of seconds.
///
/// # Reference
/// J. von Neumann, Ann. Math. Stat. 12 (1941) 367.
const SMOOTH: f64 = 0.5;

/// Returns findings on uneven steps, missing samples and a unit of time that only the size of the times shows. They do not stop a record.
pub fn check_time_steps(subject: &str, clock: &Clock) -> Vec<Finding> {
    let mut out = Vec::new();
    out.extend(
        clock
            .unit
            .map(|unit| report_assumed_unit(subject, unit, clock.rate_hz)),
    );
    if let Evenness::Resampled { largest, .. } = clock.evenness {
        let rate = clock.rate_hz;
        let differ = match clock.change {
            Some(change) => change.words(),
            None => format!("the time steps differ by up to {:.0} %", 100.0 * largest),
        };
        out.push(
            Finding::new(
                Severity::Warning,
                "record-resampled",
                subject,
                format!("{differ}: samples are interpolated to {rate:.6} Hz"),
                "record with a steady clock if peaks of the loads matter",
            )
            .with_numbers(largest, EVEN),
        );
    }
    if clock.n_gaps > 0 {
        let first = clock.gaps.first().map_or(0.0, |g| g.from_s);
        out.push(
            Finding::new(
                Severity::Warning,
                "record-gaps",
                subject,
                format!(
                    "{} samples are missing in {} gaps, the first after {first} s: they remain blank",
                    clock.missing, clock.n_gaps
                ),
                "check the logger",
            )
            .with_numbers(clock.missing as f64, 0.0),
        );
    }
    out
}

/// Returns the note that times are taken in a unit that the file does not state.
pub fn report_assumed_unit(subject: &str, unit: TimeUnit, rate_hz: f64) -> Finding {
    let words = unit.words();
    Finding::new(
        Severity::Info,
        "time-unit-recognised",
        subject,
        format!(
            "The file states no unit of time. Its times are taken as {words}: {rate_hz:.6} Hz."
        ),
        "Nothing; state the unit in the header, such as `time [ms]`, if this is wrong.",
    )
}

/// Returns the error of a rate, Hz, that records do not have, for times without a stated unit.
pub fn check_rate(rate_hz: f64) -> Option<Finding> {
    if is_usual(rate_hz) {
        return None;
    }
    let [slowest, fastest] = USUAL_RATES_HZ;
    let (found, limit) = match rate_hz < slowest {
        true => (
            format!("a sample every {} s", number(1.0 / rate_hz)),
            slowest,
        ),
        false => (format!("{} samples a second", number(rate_hz)), fastest),
    };
    Some(
        Finding::new(
            Severity::Error,
            "time-unit-doubtful",
            "time",
            format!(
                "{found}: the file states no unit of time, and its times in seconds give a rate outside {slowest} to {fastest} Hz. Sample \
                 rate, duration and all frequencies depend on the unit"
            ),
            "state the unit in the header, such as `time [ms]`, or as [measured] time_unit",
        )
        .with_numbers(rate_hz, limit),
    )
}

/// Returns an error for times that are in milliseconds and not in seconds. This is the case if records do not have such a rate. It is also the case
/// if consecutive readings `step_s` apart are as close as the readings of a fast logger. `readings` are from one piece of the record, with `n` gauges
/// for each sample.
pub fn check(step_s: f64, readings: &[f64], n: usize) -> Option<Finding> {
    if let Some(found) = check_rate(1.0 / step_s) {
        return Some(found);
    }
    let samples = readings.len() / n.max(1);
    if !(step_s >= SLOW) || samples < ENOUGH {
        return None;
    }
    let ratio = (0..n)
        .filter_map(|g| steps_over_variance(readings.iter().skip(g).step_by(n)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?
        .0;
    (ratio < SMOOTH).then(|| {
        Finding::new(
            Severity::Error,
            "time-unit-doubtful",
            "time",
            format!(
                "a sample every {} s, and consecutive readings differ as little as at a sample rate 1000 times as high: `time` may be in milliseconds. Sample \
                 rate, duration and all frequencies depend on the unit",
                number(step_s)
            ),
            "state the unit: [measured] time_unit = \"ms\", or \"s\" if the times are seconds",
        )
        .with_numbers(step_s, SLOW)
    })
}

/// Returns the mean square of the steps divided by the variance, and the variance. `None` if the values are constant.
fn steps_over_variance<'a>(values: impl Iterator<Item = &'a f64>) -> Option<(f64, f64)> {
    let v: Vec<f64> = values.copied().filter(|v| v.is_finite()).collect();
    let mean = v.iter().sum::<f64>() / v.len().max(1) as f64;
    let variance: f64 = v.iter().map(|x| (x - mean) * (x - mean)).sum();
    let steps: f64 = v
        .iter()
        .zip(v.iter().skip(1))
        .map(|(a, b)| (b - a) * (b - a))
        .sum();
    (variance > 0.0).then(|| (steps / variance, variance))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a sine of `period` samples.
    fn wave(period: f64) -> Vec<f64> {
        (0..600)
            .map(|i| (std::f64::consts::TAU * i as f64 / period).sin())
            .collect()
    }

    #[test]
    fn milliseconds_are_asked_for_where_two_seconds_apart_samples_follow_each_other() {
        let found = check(2.0, &wave(100.0), 1).expect("a finding");
        assert_eq!(found.severity, Severity::Error);
        assert!(check(0.5, &wave(100.0), 1).is_some(), "2 kHz");
    }

    #[test]
    fn a_fast_record_and_a_few_static_rows_are_let_be() {
        assert_eq!(check(0.002, &wave(100.0), 1), None);
        // Independent rows.
        assert_eq!(check(2.0, &wave(2.3), 1), None);
        assert_eq!(check(1.0, &wave(100.0)[..50], 1), None);
    }

    #[test]
    fn a_rate_that_no_record_has_is_doubtful_however_few_samples_there_are() {
        for step_s in [10.0, 5.1, 9e-6, 1e-7] {
            let found = check(step_s, &wave(2.3)[..4], 1).expect("a finding");
            assert_eq!(found.code, "time-unit-doubtful");
        }
        for step_s in [5.0, 1e-5] {
            assert_eq!(check(step_s, &wave(2.3)[..4], 1), None, "{step_s}");
        }
    }
}
