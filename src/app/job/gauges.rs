//! The gauge file: a row a gauge, columns as the keys of `[[gauge]]`.
//!
//! `direction` is `dir_x`, `dir_y`, `dir_z`; `position` is `x`, `y`, `z` in job units, or `x_m`, `y_m`, `z_m` in metres. `gauge`
//! may stand for `name` and `kind` for `bridge`. Columns that are not known are left alone, but for those that look like one of these.

use super::resolve::{check_gauge, surface_from};
use super::suggest;
use super::table::{Table, read_table};
use super::types::*;
use crate::app::fault::{Fault, FaultList, Faults};
use crate::app::files::Inputs;

/// The gauges of `[gauges] file`; faults are added to the list.
pub(super) fn read_gauge_file(
    inputs: &mut Inputs,
    job: &Job,
    faults: &mut FaultList,
) -> Vec<JobGauge> {
    let Some(named) = &job.gauge_file else {
        return Vec::new();
    };
    let table = inputs
        .read_named_text(job, named)
        .map_err(Faults::from)
        .and_then(|t| read_table(&named.given, &t));
    match table {
        Ok(t) => gauges_from_table(&t, job.units.length_m(), faults),
        Err(f) => {
            faults.extend(f);
            Vec::new()
        }
    }
}

/// The gauges of a table; `length_m` are the metres in the job's unit of length.
pub fn gauges_from_table(t: &Table, length_m: f64, faults: &mut FaultList) -> Vec<JobGauge> {
    if t.column(&["name", "gauge"]).is_none() {
        let remedy = suggest::closest("name", t.header.iter().map(String::as_str))
            .map_or("add a column `name`".to_owned(), |n| {
                format!("rename column `{n}` to `name`")
            });
        faults.push(Fault::at(&*t.file, 1, "name", "no column `name`", remedy));
        return Vec::new();
    }
    misspelt(t, faults);
    let mut out = Vec::new();
    for row in 0..t.rows.len() {
        let before = faults.len();
        let gauge = gauge_of_row(t, row, length_m, faults);
        if faults.len() == before {
            check_gauge(&gauge, faults);
            out.push(gauge);
        }
    }
    out
}

/// Columns whose names are long enough to be told from others when misspelt.
const LONG_NAMES: [&str; 12] = [
    "element",
    "surface",
    "angle_deg",
    "bridge",
    "bridge_factor",
    "grid_length",
    "station",
    "transverse_sensitivity",
    "rosette",
    "point",
    "element2",
    "surface2",
];

/// Columns that look like one that the table lacks: an angle that is not read would be 0.
fn misspelt(t: &Table, faults: &mut FaultList) {
    let lacking: Vec<&str> = LONG_NAMES
        .into_iter()
        .filter(|n| t.column(&[n]).is_none())
        .collect();
    for h in t
        .header
        .iter()
        .filter(|h| !LONG_NAMES.contains(&h.as_str()))
    {
        let lower = h.to_lowercase();
        let whole = |n: &&str| n.split_once('_').is_some_and(|(first, _)| first == lower);
        let meant = lacking.iter().copied().find(whole);
        let meant = meant.or_else(|| suggest::closest(h, lacking.iter().copied()));
        if let Some(n) = meant.filter(|_| h.len() > 4) {
            faults.push(Fault::at(
                &*t.file,
                1,
                h.as_str(),
                format!("`{h}` is no column of a gauge file"),
                format!("did you mean `{n}`? Call it otherwise if it is something else"),
            ));
        }
    }
}

fn gauge_of_row(t: &Table, row: usize, length_m: f64, faults: &mut FaultList) -> JobGauge {
    let line = t.rows.get(row).map_or(0, |r| r.0);
    let text = |names: &[&str]| -> String {
        let c = t.column(names);
        t.rows
            .get(row)
            .and_then(|r| r.1.get(c?))
            .cloned()
            .unwrap_or_default()
    };
    let mut number = |name: &str| -> Option<f64> {
        let c = t.column(&[name])?;
        t.number(row, c).unwrap_or_else(|f| {
            faults.push(f);
            None
        })
    };
    let three = |a: Option<f64>, b: Option<f64>, c: Option<f64>| Some([a?, b?, c?]);
    let direction = three(number("dir_x"), number("dir_y"), number("dir_z"));
    let metres =
        three(number("x_m"), number("y_m"), number("z_m")).map(|x| x.map(|v| v / length_m));
    let position = three(number("x"), number("y"), number("z"));
    let stated_position = position.is_some();
    let position = position.or(metres);
    let (element, element2) = (number("element"), number("element2"));
    let angle_deg = number("angle_deg").unwrap_or(0.0);
    let bridge_factor = number("bridge_factor").unwrap_or(1.0);
    let grid_length = number("grid_length").unwrap_or(0.0);
    let station = number("station").unwrap_or(0.0);
    let transverse_sensitivity = number("transverse_sensitivity").unwrap_or(0.0);
    let cid = number("cid").unwrap_or(0.0) as u32;
    let mut fault = |field: &str, wrong: String, remedy: String| {
        faults.push(Fault::at(&*t.file, line, field, wrong, remedy))
    };
    let mut id = |field: &str, x: Option<f64>| -> Option<u32> {
        let x = x?;
        if x >= 1.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0 {
            return Some(x as u32);
        }
        fault(
            field,
            format!("`{x}` is no element id"),
            "give a whole number above 0".into(),
        );
        None
    };
    let (element, element2) = (id("element", element), id("element2", element2));
    let mut surface = |field: &str| -> Option<Surface> {
        let word = text(&[field]);
        if word.is_empty() {
            return None;
        }
        let s = surface_from(&word);
        if s.is_none() {
            fault(
                field,
                format!("`{word}` is no surface"),
                "write `top` (Z2) or `bottom` (Z1)".into(),
            );
        }
        s
    };
    let (stated, surface2) = (surface("surface"), surface("surface2"));
    let word = text(&["bridge", "kind"]);
    let bridge = if word.is_empty() {
        Some(Bridge::Quarter)
    } else {
        Bridge::from_name(&word)
    };
    if bridge.is_none() {
        let names: Vec<&str> = Bridge::ALL.iter().map(|b| b.name()).collect();
        fault(
            "bridge",
            format!("`{word}` is no bridge"),
            suggest::remedy(&word, names),
        );
    }
    let word = text(&["rosette"]);
    let rosette = super::resolve::rosette_from(&word);
    if rosette.is_none() && !word.is_empty() {
        fault(
            "rosette",
            format!("`{word}` is no rosette"),
            "write `rectangular` or `delta`".into(),
        );
    }
    let word = text(&["point"]);
    let point = super::resolve::point_from(&word);
    if point.is_none() && !word.is_empty() {
        fault(
            "point",
            format!("`{word}` is no recovery point"),
            "write C, D, E or F".into(),
        );
    }
    let name = text(&["name", "gauge"]);
    if name.is_empty() {
        fault("name", "blank".into(), "name every gauge".into());
    }
    let place = match (element, point, position) {
        (Some(element), Some(point), _) => GaugePlace::BeamPoint {
            element,
            point,
            station,
        },
        (Some(e), None, _) => GaugePlace::Element(e),
        // Metres beside a gauge of a given S only describe it.
        (None, _, Some(p)) if direction.is_some() || stated.is_some() || stated_position => {
            GaugePlace::Position(p, cid)
        }
        _ => GaugePlace::Unstated,
    };
    JobGauge {
        name,
        place,
        position,
        surface: stated.unwrap_or(Surface::Top),
        surface_stated: stated.is_some(),
        direction,
        cid,
        angle_deg,
        bridge: bridge.unwrap_or(Bridge::Quarter),
        bridge_factor,
        grid_length,
        pair: element2.map(|e| (e, surface2.unwrap_or(Surface::Bottom))),
        rosette,
        transverse_sensitivity,
        member: text(&["member"]),
        file: t.file.clone(),
        line,
    }
}
