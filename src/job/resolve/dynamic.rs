//! `[dynamic]`.

use super::super::faults::Collector;
use super::super::raw_record::RawDynamic;
use super::super::shapes::{DampingBand, DampingValue};
use super::super::spanned_value::{S, SpannedValue};
use super::super::types::{Damping, Dynamic};

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
    let stated = c.require(&raw.damping, section, "dynamic.damping", "damping = 0.02");
    c.positive_number(&raw.up_to_hz, "dynamic.up_to_hz");
    let damping = stated.and_then(|_| resolve_damping(c, &raw.damping));
    let frequency = c.fraction(
        &raw.frequency_uncertainty_rel,
        "dynamic.frequency_uncertainty_rel",
    );
    let of_damping = c.fraction(
        &raw.damping_uncertainty_rel,
        "dynamic.damping_uncertainty_rel",
    );
    if let (Some(Damping::Estimate), Some(at)) = (&damping, &raw.damping_uncertainty_rel) {
        let wrong = "the damping is estimated from the record: its uncertainty follows from it";
        let remedy = "delete this line, or state the damping";
        c.fault(at, "dynamic.damping_uncertainty_rel", wrong, remedy);
    }
    Some(Dynamic {
        up_to_hz: up_to?,
        damping: damping?,
        frequency_uncertainty_rel: frequency.unwrap_or(FREQUENCY),
        damping_uncertainty_rel: of_damping.unwrap_or(DAMPING),
        line: c.line(section),
    })
}

/// Checks the damping. Every value is a share of critical damping above 0 and below 1.
fn resolve_damping(c: &mut Collector, value: &S<DampingValue>) -> Option<Damping> {
    let at = value.as_ref()?;
    let is_damping = |x: f64| x > 0.0 && x < 1.0;
    let wrong = match at.value() {
        DampingValue::One(x) if is_damping(*x) => return Some(Damping::Uniform(*x)),
        DampingValue::One(x) => format!("`{x}`"),
        DampingValue::Word(word) if word == "estimate" => return Some(Damping::Estimate),
        DampingValue::Word(word) => format!("`{word}`"),
        DampingValue::Bands(bands) => {
            let ascending = bands.windows(2).all(|b| b[0].up_to_hz < b[1].up_to_hz);
            let valid = |b: &DampingBand| {
                b.up_to_hz > 0.0 && b.up_to_hz.is_finite() && is_damping(b.damping)
            };
            if !bands.is_empty() && ascending && bands.iter().all(valid) {
                let bands = bands.iter().map(|b| [b.up_to_hz, b.damping]);
                return Some(Damping::Bands(bands.collect()));
            }
            "the list of bands".to_owned()
        }
    };
    c.fault(
        at,
        "dynamic.damping",
        format!(
            "{wrong}, expected a share of critical damping above 0 and below 1 such as 0.02, bands of ascending `up_to_hz` with such a \
             `damping`, or \"estimate\""
        ),
        "correct the damping",
    );
    None
}
