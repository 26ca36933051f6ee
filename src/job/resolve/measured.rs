//! `[measured]`, `[runs]`, `[ballast]`, `[payload]`, `[recover]`, `[respond]`.

use super::super::faults::Collector;
use super::super::raw_job::{
    RawBallast, RawFleet, RawMeasured, RawPayload, RawRecover, RawRespond, RawRuns, S,
};
use super::super::shapes::{NumberOrNumbers, NumberOrWord, Texts};
use super::super::spanned_value::SpannedValue;
use super::super::types::*;
use super::placement::DEFAULT_NOISE_MICROSTRAIN;
use super::units::{stated_quantities, units};
use crate::payload::Place;
use crate::reconcile::strain::WheelForces;
use crate::series::rainflow::MeanStress;
use crate::series::record::seconds_in;
use crate::units::{ReportUnits, STANDARD_GRAVITY_M_S2};

/// Elements that `respond` reports if the job states no number.
const DEFAULT_HOTTEST: usize = 20;
/// Power of the load range in pseudo-damage if the job states none: usual for welded and cast parts of vehicles.
const DEFAULT_SLOPE: f64 = 5.0;

/// Resolves `[measured]`. With `[fleet]`, the records of the fleet replace the strain file.
pub(super) fn resolve_measured(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawMeasured>>,
    fleet: Option<&SpannedValue<RawFleet>>,
) -> Option<Measured> {
    let section = raw?;
    let raw = section.value();
    let reference = match raw.reference.as_ref().map(|r| (r, r.value())) {
        None => Reference::None,
        Some((_, NumberOrWord::Number(n))) if *n >= 1.0 && n.fract() == 0.0 => {
            Reference::Subcase(*n as u32)
        }
        Some((_, NumberOrWord::Word(w))) if w == "none" => Reference::None,
        Some((_, NumberOrWord::Word(w))) if w == "gravity" => Reference::Gravity,
        Some((at, _)) => {
            let wrong = "expected \"none\", \"gravity\" or the number of a subcase";
            c.fault(at, "measured.reference", wrong, "write one of these");
            Reference::None
        }
    };
    let hold_out = match raw.hold_out.as_ref().map(|h| (h, h.value())) {
        None => HoldOut::None,
        Some((_, Texts::Many(runs))) => HoldOut::Runs(runs.clone()),
        Some((at, Texts::One(file))) => HoldOut::File(NamedFile {
            given: file.clone(),
            key: "measured.hold_out".into(),
            line: c.line(at),
        }),
    };
    let strain = match (&raw.strain, fleet) {
        (None, Some(_)) => NamedFile {
            given: String::new(),
            key: "measured.strain".into(),
            line: c.line(section),
        },
        _ => {
            c.require(
                &raw.strain,
                section,
                "measured.strain",
                "strain = \"strain.csv\"",
            )?;
            c.named_file(&raw.strain, "measured.strain")?
        }
    };
    if let (Some(at), Some(_)) = (&raw.zero_runs, &raw.zero) {
        let wrong = "the section has both `zero` and `zero_runs`";
        c.fault(at, "measured.zero_runs", wrong, "state one of the two");
    }
    let own = |other: &NamedFile| other.given == strain.given;
    let zero = c.named_file(&raw.zero, "measured.zero");
    if let (Some(at), Some(_)) = (&raw.zero, zero.as_ref().filter(|z| own(z))) {
        let wrong = "this is the strain file itself: loads would be differences from their mean";
        let remedy = "name a file measured without load, or delete this key";
        c.fault(at, "measured.zero", wrong, remedy);
    }
    if let (Some(at), HoldOut::File(_)) = (&raw.hold_out, &hold_out)
        && matches!(&hold_out, HoldOut::File(file) if own(file))
    {
        let wrong = "this is the strain file itself: no run would remain to be held out";
        let remedy = "name runs of it, or another file";
        c.fault(at, "measured.hold_out", wrong, remedy);
    }
    let zero_runs = raw.zero_runs.as_ref().map_or_else(Vec::new, |list| {
        let names = list.value().iter();
        names.map(|w| w.value().clone()).collect()
    });
    let (noise_microstrain, noise_by_gauge) = noise(c, &raw.noise_microstrain);
    Some(Measured {
        strain,
        zero_runs,
        zero,
        reference,
        noise_microstrain,
        noise_by_gauge,
        noise_correlation: c
            .number(
                &raw.noise_correlation,
                "measured.noise_correlation",
                "a number from 0 to less than 1",
                |x| (0.0..1.0).contains(&x),
            )
            .unwrap_or(0.0),
        states_noise: raw.noise_microstrain.is_some(),
        model_uncertainty_rel: c
            .fraction(&raw.model_uncertainty_rel, "measured.model_uncertainty_rel")
            .unwrap_or(0.0),
        hold_out,
        time_unit_s: time_unit(c, &raw.time_unit, "measured.time_unit"),
        line: c.line(section),
    })
}

/// Noise in the root mean square over the gauges, and of each gauge where the job states it by gauge.
fn noise(c: &mut Collector, raw: &S<NumberOrNumbers>) -> (f64, Vec<(String, f64)>) {
    let mut by_gauge = Vec::new();
    let Some(raw) = raw else {
        return (DEFAULT_NOISE_MICROSTRAIN, by_gauge);
    };
    let mut check = |x: f64| {
        let one = Some(SpannedValue::new(raw.span(), x));
        c.positive_number(&one, "measured.noise_microstrain")
    };
    match raw.value() {
        NumberOrNumbers::One(x) => (check(*x).unwrap_or(DEFAULT_NOISE_MICROSTRAIN), by_gauge),
        NumberOrNumbers::ByName(all) => {
            for (name, x) in all {
                by_gauge.extend(check(*x).map(|x| (name.clone(), x)));
            }
            let squares: f64 = by_gauge.iter().map(|(_, x)| x * x).sum();
            match by_gauge.len() {
                0 => (DEFAULT_NOISE_MICROSTRAIN, by_gauge),
                n => ((squares / n as f64).sqrt(), by_gauge),
            }
        }
    }
}

/// Returns the length in seconds of the unit of time that a key states.
pub(super) fn time_unit(c: &mut Collector, raw: &S<String>, key: &str) -> Option<f64> {
    let units = ["s", "ms", "us", "min", "h", "d"];
    let units = units.map(|unit| (unit, seconds_in(unit).unwrap_or(1.0)));
    c.choose_at(raw.as_ref()?, key, &units)
}

pub(super) fn runs(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawRuns>>,
    default: ReportUnits,
) -> Option<Runs> {
    let section = raw?;
    let raw = section.value();
    c.require(&raw.file, section, "runs.file", "file = \"runs.csv\"")?;
    let noise = raw
        .noise
        .as_ref()
        .map_or(RunNoise::default(), |n| RunNoise {
            force: c.at_least_zero(&n.force, "runs.noise.force"),
            moment: c.at_least_zero(&n.moment, "runs.noise.moment"),
            mass: c.at_least_zero(&n.mass, "runs.noise.mass"),
            length: c.at_least_zero(&n.length, "runs.noise.length"),
        });
    let sources = [
        ("measured", WheelForces::Measured),
        ("flat_ground_model", WheelForces::FlatGroundModel),
    ];
    let wheel_forces = c.choose(
        &raw.wheel_forces,
        "runs.wheel_forces",
        &sources,
        WheelForces::Measured,
    );
    if let (Some(ground), WheelForces::Measured) = (&raw.ground, wheel_forces) {
        c.fault(
            ground,
            "runs.ground",
            "measured wheel forces already contain the effect of the ground",
            "write `wheel_forces = \"flat_ground_model\"` as well, or delete this key",
        );
    }
    Some(Runs {
        file: c.named_file(&raw.file, "runs.file")?,
        section: "runs",
        columns: raw
            .columns
            .iter()
            .map(|(k, v)| (k.value().clone(), v.value().clone()))
            .collect(),
        units: units(c, raw.units.as_ref(), default, "runs.units"),
        stated_units: stated_quantities(raw.units.as_ref()),
        noise,
        wheel_forces,
        ground: c.positive_number(&raw.ground, "runs.ground"),
        line: c.line(section),
    })
}

fn region(c: &mut Collector, raw: &S<Vec<[f64; 2]>>, key: &str) -> Option<Region> {
    let value = raw.as_ref()?;
    let axes = value.value();
    if !(2..=3).contains(&axes.len()) {
        c.fault(
            value,
            key,
            format!("{} ranges, expected 2 or 3", axes.len()),
            "write [[x0, x1], [y0, y1]]",
        );
        return None;
    }
    if axes.iter().any(|[a, b]| !(a <= b)) {
        c.fault(
            value,
            key,
            "a range begins above its end",
            "write low before high",
        );
        return None;
    }
    Some(axes.clone())
}

pub(super) fn ballast(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawBallast>>,
) -> Option<Ballast> {
    let section = raw?;
    let raw = section.value();
    Some(Ballast {
        masses: c.count(&raw.masses, "ballast.masses").unwrap_or(1),
        region: region(c, &raw.region, "ballast.region"),
        properties: raw.properties.as_ref().map(|p| p.value().clone()),
        max_mass: c.positive_number(&raw.max_mass, "ballast.max_mass"),
        run: raw.run.as_ref().map(|r| r.value().clone()),
        gravity_m_s2: gravity(c, &raw.gravity, "ballast.gravity"),
        line: c.line(section),
    })
}

pub(super) fn payload(
    c: &mut Collector,
    raw: Option<&SpannedValue<RawPayload>>,
) -> Option<Payload> {
    let section = raw?;
    let raw = section.value();
    let positions = [("known", Place::Known), ("free", Place::Free)];
    let (mut use_strain, mut use_reactions) = (true, true);
    if let Some(list) = &raw.sources {
        let words: Vec<&str> = list
            .value()
            .iter()
            .filter_map(|w| {
                c.choose_at(
                    w,
                    "payload.use",
                    &[("strain", "strain"), ("reactions", "reactions")],
                )
            })
            .collect();
        use_strain = words.contains(&"strain");
        use_reactions = words.contains(&"reactions");
        if list.value().is_empty() {
            c.fault(
                list,
                "payload.use",
                "the list is empty",
                "name `strain`, `reactions` or both",
            );
        }
    }
    Some(Payload {
        grid: raw.grid.as_ref().map(|g| *g.value()),
        position: c.choose(&raw.position, "payload.position", &positions, Place::Known),
        gravity_m_s2: gravity(c, &raw.gravity, "payload.gravity"),
        weight_in_model: raw.weight_in_model.as_ref().is_none_or(|w| *w.value()),
        region: region(c, &raw.region, "payload.region"),
        use_strain,
        use_reactions,
        unloaded: raw.unloaded.as_ref().map(|r| r.value().clone()),
        nominal_x: c.number(&raw.nominal_x, "payload.nominal_x", "a number", |_| true),
        nominal_y: c.number(&raw.nominal_y, "payload.nominal_y", "a number", |_| true),
        line: c.line(section),
    })
}

/// Factor from standard gravity beyond which a gravity is not in m/s2. The factor is 28 on the Sun and a 1,700th on Phobos, where nobody measures. A
/// gravity in mm/s2 gives 1,000, in km/s2 a 1,000th.
const NOT_GRAVITY: f64 = 100.0;

/// Gravity, m/s^2 whatever the unit system of the job.
fn gravity(c: &mut Collector, given: &Option<SpannedValue<f64>>, key: &str) -> f64 {
    let stated = c
        .positive_number(given, key)
        .unwrap_or(STANDARD_GRAVITY_M_S2);
    let off = stated / STANDARD_GRAVITY_M_S2;
    if let Some(value) = given
        && !(1.0 / NOT_GRAVITY..NOT_GRAVITY).contains(&off)
    {
        c.fault(
            value,
            key,
            format!("{stated} m/s2 is {off:.2e} times the gravity of Earth"),
            "state it in m/s2, whatever the units of the job: gravity = 9.80665",
        );
    }
    stated
}

pub(super) fn respond(c: &mut Collector, raw: Option<&SpannedValue<RawRespond>>) -> Respond {
    let mut out = Respond {
        elements: None,
        hottest: DEFAULT_HOTTEST,
        loads: None,
        slope: None,
        mean_stress: MeanStress::None,
        fatigue_class: None,
        line: 0,
    };
    let Some(section) = raw else { return out };
    let raw = section.value();
    out.elements = raw.elements.as_ref().map(|e| e.value().clone());
    out.hottest = c
        .count(&raw.hottest, "respond.hottest")
        .unwrap_or(DEFAULT_HOTTEST);
    out.loads = c.named_file(&raw.loads, "respond.loads");
    out.slope = slope_of(c, &raw.slope, "respond.slope");
    out.mean_stress = mean_stress(c, section);
    out.fatigue_class = c.positive_number(&raw.fatigue_class, "respond.fatigue_class");
    if let (Some(at), None) = (&raw.fatigue_class, &raw.slope) {
        let wrong = "a share of life needs the power of the stress range";
        let remedy = "state `slope` in [respond], 3 for welds";
        c.fault(at, "respond.fatigue_class", wrong, remedy);
    }
    out.line = c.line(section);
    out
}

/// Correction for mean stress, with the parameter that it needs.
fn mean_stress(c: &mut Collector, section: &SpannedValue<RawRespond>) -> MeanStress {
    const RULES: [(&str, usize); 4] = [("none", 0), ("goodman", 1), ("swt", 2), ("sensitivity", 3)];
    let raw = section.value();
    let rule = c.choose(&raw.mean_stress, "respond.mean_stress", &RULES, 0);
    if let (Some(at), true, None) = (&raw.mean_stress, rule > 0, &raw.slope) {
        let wrong = "the correction needs the power of the stress range";
        c.fault(
            at,
            "respond.mean_stress",
            wrong,
            "state `slope` in [respond]",
        );
    }
    let ultimate = c.positive_number(&raw.ultimate, "respond.ultimate");
    let key = "respond.mean_sensitivity";
    let expected = "a number from 0 to below 1";
    let m = c.number(&raw.mean_sensitivity, key, expected, |m| {
        (0.0..1.0).contains(&m)
    });
    for (value, of, key) in [
        (&raw.ultimate, 1, "respond.ultimate"),
        (&raw.mean_sensitivity, 3, "respond.mean_sensitivity"),
    ] {
        match value {
            Some(at) if rule != of => {
                let wrong = format!("it belongs to mean_stress = \"{}\"", RULES[of].0);
                c.fault(at, key, wrong, "delete it, or correct `mean_stress`");
            }
            None if rule == of => {
                let example = if of == 1 {
                    "ultimate = 510"
                } else {
                    "mean_sensitivity = 0.3"
                };
                c.require(value, section, key, example);
            }
            _ => {}
        }
    }
    match (rule, ultimate, m) {
        (1, Some(ultimate), _) => MeanStress::Goodman { ultimate },
        (2, ..) => MeanStress::SmithWatsonTopper,
        (3, _, Some(m)) => MeanStress::Sensitivity { m },
        _ => MeanStress::None,
    }
}

/// Power of a range in pseudo-damage.
fn slope_of(c: &mut Collector, raw: &S<f64>, key: &str) -> Option<f64> {
    c.number(raw, key, "a number from 1 to 20", |x| {
        (1.0..=20.0).contains(&x)
    })
}

pub(super) fn recover(c: &mut Collector, raw: Option<&SpannedValue<RawRecover>>) -> Recover {
    let raw = raw.map(SpannedValue::value);
    let files = raw.and_then(|r| r.files.as_ref()).map(|list| {
        let words = list.value().iter();
        words
            .filter_map(|w| c.choose_at(w, "recover.files", &LoadFile::ALL))
            .collect()
    });
    let slope = raw.and_then(|r| slope_of(c, &r.slope, "recover.slope"));
    Recover {
        files,
        slope: slope.unwrap_or(DEFAULT_SLOPE),
        csv_every: raw
            .and_then(|r| c.count(&r.csv_every, "recover.csv_every"))
            .unwrap_or(1)
            .max(1),
        turning_points: raw.and_then(|r| {
            let (key, expected) = ("recover.turning_points", "a share from 0 to below 1");
            c.number(&r.turning_points, key, expected, |x| {
                (0.0..1.0).contains(&x)
            })
        }),
    }
}
