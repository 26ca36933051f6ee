//! `[[gauge]]` and `[gauges]`.

use super::super::faults::Collector;
use super::super::raw_job::{RawGauge, RawGauges};
use super::super::spanned_value::SpannedValue;
use super::super::types::{JobGauge, NamedFile, StatedPlace};
use crate::fe::strain_tensor::Surface;
use crate::gauge::{Bridge, Rosette};
use crate::host::fault::{Fault, FaultList};
use crate::placement::Role;

/// Surfaces by their names in a job.
pub(super) const SURFACES: [(&str, Surface); 2] =
    [("top", Surface::Top), ("bottom", Surface::Bottom)];
/// Rosettes by their names in a job.
pub(super) const ROSETTES: [(&str, Rosette); 2] = [
    ("rectangular", Rosette::Rectangular),
    ("delta", Rosette::Delta),
];
const ROLES: [(&str, Role); 3] = [
    ("estimate", Role::Estimate),
    ("validation", Role::Validation),
    ("reserve", Role::Validation),
];
const POINTS: [(&str, u8); 4] = [("C", 0), ("D", 1), ("E", 2), ("F", 3)];

/// Returns the wirings by their names.
pub(super) fn bridges() -> [(&'static str, Bridge); 4] {
    Bridge::ALL.map(|b| (b.name(), b))
}

fn find_choice<T: Copy>(word: &str, choices: &[(&str, T)]) -> Option<T> {
    choices
        .iter()
        .find(|c| c.0.eq_ignore_ascii_case(word))
        .map(|c| c.1)
}

/// Returns the surface of the name `top` or `bottom`.
pub(crate) fn surface_from(word: &str) -> Option<Surface> {
    find_choice(word, &SURFACES)
}

/// Returns a wiring by its name. `full` and `half` stand for the bending bridges.
pub(crate) fn bridge_from(name: &str) -> Option<Bridge> {
    match name {
        "full" => Some(Bridge::FullBending),
        "half" => Some(Bridge::HalfBending),
        _ => Bridge::from_name(name),
    }
}

/// Returns the rosette of the name `rectangular` or `delta`.
pub(crate) fn rosette_from(word: &str) -> Option<Rosette> {
    find_choice(word, &ROSETTES)
}

/// Returns the role with this name: `estimate`, `validation` or `reserve`.
pub(crate) fn role_from(word: &str) -> Option<Role> {
    find_choice(word, &ROLES)
}

/// Returns the recovery point C, D, E or F as 0 to 3.
pub(crate) fn point_from(word: &str) -> Option<u8> {
    find_choice(word, &POINTS)
}

pub(super) fn gauge_file(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawGauges>>,
) -> Option<NamedFile> {
    let section = raw?;
    c.require(
        &section.value().file,
        section,
        "gauges.file",
        "file = \"gauges.csv\"",
    )?;
    c.named_file(&section.value().file, "gauges.file")
}

pub(super) fn gauges(c: &mut Collector, raw: &[SpannedValue<RawGauge>]) -> Vec<JobGauge> {
    raw.iter().filter_map(|g| gauge(c, g)).collect()
}

fn gauge(c: &mut Collector, section: &SpannedValue<RawGauge>) -> Option<JobGauge> {
    let raw = section.value();
    let name = c.require(&raw.name, section, "gauge.name", "name = \"14\"");
    let number = |v: &Option<SpannedValue<u32>>| v.as_ref().map(|v| *v.value());
    let cid = number(&raw.cid).unwrap_or(0);
    let point = raw
        .point
        .as_ref()
        .and_then(|p| c.choose_at(p, "gauge.point", &POINTS));
    let station = c.number(&raw.station, "gauge.station", STATION, is_station);
    if let (Some(stated), None) = (&raw.station, &raw.point) {
        let line = c.line(stated);
        c.faults.push(Fault::with_line(
            c.file,
            line,
            "gauge.station",
            STATION_ALONE,
            POINT_STATED,
        ));
    }
    let position = raw.position.as_ref().map(|p| *p.value());
    if let (Some(stated), None, Some(_)) = (&raw.point, &raw.element, position) {
        let line = c.line(stated);
        c.faults.push(Fault::with_line(
            c.file,
            line,
            "gauge.point",
            POINT_ALONE,
            ELEMENT_STATED,
        ));
    }
    let place = match (number(&raw.element), position) {
        (Some(element), _) => match point {
            Some(point) => StatedPlace::BeamPoint {
                element,
                point,
                station: station.unwrap_or(0.0),
            },
            None => StatedPlace::Element(element),
        },
        (None, Some(p)) => StatedPlace::Position(p, cid),
        (None, None) => StatedPlace::Unstated,
    };
    let surface = raw
        .surface
        .as_ref()
        .and_then(|s| c.choose_at(s, "gauge.surface", &SURFACES));
    let surface2 = raw
        .surface2
        .as_ref()
        .and_then(|s| c.choose_at(s, "gauge.surface2", &SURFACES));
    let mut words = bridges().to_vec();
    words.extend([("half", Bridge::HalfBending), ("full", Bridge::FullBending)]);
    let bridge = c.choose(&raw.bridge, "gauge.bridge", &words, Bridge::Quarter);
    let rosette = raw
        .rosette
        .as_ref()
        .and_then(|r| c.choose_at(r, "gauge.rosette", &ROSETTES));
    let role = c.choose(&raw.role, "gauge.role", &ROLES, Role::Estimate);
    let gauge = JobGauge {
        name: name?,
        place,
        position,
        surface: surface.unwrap_or(Surface::Top),
        surface_stated: surface.is_some(),
        direction: raw.direction.as_ref().map(|d| *d.value()),
        cid,
        angle_deg: c
            .number(&raw.angle_deg, "gauge.angle_deg", "a number", |_| true)
            .unwrap_or(0.0),
        bridge,
        bridge_factor: raw.bridge_factor.as_ref().map_or(1.0, |b| *b.value()),
        grid_length: c
            .at_least_zero(&raw.grid_length, "gauge.grid_length")
            .unwrap_or(0.0),
        pair: None,
        rosette,
        transverse_sensitivity: c
            .number(
                &raw.transverse_sensitivity,
                "gauge.transverse_sensitivity",
                KT,
                is_kt,
            )
            .unwrap_or(0.0),
        role,
        member: String::new(),
        file: c.file.to_owned(),
        line: c.line(section),
    };
    let gauge = with_pair(gauge, number(&raw.element2), surface2, c.faults);
    check_gauge(&gauge, c.faults);
    Some(gauge)
}

/// Message on a bridge whose two pairs are at one place.
pub const SAME_SIDE: &str = "both pairs are on the same side of the same element";
/// Remedy of [`SAME_SIDE`].
pub const SAME_SIDE_REMEDY: &str = "give the opposite side as `surface2`, or another `element2`";

/// Returns the gauge with its second pair. The model determines the default of `surface2`. If only `surface2` is stated, the default of `element2` is
/// the element of the gauge.
pub(crate) fn with_pair(
    gauge: JobGauge,
    element2: Option<u32>,
    surface2: Option<Surface>,
    faults: &mut FaultList,
) -> JobGauge {
    let own = match gauge.place {
        StatedPlace::Element(id) => Some(id),
        _ => None,
    };
    let pair = match (element2, surface2, own) {
        (Some(id), ..) => Some((id, surface2)),
        (None, Some(_), Some(id)) => Some((id, surface2)),
        (None, ..) => None,
    };
    let mut fault = |wrong: &str, remedy: &str| {
        let wrong = format!("gauge `{}`: {wrong}", gauge.name);
        faults.push(Fault::with_line(
            &*gauge.file,
            gauge.line,
            "surface2",
            wrong,
            remedy,
        ));
    };
    if surface2.is_some() && pair.is_none() {
        fault(
            "`surface2` needs the element of the second pair",
            "give `element2`, or delete `surface2`: the second pair is then on the opposite side",
        );
    }
    // Without a stated side, a stated point may determine the side.
    let by_point = !gauge.surface_stated && gauge.position.is_some();
    if own.is_some() && !by_point && pair == own.map(|id| (id, Some(gauge.surface))) {
        fault(SAME_SIDE, SAME_SIDE_REMEDY);
    }
    JobGauge { pair, ..gauge }
}

/// Fault of a station without a `point`.
pub(in crate::job) const STATION_ALONE: &str =
    "a station is a place along a bar or beam, and the gauge states no `point`";
/// Remedy of [`STATION_ALONE`].
pub(in crate::job) const POINT_STATED: &str =
    "state `point` (C, D, E or F) of a bar or beam, or delete `station`";

/// Fault of a recovery point at a position.
pub(in crate::job) const POINT_ALONE: &str =
    "a recovery point is on a bar or beam, and the gauge states a position without its `element`";
/// Remedy of [`POINT_ALONE`].
pub(in crate::job) const ELEMENT_STATED: &str =
    "state `element`, a bar or beam; on a shell delete `point`";

/// Shares of a bar's length.
const STATION: &str = "0 (end A) to 1 (end B)";

fn is_station(x: f64) -> bool {
    (0.0..=1.0).contains(&x)
}

/// Transverse sensitivities: makers state a few percent.
const KT: &str = "a fraction between -0.5 and 0.5";

fn is_kt(x: f64) -> bool {
    x.abs() < 0.5
}

/// Checks the values of a gauge of the job or of a table, and adds faults.
pub(crate) fn check_gauge(g: &JobGauge, faults: &mut FaultList) {
    let mut fault = |field: &str, wrong: &str, remedy: &str| {
        faults.push(Fault::with_line(
            &*g.file,
            g.line,
            field,
            format!("gauge `{}`: {wrong}", g.name),
            remedy,
        ));
    };
    if g.name.is_empty() {
        fault("name", "the name is blank", "name every gauge");
    }
    if let Some(d) = g.direction
        && !(d.iter().all(|x| x.is_finite()) && d.iter().any(|x| *x != 0.0))
    {
        fault(
            "direction",
            "the direction has no length",
            "give a vector such as [1, 0, 0]",
        );
    }
    if !(g.bridge_factor.is_finite() && g.bridge_factor != 0.0) {
        fault(
            "bridge_factor",
            "must be a number other than 0",
            "give the factor that readings were divided by; default 1",
        );
    }
    if !(g.grid_length.is_finite() && g.grid_length >= 0.0) {
        fault(
            "grid_length",
            "must be 0 or more",
            "give the gauge's grid length in job units",
        );
    }
    if let StatedPlace::BeamPoint { station, .. } = g.place
        && !is_station(station)
    {
        let wrong = format!("`{station}`, expected {STATION}");
        fault("station", &wrong, "give x/xb, a share of the length");
    }
    if !is_kt(g.transverse_sensitivity) {
        let wrong = format!("`{}`, expected {KT}", g.transverse_sensitivity);
        fault(
            "transverse_sensitivity",
            &wrong,
            "give Kt as a fraction: 0.03 for 3 percent",
        );
    }
    let bending = matches!(g.bridge, Bridge::HalfBending | Bridge::FullBending);
    let on_element = matches!(
        g.place,
        StatedPlace::Element(_) | StatedPlace::BeamPoint { .. }
    );
    if g.pair.is_some() && !bending && g.bridge != Bridge::Shear {
        fault(
            "element2",
            "a quarter bridge has no second pair",
            "delete `element2` and `surface2`, or set `bridge`",
        );
    }
    if g.rosette.is_some() && g.bridge != Bridge::Quarter {
        fault(
            "rosette",
            "a rosette's legs are quarter bridges",
            "delete `bridge` or `rosette`",
        );
    }
    if matches!(g.place, StatedPlace::Position(..)) && g.pair.is_some() && !on_element {
        fault(
            "element2",
            "the gauge states a position",
            "give `element` for the first pair too",
        );
    }
}
