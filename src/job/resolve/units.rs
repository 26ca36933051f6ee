//! `units`, `report_units` and the units of tables.

use super::super::faults::Collector;
use super::super::raw_job::{RawUnits, S};
use super::super::suggest;
use crate::host::fault::Fault;
use crate::units::{Quantity, ReportUnits, Unit, UnitSystem, find_unit, unit_names};

/// Returns the unit system, which is required. `parsed` is false if the job had earlier faults, because the key may be missing for this reason.
pub(super) fn system(c: &mut Collector, raw: &S<String>, parsed: bool) -> UnitSystem {
    let choices: Vec<(&str, UnitSystem)> =
        UnitSystem::ALL.into_iter().map(|s| (s.name(), s)).collect();
    if raw.is_none() && parsed {
        let wrong = "this key is missing; units are never guessed";
        c.faults.push(Fault::with_line(
            c.file,
            1,
            "units",
            wrong,
            "add `units = \"m-kg-s\"`, or \"mm-t-s\", \"mm-kg-s\", \"in-lbf-s\"",
        ));
    }
    c.choose(raw, "units", &choices, UnitSystem::MKgS)
}

/// Returns the units by quantity. `default` is used for quantities that are not stated.
pub(super) fn units(
    c: &mut Collector,
    raw: Option<&RawUnits>,
    default: ReportUnits,
    section: &str,
) -> ReportUnits {
    let mut out = default;
    let Some(raw) = raw else { return out };
    let mut one = |name: &S<String>, quantity: Quantity, to: &mut Unit| {
        let Some(name) = name else { return };
        let key = format!("{section}.{}", quantity.word());
        match find_unit(quantity, name.value()) {
            Some(u) => *to = u,
            None => {
                let wrong = format!("`{}` is not a unit of {}", name.value(), quantity.word());
                c.fault(
                    name,
                    &key,
                    wrong,
                    suggest::remedy(name.value(), unit_names(quantity)),
                );
            }
        }
    };
    one(&raw.force, Quantity::Force, &mut out.force);
    one(&raw.moment, Quantity::Moment, &mut out.moment);
    one(&raw.length, Quantity::Length, &mut out.length);
    one(&raw.mass, Quantity::Mass, &mut out.mass);
    one(&raw.stress, Quantity::Stress, &mut out.stress);
    out
}

/// Returns the quantities of which a unit is stated.
pub(super) fn stated_quantities(raw: Option<&RawUnits>) -> Vec<Quantity> {
    let Some(raw) = raw else { return Vec::new() };
    let all = [
        (&raw.force, Quantity::Force),
        (&raw.moment, Quantity::Moment),
        (&raw.length, Quantity::Length),
        (&raw.mass, Quantity::Mass),
        (&raw.stress, Quantity::Stress),
    ];
    let stated = all.into_iter().filter(|(name, _)| name.is_some());
    stated.map(|(_, quantity)| quantity).collect()
}
