//! `[dynamic]`.

use super::super::faults::Collector;
use super::super::raw_job::RawDynamic;
use super::super::spanned_value::SpannedValue;
use super::super::types::Dynamic;

/// One standard deviation of a computed frequency if none is stated, relative to the frequency. It covers density, thickness and joints of a model
/// that was not fitted to measured modes.
const FREQUENCY: f64 = 0.02;
/// One standard deviation of a damping that was not measured, relative to the damping.
const DAMPING: f64 = 0.5;

pub(super) fn resolve_dynamic(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawDynamic>>,
) -> Option<Dynamic> {
    let section = raw?;
    let raw = section.value();
    let up_to = c.require(
        &raw.up_to_hz,
        section,
        "dynamic.up_to_hz",
        "up_to_hz = 30.0",
    );
    let damping = c.require(&raw.damping, section, "dynamic.damping", "damping = 0.02");
    c.positive_number(&raw.up_to_hz, "dynamic.up_to_hz");
    c.number(
        &raw.damping,
        "dynamic.damping",
        "a share of critical damping above 0 and below 0.5, such as 0.02",
        |x| x > 0.0 && x < 0.5,
    );
    let frequency = c.fraction(
        &raw.frequency_uncertainty_rel,
        "dynamic.frequency_uncertainty_rel",
    );
    let of_damping = c.fraction(
        &raw.damping_uncertainty_rel,
        "dynamic.damping_uncertainty_rel",
    );
    Some(Dynamic {
        up_to_hz: up_to?,
        damping: damping?,
        frequency_uncertainty_rel: frequency.unwrap_or(FREQUENCY),
        damping_uncertainty_rel: of_damping.unwrap_or(DAMPING),
        line: c.line(section),
    })
}
