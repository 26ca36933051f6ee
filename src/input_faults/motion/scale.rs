//! The unit of all accelerations or all wheel forces by the masses that the equations give.

use super::{ChannelKind, MotionChannel, RULES, of_kind, other_units, shows};
use crate::finding::{Finding, Severity, list_few};
use crate::units::number;

/// Masses from the equations, and other data that fix the scale of accelerations and forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionScale {
    /// Identified mass divided by the mass from the mean wheel force and gravity, if wheels carry the whole mass.
    pub closure: Option<f64>,
    /// Identified mass divided by the number of wheels, kg, for a vehicle on wheels.
    pub mass_kg: Option<f64>,
    /// Whether a parameter is stated, which the record would contradict.
    pub is_stated: bool,
}

/// Returns the finding on the unit of all accelerations or all wheel forces, which scales all parameters by one factor. It is an error if the masses
/// refute the unit. It is a warning if the file states no unit of acceleration and nothing confirms the unit of the job.
pub fn finding_of_scale(
    channels: &[MotionChannel],
    gravity: f64,
    scale: MotionScale,
) -> Option<Finding> {
    let accelerations = of_kind(channels, ChannelKind::Acceleration);
    let first = &channels[*accelerations.first()?];
    let as_if = |kind: ChannelKind, unit: &str, read: &str| {
        format!(
            "all {} may be in {unit} and are read as {read}",
            kind.plural_name()
        )
    };
    let finding = |severity, message: String, remedy: String, number: f64, limit: f64| {
        let finding = Finding::new(severity, "input-unit", "all", message, remedy);
        Some(finding.with_numbers(number, limit))
    };
    let state = |unit: &str| {
        format!(
            "State the unit after the name of each channel: `{} [{unit}]`.",
            first.name
        )
    };
    if let Some(ratio) = scale.closure
        && let Some((unit, factor)) = other_units(first)
            .into_iter()
            .find(|(_, f)| shows(ratio, *f))
    {
        let message = format!(
            "the identified mass is {} times the mean wheel force over gravity: {}",
            number(ratio),
            as_if(ChannelKind::Acceleration, unit, &first.unit)
        );
        return finding(Severity::Error, message, state(unit), ratio, factor);
    }
    let [least, most] = RULES.mass_kg;
    let possible = |kg: f64| (least..=most).contains(&kg);
    if let Some(kg) = scale.mass_kg.filter(|kg| !possible(*kg)) {
        // If static forces agree with the mass, only the unit of forces is in question.
        let closed = scale.closure.is_some_and(|r| shows(r, 1.0));
        let force = of_kind(channels, ChannelKind::Force);
        let force = force.first().map(|c| &channels[*c]);
        let mut list: Vec<(String, bool)> = Vec::new();
        if let Some(force) = force {
            let units = other_units(force)
                .into_iter()
                .filter(|(_, f)| possible(kg * f));
            list.extend(units.map(|(unit, _)| {
                (
                    as_if(ChannelKind::Force, unit, &force.unit),
                    force.is_unit_stated,
                )
            }));
        }
        if !closed {
            let units = other_units(first)
                .into_iter()
                .filter(|(_, f)| possible(kg / f));
            list.extend(units.map(|(unit, _)| {
                (
                    as_if(ChannelKind::Acceleration, unit, &first.unit),
                    first.is_unit_stated,
                )
            }));
        }
        if !list.is_empty() {
            let words: Vec<&str> = list.iter().map(|l| l.0.as_str()).collect();
            let severity = match list.iter().all(|l| l.1) {
                true => Severity::Warning,
                false => Severity::Error,
            };
            let message = format!(
                "the identified mass is {} kg per wheel, and a vehicle has {} to {} kg per wheel: {}",
                number(kg),
                number(least),
                number(most),
                words.join(", or ")
            );
            let remedy = "State the units of accelerations and forces after the names of the channels: `a_body [g]`, `f_wheel [kN]`.";
            let limit = if kg < least { least } else { most };
            return finding(severity, message, remedy.to_owned(), kg, limit);
        }
    }
    let open: Vec<&str> = accelerations
        .iter()
        .map(|c| &channels[*c])
        .filter(|c| !c.is_unit_stated)
        .map(|c| c.name)
        .collect();
    let is_confirmed = scale.is_stated
        || scale.closure.is_some_and(|r| shows(r, 1.0))
        || accelerations
            .iter()
            .any(|c| shows(channels[*c].mean, gravity));
    if open.is_empty() || is_confirmed {
        return None;
    }
    let in_g = other_units(first)
        .into_iter()
        .find(|u| u.0 == "g")
        .map(|(_, factor)| {
            format!(
                " In g, masses and stiffness would be {} times smaller.",
                number(factor)
            )
        });
    let message = format!(
        "the file states no unit of {}, and nothing in the record confirms one: {} is assumed.{}",
        list_few(&open),
        first.unit,
        in_g.unwrap_or_default()
    );
    finding(
        Severity::Warning,
        message,
        state(&first.unit),
        open.len() as f64,
        0.0,
    )
}
