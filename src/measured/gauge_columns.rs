//! Assigns the columns of a strain file to gauges, with the factor from the unit of a column to microstrain. Tables and records use the same rules.

use crate::host::fault::{Fault, FaultList, Faults};
use crate::series::record::{Clash, Column, Header, name_and_unit};
use crate::units::microstrain_in;
use std::collections::{HashMap, HashSet};

/// A column of a strain file.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainColumn {
    /// Name of the gauge in the job. For a column without a gauge, it is a name that is unique in the file.
    pub name: String,
    /// Factor from a number of the column to microstrain. `None` if the column contains no strain and belongs to no gauge.
    pub microstrain: Option<f64>,
}

/// Returns the columns of a file, in file order, with the names of `gauges`. Without known gauges, every column may be a gauge.
///
/// Text in brackets after a name is its unit or, if a gauge of the job has that name, part of the name: `SG1 (left)`. If a strain column has the name
/// of a gauge, a similar column without strain is a different channel: `P01 (raw)` next to `P01 [um/m]`.
///
/// # Errors
/// Gauges in a unit that is not a unit of strain, or that contradicts the row of units; gauges with two columns.
pub fn find_gauge_columns(
    file: &str,
    columns: &[Column],
    gauges: &[String],
) -> Result<Vec<StrainColumn>, Faults> {
    let names = Names::from_columns(columns, gauges);
    let mut faults = FaultList::new();
    let mut taken: HashSet<String> = HashSet::new();
    let mut out: Vec<Option<StrainColumn>> = Vec::with_capacity(columns.len());
    for column in columns {
        let holds = holder(column, &names).unwrap_or_else(|wrong| {
            faults.push(wrong.fault(file, column));
            Holds::Gauge(column.header.whole.clone(), 1.0)
        });
        out.push(match holds {
            Holds::Gauge(name, microstrain) => {
                if !taken.insert(name.clone()) {
                    let remedy = "give every column a separate name";
                    faults.push(Fault::with_line(
                        file,
                        1,
                        &*name,
                        "column named twice",
                        remedy,
                    ));
                }
                let microstrain = Some(microstrain);
                Some(StrainColumn { name, microstrain })
            }
            Holds::Other => None,
        });
    }
    Faults::check(faults)?;
    let named = out.into_iter().zip(columns).map(|(gauge, column)| {
        gauge.unwrap_or_else(|| {
            let (name, microstrain) = by_itself(column);
            let whole = column.header.whole.clone();
            let full = format!("{whole} [{}]", column.unit);
            let free = |name: &String| !taken.contains(name);
            let name = [name, whole].into_iter().find(free).unwrap_or(full);
            taken.insert(name.clone());
            StrainColumn { name, microstrain }
        })
    });
    Ok(named.collect())
}

/// Returns the fault of a gauge whose unit is not a unit of strain.
pub fn no_strain(file: &str, column: &Column) -> Fault {
    let units = [&column.header.bracket, &column.stated];
    let unit = units.into_iter().find(|u| microstrain_in(u).is_none());
    Fault::new(
        file,
        &*column.header.name,
        format!("`{}` is not a unit of strain", unit.unwrap_or(&column.unit)),
        "export it in microstrain (uE, um/m) or strain (m/m)",
    )
}

/// Names of gauges and strain columns, to match both.
struct Names<'a> {
    /// Gauges of the job; empty if it states none.
    known: HashSet<&'a str>,
    /// Gauges whose whole name no column has, by their name before the bracket.
    split: HashMap<String, Vec<(Header, &'a str)>>,
    /// Names of columns of strain.
    held: HashSet<&'a str>,
}

impl<'a> Names<'a> {
    fn from_columns(columns: &'a [Column], gauges: &'a [String]) -> Self {
        let wholes: HashSet<&str> = columns.iter().map(|c| c.header.whole.as_str()).collect();
        let mut split: HashMap<String, Vec<(Header, &str)>> = HashMap::new();
        for gauge in gauges.iter().filter(|g| !wholes.contains(g.as_str())) {
            let header = name_and_unit(gauge).header;
            let alike = split.entry(header.name.clone()).or_default();
            alike.push((header, gauge));
        }
        let of_strain = |c: &&Column| microstrain_in(&c.unit).is_some();
        Self {
            known: gauges.iter().map(String::as_str).collect(),
            split,
            held: columns
                .iter()
                .filter(of_strain)
                .map(|c| c.name.as_str())
                .collect(),
        }
    }

    /// The gauge that is called as a header in whole.
    fn in_whole(&self, header: &Header) -> Option<&'a str> {
        let exact = self.known.get(header.whole.as_str()).copied();
        exact.or_else(|| {
            let mut alike = self.split.get(&header.name)?.iter();
            let found = alike.find(|(h, _)| !h.bracket.is_empty() && h.is_like(header));
            found.map(|(_, gauge)| *gauge)
        })
    }
}

/// Content of a column.
enum Holds {
    /// A gauge, and microstrain in one of its numbers.
    Gauge(String, f64),
    /// Another quantity.
    Other,
}

/// Reasons why a column can't be read as a gauge's.
enum ColumnUnitFault {
    /// The unit is not a unit of strain.
    NoStrain,
    /// Two units.
    Clash,
}

impl ColumnUnitFault {
    fn fault(&self, file: &str, column: &Column) -> Fault {
        match self {
            Self::NoStrain => no_strain(file, column),
            Self::Clash => Fault::with_line(
                file,
                1,
                &*column.header.whole,
                column.clash_words(),
                "correct the wrong one",
            ),
        }
    }
}

/// Whose a column is.
fn holder(column: &Column, names: &Names) -> Result<Holds, ColumnUnitFault> {
    let header = &column.header;
    let clash = column.clash();
    let (gauge, microstrain) = if names.known.is_empty() {
        let (name, microstrain) = by_itself(column);
        match microstrain {
            _ if clash == Some(Clash::Size) => return Err(ColumnUnitFault::Clash),
            None => return Ok(Holds::Other),
            some => (name, some),
        }
    } else if let Some(gauge) = names.in_whole(header) {
        // The unit is in a row of units, or is a unit of strain in the header's brackets. Any other text in brackets is a label.
        let unit = match column.stated.as_str() {
            "" => microstrain_in(&header.bracket).or(Some(1.0)),
            stated => microstrain_in(stated),
        };
        (gauge.to_owned(), unit)
    } else if names.known.contains(header.name.as_str()) {
        // The text in brackets must be the unit. If a row of units below makes the text a label, the column has no unit of strain.
        let is_split = column.name == header.name;
        let unit = microstrain_in(&column.unit).filter(|_| is_split);
        (header.name.clone(), unit)
    } else {
        return Ok(Holds::Other);
    };
    match microstrain {
        _ if clash == Some(Clash::Size) => Err(ColumnUnitFault::Clash),
        Some(microstrain) => Ok(Holds::Gauge(gauge, microstrain)),
        None if names.held.contains(gauge.as_str()) => Ok(Holds::Other),
        None => Err(ColumnUnitFault::NoStrain),
    }
}

/// Returns the name of a column and microstrain in one of its numbers, if no gauge has this name. Text in brackets that is not a unit is part of the
/// name; `None` for a unit that is not a unit of strain.
fn by_itself(column: &Column) -> (String, Option<f64>) {
    let header = &column.header;
    if column.clash().is_some() {
        return (header.whole.clone(), None);
    }
    let microstrain = microstrain_in(&column.unit);
    let is_unit = header.is_unit() || header.whole.ends_with(']');
    if column.stated.is_empty() && microstrain.is_none() && !is_unit {
        return (header.whole.clone(), Some(1.0));
    }
    (column.name.clone(), microstrain)
}
