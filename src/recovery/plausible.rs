//! Readings that can't be strain in the unit they are taken for.

use super::errors::ErrorModel;
use super::types::Readings;
use crate::finding::{Finding, Severity, few};
use crate::sensitivity::Sensitivity;
use crate::units::MICROSTRAIN;

/// Strain that no reading exceeds: gauges for large elongation end at a fifth of it, and metals break before.
pub const LARGEST_STRAIN: f64 = 1.0;
/// Root mean square of all readings, in noise sd, below which they can't be readings of a gauge with that noise: of `n` readings of
/// noise alone it is 1 +- 0.7 / sqrt(n).
const TOO_QUIET: f64 = 0.3;
/// Strain that no amplifier resolves: readings that are all smaller are not in the unit they are taken for.
const UNRESOLVED: f64 = 1e-3 * MICROSTRAIN;
/// Readings from which their root mean square says that: eight of noise alone are so quiet once in 1,900 jobs (chi-square below 0.72).
const FEW: usize = 8;

/// The readings without those that are no strain, and findings on them.
pub fn check(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
) -> (Vec<Readings>, Vec<Finding>) {
    let mut readings = readings.to_vec();
    let mut largest = vec![0.0_f64; s.gauges.len()];
    let mut findings = Vec::new();
    for r in &mut readings {
        for (v, most) in r.strain.iter_mut().zip(&mut largest) {
            if v.abs() > LARGEST_STRAIN {
                *most = most.max(v.abs());
                *v = f64::NAN;
            }
        }
    }
    let named = s.gauges.iter().zip(&largest).filter(|(_, v)| **v > 0.0);
    let names: Vec<&str> = named.map(|(g, _)| g.as_str()).collect();
    if let Some(finding) = impossible(&names, largest.iter().copied().fold(0.0, f64::max)) {
        findings.push(finding);
    }
    findings.extend(too_quiet(&readings, errors));
    (readings, findings)
}

/// The finding on readings too large to be strain; `None` without gauges.
pub fn impossible(gauges: &[&str], largest: f64) -> Option<Finding> {
    (!gauges.is_empty()).then(|| {
        Finding::new(
            Severity::Error,
            "reading-impossible",
            few(gauges),
            format!(
                "readings of up to {:.1e} microstrain are no strain: they are taken for no reading",
                largest / MICROSTRAIN
            ),
            "check the unit (microstrain is expected), the channel's overload, and the file",
        )
        .with_numbers(largest / MICROSTRAIN, LARGEST_STRAIN / MICROSTRAIN)
    })
}

/// The finding on so many readings of a record that are too large to be strain.
pub fn impossible_in_record(subject: &str, n: u64) -> Finding {
    Finding::new(
        Severity::Error,
        "reading-impossible",
        subject,
        format!("{n} readings are too large to be strain: they are taken for no reading"),
        "check the unit (microstrain is expected), the channel's overload, and the file",
    )
    .with_numbers(n as f64, 0.0)
}

/// Readings that all stay below the noise stated for them.
fn too_quiet(readings: &[Readings], errors: ErrorModel) -> Option<Finding> {
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
    let unresolved = n > 0 && largest < UNRESOLVED;
    (quiet || unresolved).then(|| {
        Finding::new(
            Severity::Error,
            "readings-below-noise",
            "measured.strain",
            format!(
                "no reading stands out of the noise: the largest is {:.1e} microstrain, the noise stated is {} microstrain. The unit of \
                 the readings is not microstrain, or nothing acted, or the logger gave nothing",
                largest / MICROSTRAIN,
                errors.noise / MICROSTRAIN
            ),
            "state readings in microstrain (strain times 1e6), or the noise that these gauges have",
        )
        .with_numbers(rms, TOO_QUIET)
    })
}
