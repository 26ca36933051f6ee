//! Columns of a gauge table: their contents, their units, and the columns that are not read.

use super::same_name::is_same_name;
use super::suggest;
use super::table::Table;
use super::unread_columns::note_unread;
use crate::host::fault::{Fault, FaultList};
use crate::host::files::Inputs;
use crate::series::record::name_and_unit;
use crate::units::{Quantity, find_unit, unit_names};

/// Quantity of the numbers of a column.
#[derive(Clone, Copy, PartialEq)]
enum Measures {
    /// Text, ids, or numbers without a unit.
    Nothing,
    /// A length in the job's unit.
    Length,
    /// An angle in degrees.
    Angle,
}

use Measures::{Angle, Length, Nothing};

/// Columns of a gauge table: name, other names, unit.
const COLUMNS: [(&str, &[&str], Measures); 27] = [
    ("name", &["gauge"], Nothing),
    ("element", &[], Nothing),
    ("surface", &["side"], Nothing),
    ("dir_x", &["axis_x", "direction_x"], Nothing),
    ("dir_y", &["axis_y", "direction_y"], Nothing),
    ("dir_z", &["axis_z", "direction_z"], Nothing),
    ("angle_deg", &[], Angle),
    ("x", &["position_x"], Length),
    ("y", &["position_y"], Length),
    ("z", &["position_z"], Length),
    ("x_m", &[], Length),
    ("y_m", &[], Length),
    ("z_m", &[], Length),
    ("bridge", &["kind", "wiring"], Nothing),
    ("bridge_factor", &[], Nothing),
    ("grid_length", &[], Length),
    ("station", &[], Nothing),
    ("transverse_sensitivity", &[], Nothing),
    ("rosette", &[], Nothing),
    ("point", &[], Nothing),
    ("element2", &[], Nothing),
    ("surface2", &["side2"], Nothing),
    ("cid", &[], Nothing),
    ("role", &[], Nothing),
    ("member", &[], Nothing),
    // Only read for the spots that `place` may choose from; a gauge has no cost.
    ("cost", &["costs", "price"], Nothing),
    // A vector in one column can't be read.
    ("direction", &[], Nothing),
];

/// Columns that `place` writes into its tables for those who glue the gauges.
const INFORMATIVE: [&str; 19] = [
    "angle_from_element_x_deg",
    "angle from element x axis, deg",
    "angle_seen_deg",
    "leverage",
    "expected strain, microstrain",
    "expected_microstrain",
    "from_grid",
    "dx",
    "dy",
    "dz",
    "outward_x",
    "outward_y",
    "outward_z",
    "corner_grids",
    "corner_distances",
    "angle_budget_deg",
    "position_budget",
    "strain_microstrain",
    "sd_microstrain",
];

/// A column that is read.
#[derive(Clone, Copy)]
pub(super) struct GaugeColumn {
    /// Index of the column in the table.
    pub at: usize,
    /// Factor from a number of the column to job units (degrees for an angle).
    pub scale: f64,
}

/// The columns of a gauge table.
pub(super) struct GaugeColumns {
    known: Vec<(&'static str, GaugeColumn)>,
    unread: Vec<usize>,
}

/// Name and unit that a header may state.
struct ColumnHeader<'a> {
    name: &'a str,
    unit: &'a str,
    bracket: &'a str,
}

impl GaugeColumns {
    /// Returns the columns of a table. `length_m` is the job's unit of length in metres.
    pub fn from_table(t: &Table, length_m: f64, faults: &mut FaultList) -> Self {
        let mut out = Self {
            known: Vec::new(),
            unread: Vec::new(),
        };
        let mut taken = vec![false; t.header.len()];
        for (name, others, measures) in COLUMNS {
            let found = column_of(t, (name, others, measures), &taken, faults);
            let Some(at) = found else { continue };
            taken[at] = true;
            let scale = scale_of(t, at, (name, measures), length_m, faults);
            out.known.push((name, GaugeColumn { at, scale }));
        }
        let is_free = |at: &usize| !taken[*at] && !is_informative(&t.header[*at]);
        out.unread = (0..t.header.len()).filter(is_free).collect();
        out.check_direction(t, faults);
        out
    }

    /// Returns the column with this name, if the table has the column.
    pub fn column(&self, name: &str) -> Option<GaugeColumn> {
        let known = self.known.iter().find(|k| k.0 == name);
        known.map(|k| k.1)
    }

    /// Returns whether the table states the directions of its gauges.
    pub fn has_direction(&self) -> bool {
        let names = ["dir_x", "dir_y", "dir_z", "angle_deg"];
        names.iter().any(|n| self.column(n).is_some())
    }

    /// Marks a column as not used by any command.
    pub fn leave_unread(&mut self, name: &str) {
        self.unread.extend(self.column(name).map(|c| c.at));
        self.known.retain(|k| k.0 != name);
    }

    /// Adds a warning that names the columns which nothing reads.
    pub fn note_unread(&self, inputs: &mut Inputs, t: &Table) {
        let is_read = |c| !self.unread.contains(&c);
        note_unread(inputs, t, is_read, &self.missing_columns());
    }

    /// Returns the names of columns that the table does not have.
    fn missing_columns(&self) -> Vec<&'static str> {
        let names = COLUMNS.iter().map(|c| c.0);
        names.filter(|n| self.column(n).is_none()).collect()
    }

    /// Adds a fault for each unknown column whose name is similar to a missing column. Otherwise a misspelt angle column would count as 0.
    pub fn check_spelling(&self, t: &Table, faults: &mut FaultList) {
        let lacking = self.missing_columns();
        let long = |n: &&&str| n.len() > 4 && **n != "direction" && **n != "member";
        for at in &self.unread {
            let header = t.header[*at].as_str();
            let lower = header.to_lowercase();
            let whole =
                |n: &&str| n.split_once('_').is_some_and(|(f, _)| f == lower) && n.len() > 5;
            let meant = lacking.iter().filter(long).copied().find(whole);
            let near = || suggest::find_closest_name(header, lacking.iter().filter(long).copied());
            let meant = meant.or_else(near).filter(|_| header.len() > 4);
            if let Some(n) = meant {
                faults.push(Fault::with_line(
                    &*t.file,
                    1,
                    header,
                    format!("`{header}` is not a column of a gauge file"),
                    format!("did you mean `{n}`? Rename it if it is something else"),
                ));
            }
        }
    }

    /// Refuses a direction in a single column, where the table states none in three.
    fn check_direction(&mut self, t: &Table, faults: &mut FaultList) {
        if self.column("direction").is_none() {
            return;
        }
        if self.column("dir_x").is_some() {
            self.leave_unread("direction");
            return;
        }
        let remedy = "write its components in the columns `dir_x`, `dir_y`, `dir_z`";
        let wrong = "a direction in one column cannot be read";
        faults.push(Fault::with_line(&*t.file, 1, "direction", wrong, remedy));
    }
}

/// Returns whether `place` writes this column for information only.
fn is_informative(header: &str) -> bool {
    let is_range = header.starts_with("range_") && header.ends_with("_microstrain");
    header.is_empty() || is_range || INFORMATIVE.iter().any(|n| is_same_name(n, header))
}

/// Returns the index of the column with one of these names, else of the column whose name differs only in case, separators and unit.
fn column_of(
    t: &Table,
    (name, others, measures): (&str, &[&str], Measures),
    taken: &[bool],
    faults: &mut FaultList,
) -> Option<usize> {
    let names = || std::iter::once(&name).chain(others);
    let is_free = |at: &usize| !taken[*at] && holds_words(t, *at, name);
    let exact = names().find_map(|n| {
        (0..taken.len())
            .filter(is_free)
            .find(|at| t.header[*at] == *n)
    });
    if exact.is_some() {
        return exact;
    }
    let is_other = |header: &str| {
        COLUMNS
            .iter()
            .any(|c| c.0 == header || c.1.contains(&header))
    };
    let is_meant = |at: &usize| {
        let header = t.header[*at].as_str();
        let stated = stated_in(header, measures);
        let same = |n: &&str| is_same_name(n, stated.name);
        !is_other(header) && (names().any(same) || measures == Angle && stated.is_angle())
    };
    let mut found = (0..taken.len()).filter(is_free).filter(is_meant);
    let first = found.next()?;
    if let Some(second) = found.next() {
        let wrong = format!("two columns contain `{name}`: `{}` too", t.header[first]);
        let remedy = "delete one of the two columns";
        faults.push(Fault::with_line(
            &*t.file,
            1,
            &*t.header[second],
            wrong,
            remedy,
        ));
    }
    Some(first)
}

/// Values of a column `side` that are sides of a vehicle and not of a shell.
const OF_VEHICLE: [&str; 20] = [
    "left",
    "right",
    "l",
    "r",
    "lh",
    "rh",
    "links",
    "rechts",
    "li",
    "re",
    "front",
    "rear",
    "middle",
    "centre",
    "center",
    "driver",
    "passenger",
    "both",
    "-",
    "none",
];

/// Returns whether a column `side` contains sides of a shell and not sides of a vehicle. The row refuses any other value.
fn holds_words(t: &Table, at: usize, name: &str) -> bool {
    let header = t.header[at].as_str();
    if !name.starts_with("surface") || !header.to_lowercase().starts_with("side") {
        return true;
    }
    let mut words = t.rows.iter().filter_map(|r| r.1.get(at));
    words.all(|w| !OF_VEHICLE.contains(&w.to_lowercase().as_str()))
}

/// Returns name and unit of a header: `angle_deg [rad]`, `x [mm]`, `x_mm`.
fn stated_in(header: &str, measures: Measures) -> ColumnHeader<'_> {
    let column = name_and_unit(header);
    let name = match column.header.bracket.is_empty() {
        true => header,
        false => header.get(..column.header.name.len()).unwrap_or(header),
    };
    let bracket = match column.header.bracket.is_empty() {
        true => "",
        false => {
            let rest = header.get(name.len()..).unwrap_or_default();
            rest.trim().trim_matches(['[', ']', '(', ')'])
        }
    };
    let split = name.rsplit_once(['_', ' ']);
    let is_unit = |u: &str| match measures {
        Length => find_unit(Quantity::Length, u).is_some(),
        Angle => degrees_in(u).is_some(),
        Nothing => false,
    };
    match split.filter(|(_, unit)| is_unit(unit)) {
        Some((name, unit)) => ColumnHeader {
            name,
            unit,
            bracket,
        },
        None => ColumnHeader {
            name,
            unit: "",
            bracket,
        },
    }
}

impl ColumnHeader<'_> {
    /// Returns whether the text is an angle with a unit.
    fn is_angle(&self) -> bool {
        let has_unit = !self.unit.is_empty() || degrees_in(self.bracket).is_some();
        is_same_name(self.name, "angle") && has_unit
    }
}

/// Returns the degrees in a unit of angle.
fn degrees_in(unit: &str) -> Option<f64> {
    match unit.trim().to_lowercase().as_str() {
        "deg" | "degree" | "degrees" | "°" => Some(1.0),
        "rad" | "radian" | "radians" => Some(1_f64.to_degrees()),
        "mrad" => Some(1e-3_f64.to_degrees()),
        _ => None,
    }
}

/// Returns the factor from a column's numbers to job units (degrees for an angle). Adds a fault if the unit does not fit the column.
fn scale_of(
    t: &Table,
    at: usize,
    (name, measures): (&str, Measures),
    length_m: f64,
    faults: &mut FaultList,
) -> f64 {
    let header = t.header[at].as_str();
    let stated = stated_in(header, measures);
    let in_bracket = Some(stated.bracket).filter(|b| !["", "-", "1"].contains(b));
    let in_name = Some(stated.unit).filter(|u| !u.is_empty());
    let of = |unit: &str| match measures {
        Length => find_unit(Quantity::Length, unit).map(|u| u.si / length_m),
        Angle => degrees_in(unit),
        Nothing => None,
    };
    let mut fault = |wrong: String, remedy: String| {
        faults.push(Fault::with_line(&*t.file, 1, header, wrong, remedy));
        1.0
    };
    match (in_name, in_bracket) {
        (None, None) => 1.0,
        (Some(unit), None) => of(unit).unwrap_or(1.0),
        (in_name, Some(unit)) => match (of(unit), in_name.and_then(of)) {
            (Some(scale), None) => scale,
            (Some(scale), Some(own)) if scale == own => scale,
            (Some(_), Some(_)) => fault(
                format!("`{unit}` contradicts the unit in the name"),
                "state one unit".to_owned(),
            ),
            // Text in brackets may be a label: `surface (top or bottom)`.
            (None, _) if measures == Nothing && !name_and_unit(header).header.is_unit() => 1.0,
            (None, _) => {
                let remedy = match measures {
                    Length => format!("write one of {}", unit_names(Quantity::Length).join(", ")),
                    Angle => "write deg, rad or mrad".to_owned(),
                    Nothing => "delete the unit".to_owned(),
                };
                fault(format!("`{unit}` is not a unit of `{name}`"), remedy)
            }
        },
    }
}
