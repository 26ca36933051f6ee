//! `[compare]`.

use super::super::faults::Collector;
use super::super::raw_job::RawCompare;
use super::super::shapes::NumberOrWord;
use super::super::spanned_value::SpannedValue;
use super::super::types::*;
use super::measured::time_unit;
use super::units::{stated_quantities, units};
use crate::reconcile::strain::WheelForces;
use crate::units::ReportUnits;

pub(super) fn compare(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawCompare>>,
    default: ReportUnits,
) -> Option<Compare> {
    let section = raw?;
    let raw = section.value();
    c.require(&raw.file, section, "compare.file", "file = \"wft.rsp\"")?;
    let noise = match &raw.noise {
        None => RunNoise::default(),
        Some(n) => RunNoise {
            force: c.at_least_zero(&n.force, "compare.noise.force"),
            moment: c.at_least_zero(&n.moment, "compare.noise.moment"),
            ..RunNoise::default()
        },
    };
    let shift = match raw.shift_s.as_ref().map(|s| (s, s.value())) {
        None => TimeShift::Estimate,
        Some((_, NumberOrWord::Word(word))) if word == "estimate" => TimeShift::Estimate,
        Some((_, NumberOrWord::Number(s))) if s.is_finite() => TimeShift::Stated(*s),
        Some((at, _)) => {
            let wrong = "expected \"estimate\" or a number of seconds";
            c.fault(at, "compare.shift_s", wrong, "write one of these");
            TimeShift::Estimate
        }
    };
    let columns = raw.columns.iter();
    Some(Compare {
        recorded: Runs {
            file: c.named_file(&raw.file, "compare.file")?,
            section: "compare",
            columns: columns
                .map(|(load, column)| (load.value().clone(), column.value().clone()))
                .collect(),
            units: units(c, raw.units.as_ref(), default, "compare.units"),
            stated_units: stated_quantities(raw.units.as_ref()),
            noise,
            wheel_forces: WheelForces::Measured,
            ground: None,
            line: c.line(section),
        },
        shift,
        time_unit_s: time_unit(c, &raw.time_unit, "compare.time_unit"),
        line: c.line(section),
    })
}
