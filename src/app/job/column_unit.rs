//! Names and units of a run table's columns, read as those of records are: `A [kN]`, `A (kN)`, or a row of units below the names.

use super::suggest;
use super::table::Table;
use super::types::{Job, Runs};
use crate::app::fault::{Fault, FaultList};
use crate::series::number::DecimalMark;
use crate::series::record::csv::is_units;
use crate::series::record::{Column, name_and_unit, take_unit_below};
use crate::units::{Quantity, Unit, find_unit, unit_names};

/// Name and unit of every column; a row of units below the names is taken out of the table. A unit beside the name goes before that row's.
pub fn take_units(t: &mut Table) -> Vec<Column> {
    let mut columns: Vec<Column> = t.header.iter().map(|h| name_and_unit(h)).collect();
    let is_row = t.rows.first().is_some_and(|(_, fields)| {
        let fields: Vec<&[u8]> = fields.iter().map(|f| f.as_bytes()).collect();
        is_units(&fields, &columns, DecimalMark::Point)
    });
    if is_row {
        let (_, units) = t.rows.remove(0);
        for ((c, header), unit) in columns.iter_mut().zip(&t.header).zip(&units) {
            take_unit_below(c, header, unit);
        }
    }
    columns
}

/// The column whose header is `name`, or `name` and a unit.
pub fn place_of(t: &Table, columns: &[Column], name: &str) -> Option<usize> {
    let whole = t.header.iter().position(|h| h == name);
    whole
        .or_else(|| columns.iter().position(|c| c.name == name))
        // What stands in brackets is not what the row of units says.
        .or_else(|| t.header.iter().position(|h| name_and_unit(h).name == name))
}

/// The column that names the runs.
///
/// # Errors
/// A fault where there is none.
pub fn run_column(t: &Table, columns: &[Column]) -> Result<usize, Fault> {
    place_of(t, columns, "run").ok_or_else(|| {
        let remedy = "add a column `run` with the runs' names";
        Fault::at(&*t.file, 1, "run", "no column `run`", remedy)
    })
}

/// The fault of a name that no header is in whole and several are before their unit.
pub fn held_twice(t: &Table, name: &str) -> Option<Fault> {
    let is_whole = t.header.iter().any(|h| h == name);
    let mut holding = t.header.iter().filter(|h| name_and_unit(h).name == name);
    let second = holding.nth(1).filter(|_| !is_whole)?;
    Some(Fault::at(
        &*t.file,
        1,
        second,
        format!("two columns hold `{name}`, with a unit each"),
        "leave one of them out, or name it in [runs] columns",
    ))
}

/// A column of the runs file with numbers of one quantity, and their unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownColumn {
    /// Its place in the table.
    pub at: usize,
    /// The unit that the column states, else that of the job; `None` for amplitudes of load sets, which have none.
    pub unit: Option<Unit>,
    /// Whether the column states it.
    pub is_stated: bool,
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
    let here = KnownColumn {
        at,
        unit: of_job,
        is_stated: false,
    };
    let (header, stated) = (t.header.get(at)?, columns.get(at)?);
    if let Some(fault) = held_twice(t, wanted) {
        faults.push(fault);
        return Some(here);
    }
    if header != wanted && stated.name != wanted {
        let beside = name_and_unit(header).unit;
        let wrong = format!(
            "`{beside}` beside the name, `{}` in the row of units below",
            stated.unit
        );
        let remedy = "correct whichever is wrong, or name the column in [runs] columns";
        faults.push(Fault::at(&*t.file, 1, header, wrong, remedy));
        return Some(here);
    }
    if matches!(stated.unit.as_str(), "" | "-") {
        return Some(here);
    }
    // `Axle (front)` is a name where the job says that this is the column's.
    let is_name = header == wanted
        && name_and_unit(header).unit == stated.unit
        && (given.is_some() || !header.ends_with(']'));
    let Some((quantity, of_job)) = quantity.zip(of_job) else {
        if !is_name && stated.unit != "1" {
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
    } else if unit != of_job {
        let doubt = noise_in_doubt(job, runs, quantity, unit, of_job);
        if let Some(fault) = doubt.filter(|f| !faults.contains(f)) {
            faults.push(fault);
        }
    }
    Some(KnownColumn {
        at,
        unit: Some(unit),
        is_stated: true,
    })
}

/// The fault of a noise that the job states beside columns in another unit than the job's, of which it doesn't say whether it is the file's.
fn noise_in_doubt(
    job: &Job,
    runs: &Runs,
    quantity: Quantity,
    of_column: Unit,
    of_job: Unit,
) -> Option<Fault> {
    let noise = match quantity {
        Quantity::Force => runs.noise.force,
        Quantity::Moment => runs.noise.moment,
        Quantity::Mass => runs.noise.mass,
        Quantity::Length => runs.noise.length,
        Quantity::Stress | Quantity::Acceleration => None,
    };
    let noise = noise.filter(|n| *n > 0.0)?;
    let word = quantity.word();
    Some(Fault::at(
        &*job.file,
        runs.line,
        format!("runs.noise.{word}"),
        format!(
            "is {noise} in `{}` or, as columns of the file, in `{}`?",
            of_job.name, of_column.name
        ),
        format!(
            "state the unit of file and noise: [runs] units = {{ {word} = \"{}\" }}",
            of_column.name
        ),
    ))
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
