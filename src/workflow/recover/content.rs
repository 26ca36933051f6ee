//! Whether a history is slow enough for quasi-static recovery: its content against the first elastic mode of the structure as it is held.

use crate::fe::Support;
use crate::finding::{Finding, Severity};
use crate::series::content::content_hz;

/// Largest ratio of frequency content to first frequency. Inertia of elastic motion adds 1 / (1 - r^2) - 1 to the strain at the ratio r. This is an
/// eighth at one third.
const SHARE_OF_FIRST_MODE: f64 = 1.0 / 3.0;

/// Returns the highest frequency with content of every load, Hz. `pieces` contain samples of all loads in turn. `sigma` is the noise of each load.
pub(super) fn content_of_loads(
    pieces: &[Vec<f64>],
    sigma: &[f64],
    rate_hz: f64,
) -> Vec<Option<f64>> {
    let k = sigma.len();
    (0..k)
        .map(|l| {
            let of_load: Vec<Vec<f64>> = pieces
                .iter()
                .map(|p| {
                    let mut before = 0.0;
                    p.chunks_exact(k)
                        .map(|f| {
                            // A gap repeats the last value before it.
                            before = if f[l].is_finite() { f[l] } else { before };
                            before
                        })
                        .collect()
                })
                .collect();
            content_hz(&of_load, rate_hz, 2.0 * sigma[l] * sigma[l] / rate_hz)
        })
        .collect()
}

/// Describes the structure of the first mode and its support under the unit loads.
pub(super) fn structure(support: Support) -> String {
    match support.is_held() {
        true => format!("the structure {}", support.words()),
        false => "the free structure".to_owned(),
    }
}

/// Returns a warning for each load whose content exceeds the recovered frequencies.
pub(super) fn check_band(names: &[String], content: &[Option<f64>], up_to_hz: f64) -> Vec<Finding> {
    let beyond = names.iter().zip(content).filter_map(|(name, f)| {
        let f = f.filter(|f| *f > up_to_hz)?;
        let message = format!(
            "its content reaches {f:.2} Hz, above the limit of {up_to_hz} Hz: the recovered load does not contain faster changes"
        );
        let remedy = "raise `up_to_hz` of [dynamic], if the gauges determine the loads there";
        Some(
            Finding::new(
                Severity::Warning,
                "content-beyond-band",
                format!("load `{name}`"),
                message,
                remedy,
            )
            .with_numbers(f, up_to_hz),
        )
    });
    beyond.collect()
}

/// Returns a warning for each load whose content reaches a third of the first mode of `structure`.
pub(super) fn check_content(
    names: &[String],
    content: &[Option<f64>],
    first_mode: f64,
    structure: &str,
) -> Vec<Finding> {
    let limit = SHARE_OF_FIRST_MODE * first_mode;
    names
        .iter()
        .zip(content)
        .filter_map(|(name, f)| {
            let f = f.filter(|f| *f >= limit)?;
            Some(
                Finding::new(
                    Severity::Warning,
                    "content-near-first-mode",
                    format!("load `{name}`"),
                    format!("its content reaches {f:.2} Hz, a third or more of the first elastic mode of {structure} ({first_mode:.2} Hz): \
                     quasi-static recovery treats elastic vibration as load"),
                    "state [dynamic] to subtract the vibration. Or low-pass filter the strain below a third of the first mode, or recover the loads from accelerations (`identify`)",
                )
                .with_numbers(f, limit),
            )
        })
        .collect()
}
