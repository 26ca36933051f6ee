//! `[vehicle]`, `[reconcile]`, `[sensitivity]`.

use super::super::faults::Collector;
use super::super::raw_job::{
    RawCorrection, RawEdit, RawEffect, RawReconcile, RawSensitivity, RawVehicle, S,
};
use super::super::shapes::Texts;
use super::super::spanned_value::SpannedValue;
use super::super::types::*;
use super::units::units;
use crate::gauge::Bridge;
use crate::units::{ReportUnits, UnitSystem};
use crate::vehicle::adjustment::{Lag, Slip};
use crate::vehicle::chassis::LeafSeat;
use crate::vehicle::preset::MODELS;
use std::collections::BTreeMap;

/// No known parameter of a vehicle is larger in any system of units: the stiffness of a steel block is some 1e12 N/m.
const LARGEST_KNOWN: f64 = 1e15;

/// Known faults of a channel.
fn correction(c: &mut Collector, channel: &str, r: &RawCorrection) -> ChannelCorrection {
    let key = |k: &str| format!("vehicle.corrections.{channel}.{k}");
    let gain = match r.gain.as_ref() {
        Some(g) if *g.value() == 0.0 || !g.value().is_finite() => {
            c.fault(
                g,
                &key("gain"),
                "a gain of 0 is not valid: readings are divided by it".to_owned(),
                "write reading over truth, such as 1.05, or -1 for a reversed sign",
            );
            1.0
        }
        Some(g) => *g.value(),
        None => 1.0,
    };
    let mut number = |v: &S<f64>, k: &str| c.number(v, &key(k), "a finite number", |_| true);
    let delay_s = number(&r.delay_s, "delay_s").unwrap_or(0.0);
    let clock_ppm = number(&r.clock_ppm, "clock_ppm").unwrap_or(0.0);
    let at_s = number(&r.slip_at_s, "slip_at_s");
    let by_s = number(&r.slip_s, "slip_s");
    let slip = match (&r.slip_at_s, &r.slip_s) {
        (Some(_), Some(_)) => at_s.zip(by_s).map(|(at_s, by_s)| Slip { at_s, by_s }),
        (Some(one), None) | (None, Some(one)) => {
            c.fault(
                one,
                &key("slip_s"),
                "a slip has a time and a size, and one of them is missing".to_owned(),
                "state `slip_at_s` and `slip_s`",
            );
            None
        }
        (None, None) => None,
    };
    let order = match r.low_pass_order.as_ref() {
        Some(o) if !matches!(*o.value(), 1 | 2) => {
            c.fault(
                o,
                &key("low_pass_order"),
                format!("`{}`, expected 1 or 2", o.value()),
                "write 1, or 2 for Butterworth's",
            );
            1
        }
        Some(o) => *o.value(),
        None => 1,
    };
    let time_s = c.at_least_zero(&r.low_pass_s, &key("low_pass_s"));
    ChannelCorrection {
        gain,
        delay_s,
        clock_ppm,
        slip,
        lag: time_s.map(|time_s| Lag { order, time_s }),
        line_hz: c.positive_number(&r.line_hz, &key("line_hz")),
    }
}

pub(super) fn vehicle(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawVehicle>>,
) -> Option<Vehicle> {
    let section = raw?;
    let raw = section.value();
    let model = c.require(&raw.model, section, "vehicle.model", "model = \"front2\"");
    c.choose(&raw.model, "vehicle.model", &MODELS.map(|m| (m, ())), ());
    let data = c.require(&raw.data, section, "vehicle.data", "data = \"data.csv\"");
    let noise = raw.noise.as_ref();
    let tolerance = raw.tolerance.as_ref();
    let band_hz = raw.band_hz.as_ref().and_then(|b| {
        let [low, high] = *b.value();
        if 0.0 <= low && low < high {
            return Some([low, high]);
        }
        c.fault(
            b,
            "vehicle.band_hz",
            format!("[{low}, {high}] is not a band"),
            "write [low, high] in Hz, such as [0.7, 20.0]",
        );
        None
    });
    let mut noise_acc = None;
    let mut noise_force = None;
    if let Some(n) = noise {
        noise_acc = c.at_least_zero(&n.acc, "vehicle.noise.acc");
        noise_force = c.at_least_zero(&n.force, "vehicle.noise.force");
    }
    let mut gain = None;
    let mut sync = None;
    if let Some(t) = tolerance {
        gain = c.fraction(&t.gain, "vehicle.tolerance.gain");
        sync = c.at_least_zero(&t.sync, "vehicle.tolerance.sync");
    }
    let sample_rate = c.positive_number(&raw.sample_rate, "vehicle.sample_rate");
    let corrections = (raw.corrections.iter())
        .map(|(channel, r)| (channel.clone(), correction(c, channel, r)))
        .collect();
    let mass_change = raw.mass_change.as_ref().and_then(|m| {
        let at_key = "vehicle.mass_change.at_s";
        c.require(&m.at_s, section, at_key, "at_s = 30.0")?;
        let at = c.number(&m.at_s, at_key, "a finite number", |_| true)?;
        Some(MassChange {
            body: m
                .body
                .as_ref()
                .map_or_else(|| "b".to_owned(), |b| b.value().clone()),
            at_s: at,
            over_s: c
                .at_least_zero(&m.over_s, "vehicle.mass_change.over_s")
                .unwrap_or(0.0),
            weight: m.weight.as_ref().is_none_or(|w| *w.value()),
        })
    });
    let leaf = seats(c, section);
    let input = raw.input.as_ref().and_then(|at| match at.value() {
        Texts::Many(names) => Some(SimulationInput::Channels(names.clone())),
        Texts::One(word) => {
            let at = SpannedValue::new(at.span(), word.clone());
            let kind = c.choose_at(&at, "vehicle.input", &InputKind::WORDS);
            kind.map(SimulationInput::Kind)
        }
    });
    numbers(c, section);
    if let (Some(data), Some(at)) = (&raw.data, &raw.hold_out)
        && data.value() == at.value()
    {
        let wrong = "this is the data file itself: no data would remain to be held out";
        let remedy = "name a record that is not fitted, or delete this key";
        c.fault(at, "vehicle.hold_out", wrong, remedy);
    }
    model.as_ref().zip(data.as_ref())?;
    Some(Vehicle {
        model: model?,
        terms: raw.terms.as_ref().map_or_else(Vec::new, |t| {
            t.value().iter().map(|w| w.value().clone()).collect()
        }),
        data: c.named_file(&raw.data, "vehicle.data")?,
        input,
        hold_out: c.named_file(&raw.hold_out, "vehicle.hold_out"),
        sample_rate,
        known: raw.known.clone(),
        noise_acc,
        noise_force,
        tolerance_gain: gain,
        tolerance_sync: sync,
        band_hz,
        columns: raw.columns.clone(),
        places: raw.places.clone(),
        bounds: raw.bounds.clone(),
        corrections,
        mass_change,
        leaf,
        line: c.line(section),
    })
}

/// Returns the seats of the axles on their leaf springs, by link.
fn seats(c: &mut Collector, section: &SpannedValue<RawVehicle>) -> BTreeMap<String, LeafSeat> {
    let mut leaf = BTreeMap::new();
    for (link, r) in &section.value().leaf {
        let key = |k: &str| format!("vehicle.leaf.{}.{k}", link.value());
        for (value, k) in [
            (&r.hanger_to_axle, "hanger_to_axle"),
            (&r.axle_to_shackle, "axle_to_shackle"),
        ] {
            c.require(value, section, &key(k), &format!("{k} = 0.7"));
        }
        let seat = LeafSeat {
            hanger_to_axle: c
                .positive_number(&r.hanger_to_axle, &key("hanger_to_axle"))
                .unwrap_or(1.0),
            axle_to_shackle: c
                .positive_number(&r.axle_to_shackle, &key("axle_to_shackle"))
                .unwrap_or(1.0),
            shackle_angle_rad: c
                .number(
                    &r.shackle_angle_deg,
                    &key("shackle_angle_deg"),
                    "an angle between -80 and 80 degrees",
                    |a| a.abs() <= 80.0,
                )
                .unwrap_or(0.0)
                .to_radians(),
        };
        leaf.insert(link.value().clone(), seat);
    }
    leaf
}

/// Refuses known parameters, limits and places that no vehicle has.
fn numbers(c: &mut Collector, section: &SpannedValue<RawVehicle>) {
    let raw = section.value();
    let none = |v: &f64| v.is_nan() || v.abs() > LARGEST_KNOWN;
    for (name, v) in raw.known.iter().filter(|(_, v)| none(v)) {
        c.fault(
            section,
            &format!("vehicle.known.{name}"),
            format!("`{v:e}` is not a mass, stiffness or damping of a vehicle"),
            "correct the number; it counts in the units of the job",
        );
    }
    for (name, [low, high]) in &raw.bounds {
        // An infinite limit means no limit.
        let none = |v: f64, open: f64| v.is_nan() || v != open && v.abs() > LARGEST_KNOWN;
        let wrong = if none(*low, f64::NEG_INFINITY) || none(*high, f64::INFINITY) {
            format!(
                "[{low:e}, {high:e}] are not limits of a mass, stiffness or damping of a vehicle"
            )
        } else if low >= high {
            format!("[{low}, {high}] leaves nothing between its limits")
        } else {
            continue;
        };
        c.fault(
            section,
            &format!("vehicle.bounds.{name}"),
            wrong,
            "write [low, high] in the units of the job, such as [0.0, 1e6]; `inf` if there is no limit; put exactly known values in `known`",
        );
    }
    let far = |x: &f64| !(x.abs() <= LARGEST_KNOWN);
    for (place, _) in raw.places.iter().filter(|p| p.1.iter().any(far)) {
        c.fault(
            section,
            &format!("vehicle.places.{place}"),
            "this place is not on a vehicle",
            "write [x, y] in the job's unit of length",
        );
    }
}

pub(super) fn reconcile(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawReconcile>>,
) -> Option<Reconcile> {
    let section = raw?;
    let raw = section.value();
    c.require(&raw.path, section, "reconcile.path", "path = \"static\"");
    let paths = [
        ("static", ReconcilePath::Static),
        ("dynamic", ReconcilePath::Dynamic),
    ];
    let effects = match raw.effects.as_ref().map(|e| (e, e.value())) {
        None => None,
        Some((_, Texts::Many(list))) => Some(list.clone()),
        Some((at, Texts::One(word))) => {
            c.choose_at(
                &SpannedValue::new(at.span(), word.clone()),
                "reconcile.effects",
                &[("all", ())],
            );
            None
        }
    };
    let bridges: Vec<(&str, ())> = Bridge::ALL
        .into_iter()
        .map(|b| (b.name(), ()))
        .chain([("full", ()), ("half", ())])
        .collect();
    for bridge in raw.thermal.keys() {
        c.choose_at(bridge, "reconcile.thermal_microstrain_per_degC", &bridges);
    }
    let gluing = raw.tolerance.as_ref();
    let angle = gluing.and_then(|t| c.at_least_zero(&t.angle_deg, "reconcile.tolerance.angle_deg"));
    let place =
        gluing.and_then(|t| c.at_least_zero(&t.position_mm, "reconcile.tolerance.position_mm"));
    Some(Reconcile {
        path: c.choose(&raw.path, "reconcile.path", &paths, ReconcilePath::Static),
        zones: raw.zones.clone(),
        places: raw.places.clone(),
        thermal_microstrain_per_degc: raw
            .thermal
            .iter()
            .map(|(k, v)| (k.value().clone(), *v))
            .collect(),
        temperature_set: raw.temperature_set,
        effects,
        joints: raw.joints.clone(),
        causes: raw.causes.clone(),
        angle_tolerance_deg: angle,
        position_tolerance_mm: place,
        described: raw
            .effect
            .iter()
            .filter_map(|e| resolve_effect(c, e))
            .collect(),
        line: c.line(section),
    })
}

/// Resolves an effect that the user describes by a table or by an edit of the deck.
fn resolve_effect(c: &mut Collector, entry: &SpannedValue<RawEffect>) -> Option<DescribedEffect> {
    let raw = entry.value();
    c.require(
        &raw.id,
        entry,
        "reconcile.effect.id",
        "id = \"bracket_loose\"",
    )?;
    let source = match (&raw.signature, &raw.edit) {
        (Some(_), None) => {
            EffectSource::Signature(c.named_file(&raw.signature, "reconcile.effect.signature")?)
        }
        (
            None,
            Some(RawEdit {
                property: Some(property),
                thickness_scale: Some(factor),
                cbush: None,
                stiffness_scale: None,
            }),
        ) => EffectSource::Thickness {
            property: *property,
            factor: *factor,
        },
        (
            None,
            Some(RawEdit {
                property: None,
                thickness_scale: None,
                cbush: Some(element),
                stiffness_scale: Some(factor),
            }),
        ) => EffectSource::Bush {
            element: *element,
            factor: *factor,
        },
        _ => {
            c.fault(
                entry,
                "reconcile.effect",
                "the entry has neither a `signature` nor one complete `edit`",
                "give signature = \"change.csv\", edit = { property = 14, thickness_scale = 0.9 } or edit = { cbush = 77, stiffness_scale = 0.5 }",
            );
            return None;
        }
    };
    let prior = if raw.prior.is_some() {
        c.positive_number(&raw.prior, "reconcile.effect.prior")?
    } else {
        1.0
    };
    let id = raw.id.as_ref().map(|i| i.value().clone())?;
    Some(DescribedEffect {
        id,
        source,
        prior,
        line: c.line(entry),
    })
}

pub(super) fn sensitivity(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawSensitivity>>,
    system: UnitSystem,
) -> Option<GivenSensitivity> {
    let section = raw?;
    let raw = section.value();
    c.require(
        &raw.file,
        section,
        "sensitivity.file",
        "file = \"A_vertical.csv\"",
    )?;
    let signatures = raw
        .signatures
        .as_ref()
        .map_or_else(Signatures::default, |s| Signatures {
            lateral_wheel_loads: c.named_file(
                &s.lateral_wheel_loads,
                "sensitivity.signatures.lateral_wheel_loads",
            ),
            thermal: c.named_file(&s.thermal, "sensitivity.signatures.thermal"),
            payload: c.named_file(&s.payload, "sensitivity.signatures.payload"),
            unaccounted_mass: c.named_file(
                &s.unaccounted_mass,
                "sensitivity.signatures.unaccounted_mass",
            ),
            gauge_angle: c.named_file(&s.gauge_angle, "sensitivity.signatures.gauge_angle"),
            rail_stiffness: s
                .rail_stiffness
                .iter()
                .map(|(zone, f)| {
                    (
                        zone.clone(),
                        c.named_at(f, &format!("sensitivity.signatures.rail_stiffness.{zone}")),
                    )
                })
                .collect(),
        });
    let mut columns: Vec<_> = raw.columns.iter().collect();
    columns.sort_by_key(|(k, _)| k.span().start);
    Some(GivenSensitivity {
        file: c.named_file(&raw.file, "sensitivity.file")?,
        per: units(
            c,
            raw.per.as_ref(),
            ReportUnits::from_system(system),
            "sensitivity.per",
        ),
        columns: columns
            .into_iter()
            .map(|(k, v)| (k.value().clone(), v.value().clone()))
            .collect(),
        signatures,
        covariance: c.named_file(&raw.covariance, "sensitivity.covariance"),
        common_zero: c.named_file(&raw.common_zero, "sensitivity.common_zero"),
        range: ranges(c, &raw.range, "sensitivity.range"),
        strain_range: ranges(c, &raw.strain_range, "sensitivity.strain_range"),
        line: c.line(section),
    })
}

/// Ranges by name; a fault for each that is not two finite ascending numbers.
fn ranges(
    c: &mut Collector,
    raw: &BTreeMap<SpannedValue<String>, [f64; 2]>,
    key: &str,
) -> BTreeMap<String, [f64; 2]> {
    let mut out = BTreeMap::new();
    for (name, [low, high]) in raw {
        if low.is_finite() && high.is_finite() && low <= high {
            out.insert(name.value().clone(), [*low, *high]);
        } else {
            c.fault(
                name,
                key,
                format!("[{low}, {high}] is not a range"),
                "write the smallest and the largest value of the calibration: [0, 12]",
            );
        }
    }
    out
}
