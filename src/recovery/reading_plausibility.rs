//! Readings that cannot be strain in their assumed unit.

use super::errors::ErrorModel;
use super::types::Readings;
use crate::estimate::median;
use crate::finding::{Finding, Severity, list_few};
use crate::units::{MICROSTRAIN, number};

/// Strain that no reading can exceed. Gauges for large elongation end at a fifth of this strain, and metals break earlier.
pub const LARGEST_STRAIN: f64 = 1.0;
/// Strain beyond the range of gauges on a structure. Foil gauges measure up to 3 to 5 %, gauges for tests beyond yield up to 10 to 20 %. S is valid
/// for small strain only. Larger readings are kept with a finding: either one channel is overloaded, or a part yields.
///
/// # Reference
/// Micro-Measurements, Tech Note TN-505, Strain Gage Selection, strain range by gauge series (EA 3 to 5 %, EP 10 to 20 %).
pub const GAUGES_END: f64 = 0.05;
/// Strain at which every metal of a structure is broken: S355 breaks at 22 %, EN AW-6082-T6 at 8 to 10 %. Gauges for the largest elongation do not
/// measure more either. Readings beyond it are not strain of the structure.
///
/// # Reference
/// EN 10025-2 (2019), table 7; EN 755-2 (2016).
const METAL_ENDS: f64 = 0.2;
/// Limit of strain. If half of the readings exceed it, their unit is wrong. Metals yield at 0.1 to 0.5 %, and the linear S is not valid beyond yield.
const MOST_BELOW: f64 = 0.01;
/// Root mean square of all readings, in noise sd, below which they can't be from gauges with the stated noise. For `n` readings of noise alone it is
/// 1 +- 0.7 / sqrt(n).
const TOO_QUIET: f64 = 0.3;
/// Strain below the resolution of amplifiers. If all readings are smaller, their unit is wrong.
const UNRESOLVED: f64 = 1e-3 * MICROSTRAIN;
/// Smallest number of readings for the test against `TOO_QUIET`: eight readings of noise alone are so quiet once in 1,900 jobs (chi-square below
/// 0.72).
const FEW: usize = 8;

/// Replaces readings that cannot be strain by NaN, and returns findings on readings. Every command applies this test to its strain. The zero is
/// subtracted from the readings, which are in the order of `gauges`.
pub fn check(
    gauges: &[String],
    readings: &[Readings],
    errors: ErrorModel,
) -> (Vec<Readings>, Vec<Finding>) {
    let mut readings = readings.to_vec();
    let (mut impossible_of, mut beyond_of) = (vec![0.0_f64; gauges.len()], vec![0.0; gauges.len()]);
    for r in &mut readings {
        let most = impossible_of.iter_mut().zip(&mut beyond_of);
        for (v, (impossible, beyond)) in r.strain.iter_mut().zip(most) {
            if v.abs() > LARGEST_STRAIN {
                *impossible = impossible.max(v.abs());
                *v = f64::NAN;
            } else if v.abs() > GAUGES_END {
                *beyond = v.abs().max(*beyond);
            }
        }
    }
    let named = |largest: &[f64]| -> (Vec<&str>, f64) {
        let some = gauges.iter().zip(largest).filter(|(_, v)| **v > 0.0);
        let names = some.map(|(g, _)| g.as_str()).collect();
        (names, largest.iter().copied().fold(0.0, f64::max))
    };
    let mut findings = Vec::new();
    let (names, largest) = named(&impossible_of);
    findings.extend(report_impossible_readings(&names, largest));
    let (names, largest) = named(&beyond_of);
    findings.extend(beyond_gauges(&names, largest, median_size(&readings)));
    findings.extend(too_quiet(&readings, errors, UNRESOLVED));
    (readings, findings)
}

/// Returns findings on readings that can only be compared with their noise, for example if S is estimated from these readings alone. Any signal in
/// any unit is accepted if it exceeds the stated noise.
pub fn check_signal(readings: &[Readings], errors: ErrorModel) -> Vec<Finding> {
    too_quiet(readings, errors, 0.0).into_iter().collect()
}

/// Half of all readings are smaller, signs dropped; 0 without readings.
fn median_size(readings: &[Readings]) -> f64 {
    let all = readings.iter().flat_map(|r| &r.strain);
    median(all.map(|v| v.abs()).filter(|v| v.is_finite()).collect()).unwrap_or(0.0)
}

/// The finding on readings beyond what gauges follow, half of which are below `median_size`; `None` without gauges.
fn beyond_gauges(gauges: &[&str], largest: f64, median_size: f64) -> Option<Finding> {
    let (severity, what, limit) = if largest > METAL_ENDS || median_size > MOST_BELOW {
        let what = "are beyond the elastic strain of a metal, for which S is valid: the unit of the readings is not microstrain, or the channel is overloaded";
        (Severity::Error, what, METAL_ENDS)
    } else {
        let what = "are beyond the range of strain gauges and of S: the channel is overloaded, or the part yields there";
        (Severity::Warning, what, GAUGES_END)
    };
    (!gauges.is_empty()).then(|| {
        Finding::new(
            severity,
            "reading-beyond-gauges",
            list_few(gauges),
            format!("readings of up to {} microstrain {what}", number(largest / MICROSTRAIN)),
            "state readings in microstrain (strain times 1e6); exclude an overloaded channel: [[correction]] ignore = true",
        )
        .with_numbers(largest / MICROSTRAIN, limit / MICROSTRAIN)
    })
}

/// Returns the finding on readings that are too large to be strain. `None` without gauges.
pub fn report_impossible_readings(gauges: &[&str], largest: f64) -> Option<Finding> {
    (!gauges.is_empty()).then(|| {
        Finding::new(
            Severity::Error,
            "reading-impossible",
            list_few(gauges),
            format!(
                "readings of up to {:.1e} microstrain cannot be strain: they are treated as missing",
                largest / MICROSTRAIN
            ),
            "check the unit (microstrain is expected), the channel's overload, and the file",
        )
        .with_numbers(largest / MICROSTRAIN, LARGEST_STRAIN / MICROSTRAIN)
    })
}

/// Returns the finding on a number of readings of a record that are too large to be strain.
pub fn impossible_in_record(subject: &str, n: u64) -> Finding {
    Finding::new(
        Severity::Error,
        "reading-impossible",
        subject,
        format!("{n} readings are too large to be strain: they are treated as missing"),
        "check the unit (microstrain is expected), the channel's overload, and the file",
    )
    .with_numbers(n as f64, 0.0)
}

/// Readings that all stay below the noise stated for them, or below what can be `resolved`.
fn too_quiet(readings: &[Readings], errors: ErrorModel, resolved: f64) -> Option<Finding> {
    let (mut sum, mut n, mut largest) = (0.0, 0_usize, 0.0_f64);
    for r in readings {
        let noise = errors.noise_variance(r.noise_factor);
        for v in r.strain.iter().filter(|v| v.is_finite()) {
            sum += v * v / noise;
            largest = largest.max(v.abs());
            n += 1;
        }
    }
    let rms = (sum / n.max(1) as f64).sqrt();
    let quiet = n >= FEW && errors.noise > 0.0 && rms < TOO_QUIET;
    let unresolved = n > 0 && largest < resolved;
    (quiet || unresolved).then(|| {
        Finding::new(
            Severity::Error,
            "readings-below-noise",
            "measured.strain",
            format!(
                "no reading exceeds the noise: the largest is {:.1e} microstrain, the stated noise is {} microstrain. The unit of the \
                 readings is not microstrain, or no load acted, or the logger recorded no signal",
                largest / MICROSTRAIN,
                number(errors.noise / MICROSTRAIN)
            ),
            "state readings in microstrain (strain times 1e6), or the actual noise of these gauges",
        )
        .with_numbers(rms, TOO_QUIET)
    })
}
