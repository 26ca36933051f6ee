//! The gauge file. It has a row for each gauge, and the keys of `[[gauge]]` as columns.
//!
//! `direction` is `dir_x`, `dir_y`, `dir_z`; `position` is `x`, `y`, `z` in job units, or `x_m`, `y_m`, `z_m` in metres. `super::gauge_table`
//! finds the columns: a finding names those that nothing reads, and one that looks like a column that the table lacks is a fault.

use super::gauge_table::{GaugeColumn, GaugeColumns};
use super::resolve::{
    ELEMENT_STATED, POINT_ALONE, POINT_STATED, STATION_ALONE, bridge_from, check_gauge, point_from,
    role_from, rosette_from, surface_from, with_pair,
};
use super::suggest;
use super::table::{Table, read_table};
use super::types::{Job, JobGauge, NamedFile, StatedPlace};
use crate::fe::strain_tensor::Surface;
use crate::finding::{Finding, Severity};
use crate::gauge::{Bridge, Rosette};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::files::Inputs;
use crate::placement::Role;

/// Reads the gauges of `[gauges] file` and adds faults to the list.
pub(super) fn read_gauge_file(
    inputs: &mut Inputs,
    job: &Job,
    faults: &mut FaultList,
) -> Vec<JobGauge> {
    let Some(named) = &job.gauge_file else {
        return Vec::new();
    };
    let Some((t, mut columns, gauges)) = read_gauges(inputs, job, named, faults) else {
        return Vec::new();
    };
    columns.leave_unread("cost");
    columns.note_unread(inputs, &t);
    if let Some(finding) = without_direction(job, &t, &columns, &gauges) {
        inputs.note(&t.file, finding);
    }
    gauges
}

/// Returns a table of gauges with its columns and gauges. `None` if the table can't be read. Faults are added to the list.
pub(super) fn read_gauges(
    inputs: &mut Inputs,
    job: &Job,
    named: &NamedFile,
    faults: &mut FaultList,
) -> Option<(Table, GaugeColumns, Vec<JobGauge>)> {
    let table = inputs
        .read_named_text(job, named)
        .map_err(Faults::from)
        .and_then(|t| read_table(&named.given, &t))
        .and_then(|t| Ok(t.check_rows().map(|()| t)?));
    match table {
        Ok(t) => {
            let columns = GaugeColumns::from_table(&t, job.units.length_m(), faults);
            let gauges = gauges_from_table(&t, &columns, faults);
            Some((t, columns, gauges))
        }
        Err(f) => {
            faults.extend(f);
            None
        }
    }
}

/// Returns a warning where a table states no direction of its gauges, and S comes from a model.
fn without_direction(
    job: &Job,
    t: &Table,
    columns: &GaugeColumns,
    gauges: &[JobGauge],
) -> Option<Finding> {
    let is_shell = |g: &JobGauge| !matches!(g.place, StatedPlace::BeamPoint { .. });
    let of_model = job.model.is_some() && job.sensitivity.is_none();
    let assumed = of_model && !columns.has_direction() && gauges.iter().any(is_shell);
    assumed.then(|| {
        Finding::new(
            Severity::Warning,
            "gauges-assumed",
            &*t.file,
            "the table has no columns `dir_x`, `dir_y`, `dir_z` and `angle_deg`: every gauge points along the x axis of its element",
            "state the direction of every gauge",
        )
    })
}

/// Returns the gauges of a table.
pub(super) fn gauges_from_table(
    t: &Table,
    columns: &GaugeColumns,
    faults: &mut FaultList,
) -> Vec<JobGauge> {
    if columns.column("name").is_none() {
        let remedy = suggest::find_closest_name("name", t.header.iter().map(String::as_str))
            .map_or("add a column `name`".to_owned(), |n| {
                format!("rename column `{n}` to `name`")
            });
        faults.push(Fault::with_line(
            &*t.file,
            1,
            "name",
            "no column `name`",
            remedy,
        ));
        return Vec::new();
    }
    columns.check_spelling(t, faults);
    let mut out = Vec::new();
    for row in 0..t.rows.len() {
        let before = faults.len();
        let mut of_table = Row {
            table: t,
            columns,
            row,
            faults,
        };
        let gauge = gauge_of_row(&mut of_table);
        if faults.len() == before {
            check_gauge(&gauge, faults);
            out.push(gauge);
        }
    }
    out
}

/// A row of a gauge file, with the faults found so far.
struct Row<'a> {
    table: &'a Table,
    columns: &'a GaugeColumns,
    row: usize,
    faults: &'a mut FaultList,
}

impl Row<'_> {
    /// Line in the file.
    fn line(&self) -> u32 {
        self.table.rows.get(self.row).map_or(0, |r| r.0)
    }

    /// The field in a column; empty where the table lacks it.
    fn text(&self, name: &str) -> &str {
        let row = self.table.rows.get(self.row);
        let field = |column: GaugeColumn| row?.1.get(column.at);
        let column = self.columns.column(name);
        column.and_then(field).map_or("", String::as_str)
    }

    fn fault(&mut self, field: &str, wrong: String, remedy: impl Into<String>) {
        let line = self.line();
        self.faults.push(Fault::with_line(
            &*self.table.file,
            line,
            field,
            wrong,
            remedy,
        ));
    }

    fn number(&mut self, name: &str) -> Option<f64> {
        let column = self.columns.column(name)?;
        let number = self.table.number(self.row, column.at);
        let number = number.unwrap_or_else(|f| {
            self.faults.push(f);
            None
        });
        number.map(|v| v * column.scale)
    }

    /// A vector in three columns; `None` where one is blank.
    fn vector(&mut self, names: [&str; 3]) -> Option<[f64; 3]> {
        let [x, y, z] = names.map(|n| self.number(n));
        Some([x?, y?, z?])
    }

    /// The complete direction, or `None`. With a part of it, the gauge would follow the element x axis.
    fn direction(&mut self) -> Option<[f64; 3]> {
        let names = ["dir_x", "dir_y", "dir_z"];
        let before = self.faults.len();
        let parts = names.map(|n| self.number(n));
        let blank = names.iter().zip(parts).find(|(_, p)| p.is_none());
        if let Some((name, _)) = blank
            && parts.iter().any(Option::is_some)
            && self.faults.len() == before
        {
            let remedy = "state `dir_x`, `dir_y` and `dir_z`, or leave all three blank";
            self.fault(
                name,
                "this component is blank, and the others are not".into(),
                remedy,
            );
        }
        let [x, y, z] = parts;
        Some([x?, y?, z?])
    }

    /// A whole number from `least` up; `what` it is the id of.
    fn id(&mut self, field: &str, what: &str, least: u32) -> Option<u32> {
        let x = self.number(field)?;
        if x >= f64::from(least) && x <= f64::from(u32::MAX) && x.fract() == 0.0 {
            return Some(x as u32);
        }
        let remedy = match least {
            0 => "give a whole number, 0 for the basic system",
            _ => "give a whole number above 0",
        };
        self.fault(field, format!("`{x}` is not a valid {what} id"), remedy);
        None
    }

    /// Parses the choice in a column; `None` if it is blank or unknown. An unknown choice is a fault.
    fn word<T>(
        &mut self,
        name: &str,
        what: &str,
        from: fn(&str) -> Option<T>,
        remedy: fn(&str) -> String,
    ) -> Option<T> {
        let word = self.text(name);
        if word.is_empty() {
            return None;
        }
        let found = from(word);
        if found.is_none() {
            let (wrong, remedy) = (format!("`{word}` is not a valid {what}"), remedy(word));
            self.fault(name, wrong, remedy);
        }
        found
    }

    fn surface(&mut self, field: &str) -> Option<Surface> {
        self.word(field, "surface", surface_from, |_| {
            "write `top` (Z2) or `bottom` (Z1)".into()
        })
    }

    fn bridge(&mut self) -> Bridge {
        let remedy = |word: &str| suggest::remedy(word, Bridge::ALL.map(Bridge::name));
        self.word("bridge", "bridge", bridge_from, remedy)
            .unwrap_or(Bridge::Quarter)
    }

    fn rosette(&mut self) -> Option<Rosette> {
        self.word("rosette", "rosette", rosette_from, |_| {
            "write `rectangular` or `delta`".into()
        })
    }

    fn role(&mut self) -> Role {
        let remedy = |_: &str| "write `estimate` or `validation`".into();
        self.word("role", "role of a gauge", role_from, remedy)
            .unwrap_or(Role::Estimate)
    }

    /// A recovery point of a bar or beam, 0 to 3.
    fn point(&mut self) -> Option<u8> {
        self.word("point", "recovery point", point_from, |_| {
            "write C, D, E or F".into()
        })
    }

    fn name(&mut self) -> String {
        let name = self.text("name").to_owned();
        if name.is_empty() {
            self.fault("name", "blank".into(), "name every gauge");
        }
        name
    }
}

/// A location in job units, as a row states it.
struct Location {
    at: Option<[f64; 3]>,
    /// Whether the location is stated by `x`, `y`, `z`, which place the gauge. `x_m`, `y_m`, `z_m` alone may describe it only.
    in_job_units: bool,
}

/// Reads the columns `x`, `y`, `z`, or `x_m`, `y_m`, `z_m`.
fn location(row: &mut Row) -> Location {
    let metres = row.vector(["x_m", "y_m", "z_m"]);
    let stated = row.vector(["x", "y", "z"]);
    Location {
        at: stated.or(metres),
        in_job_units: stated.is_some(),
    }
}

/// Returns the place that a row states for its gauge; `laid` means that the row states direction or surface.
fn place(row: &mut Row, location: &Location, laid: bool, cid: u32) -> StatedPlace {
    let element = row.id("element", "element", 1);
    let stated = row.number("station");
    let station = stated.unwrap_or(0.0);
    let point = row.point();
    if stated.is_some() && point.is_none() {
        row.fault("station", STATION_ALONE.to_owned(), POINT_STATED);
    }
    let positioned = location.at.is_some() && (laid || location.in_job_units);
    if element.is_none() && point.is_some() && positioned {
        row.fault("point", POINT_ALONE.to_owned(), ELEMENT_STATED);
    }
    match (element, point, location.at) {
        (Some(element), Some(point), _) => StatedPlace::BeamPoint {
            element,
            point,
            station,
        },
        (Some(e), None, _) => StatedPlace::Element(e),
        // Coordinates in metres without direction or surface only describe the gauge.
        (None, _, Some(x)) if positioned => StatedPlace::Position(x, cid),
        _ => StatedPlace::Unstated,
    }
}

fn gauge_of_row(row: &mut Row) -> JobGauge {
    let direction = row.direction();
    let location = location(row);
    let cid = row.id("cid", "coordinate system", 0).unwrap_or(0);
    let surface = row.surface("surface");
    let laid = direction.is_some() || surface.is_some();
    let place = place(row, &location, laid, cid);
    let element2 = row.id("element2", "element", 1);
    let surface2 = row.surface("surface2");
    let gauge = JobGauge {
        name: row.name(),
        place,
        position: location.at,
        surface: surface.unwrap_or(Surface::Top),
        surface_stated: surface.is_some(),
        direction,
        cid,
        angle_deg: row.number("angle_deg").unwrap_or(0.0),
        bridge: row.bridge(),
        bridge_factor: row.number("bridge_factor").unwrap_or(1.0),
        grid_length: row.number("grid_length").unwrap_or(0.0),
        pair: None,
        rosette: row.rosette(),
        transverse_sensitivity: row.number("transverse_sensitivity").unwrap_or(0.0),
        role: row.role(),
        member: row.text("member").to_owned(),
        file: row.table.file.clone(),
        line: row.line(),
    };
    with_pair(gauge, element2, surface2, row.faults)
}
