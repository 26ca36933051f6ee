//! Names and units of a run table's columns, read as those of records are: `A [kN]`, `A (kN)`, or a row of units below the names.

use super::suggest;
use super::table::Table;
use super::types::{Job, Runs};
use crate::app::fault::{Fault, FaultList};
use crate::series::number::DecimalMark;
use crate::series::record::csv::is_units;
use crate::series::record::{Column, name_and_unit};
use crate::units::{Quantity, Unit, find_unit, unit_names};

/// Name and unit of every column; a row of units below the names is taken out of the table. A unit beside the name goes before that row's.
pub fn take_units(t: &mut Table) -> Vec<Column> {
    let mut columns: Vec<Column> = t.header.iter().map(|h| name_and_unit(h)).collect();
    let is_row = t.rows.first().is_some_and(|(_, fields)| {
        let fields: Vec<&[u8]> = fields.iter().map(|f| f.as_bytes()).collect();
        is_units(&fields, columns.len(), DecimalMark::Point)
    });
    if is_row {
        let (_, units) = t.rows.remove(0);
        for (c, unit) in columns.iter_mut().zip(&units) {
            if c.unit.is_empty() {
                unit.trim_matches(['[', ']', '(', ')'])
                    .clone_into(&mut c.unit);
            }
        }
    }
    columns
}

/// The column whose header is `name`, or `name` and a unit.
pub fn place_of(t: &Table, columns: &[Column], name: &str) -> Option<usize> {
    let whole = t.header.iter().position(|h| h == name);
    whole.or_else(|| columns.iter().position(|c| c.name == name))
}

/// A column of the runs file with numbers of one quantity, and their unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownColumn {
    /// Its place in the table.
    pub at: usize,
    /// The unit that the column states, else that of the job; `None` for amplitudes of load sets, which have none.
    pub unit: Option<Unit>,
}

/// The column of the runs file that holds `name`; `None` where there is none and the job names none.
///
/// The unit is the one that the column states. Where the job's `[runs] units` states another one for the quantity, one of them is wrong
/// and nothing tells which.
pub fn known_column(
    job: &Job,
    runs: &Runs,
    t: &Table,
    columns: &[Column],
    name: &str,
    quantity: Option<Quantity>,
    faults: &mut FaultList,
) -> Option<KnownColumn> {
    let given = runs.columns.get(name);
    let wanted = given.map_or(name, String::as_str);
    let Some(at) = place_of(t, columns, wanted) else {
        if given.is_some() {
            faults.push(Fault::at(
                &*job.file,
                runs.line,
                format!("runs.columns.{name}"),
                format!("`{}` has no column `{wanted}`", t.file),
                suggest::remedy(wanted, t.header.iter().map(String::as_str)),
            ));
        }
        return None;
    };
    let of_job = quantity.map(|q| runs.units.unit(q));
    let here = KnownColumn { at, unit: of_job };
    let (header, stated) = (t.header.get(at)?, columns.get(at)?);
    if header != wanted && columns.iter().filter(|c| c.name == wanted).count() > 1 {
        faults.push(Fault::at(
            &*t.file,
            1,
            header,
            format!("two columns hold `{wanted}`, with a unit each"),
            "leave one of them out, or name it in [runs] columns",
        ));
        return Some(here);
    }
    if matches!(stated.unit.as_str(), "" | "-") {
        return Some(here);
    }
    // `Axle (front)` is a name where the job says that this is the column's.
    let is_name = header == wanted && !header.ends_with(']');
    let Some((quantity, of_job)) = quantity.zip(of_job) else {
        if !is_name {
            let wrong = format!(
                "`{name}` is a factor of a load set, the column says `{}`",
                stated.unit
            );
            let remedy = "write how many times the set acts, without a unit";
            faults.push(Fault::at(&*t.file, 1, header, wrong, remedy));
        }
        return Some(here);
    };
    let Some(unit) = find_unit(quantity, &stated.unit) else {
        if !is_name {
            let wrong = format!("`{}` is no unit of {}", stated.unit, quantity.word());
            let remedy = format!("write one of {}", unit_names(quantity).join(", "));
            faults.push(Fault::at(&*t.file, 1, header, wrong, remedy));
        }
        return Some(here);
    };
    if unit != of_job && runs.stated_units.contains(&quantity) {
        let wrong = format!(
            "the column says `{}`, the job says `{}` (runs.units.{})",
            unit.name,
            of_job.name,
            quantity.word()
        );
        let remedy = "correct whichever is wrong; without runs.units the column's own unit counts";
        faults.push(Fault::at(&*t.file, 1, header, wrong, remedy));
    }
    Some(KnownColumn {
        at,
        unit: Some(unit),
    })
}

/// Microstrain in one of a unit, as measuring systems write it.
pub fn microstrain_in(unit: &str) -> Option<f64> {
    let word: String = unit
        .to_lowercase()
        .chars()
        .filter(|c| !matches!(c, ' ' | '_' | '-' | '.'))
        .map(|c| if matches!(c, 'µ' | 'μ') { 'u' } else { c })
        .collect();
    match word.as_str() {
        "" | "microstrain" | "ustrain" | "ue" | "uε" | "um/m" | "ustr" | "us" | "1e6" | "ppm"
        | "uin/in" => Some(1.0),
        "strain" | "m/m" | "mm/mm" | "in/in" | "eps" => Some(1e6),
        "mm/m" | "millistrain" | "mstrain" | "me" => Some(1e3),
        _ => None,
    }
}

/// The fault of a gauge's unit that is none of strain.
pub fn no_strain(file: &str, channel: &str, unit: &str) -> Fault {
    Fault::of(
        file,
        channel,
        format!("`{unit}` is no unit of strain"),
        "export it in microstrain (uE, um/m) or strain (m/m)",
    )
}
