//! Reversed, exchanged and wrongly scaled channels of an independently simulated truck, and correct records on many roads.

use super::truck_simulator::{RATE_HZ, Readings, Truck, drive, roll_off};
use super::*;
use crate::finding::Severity;
use crate::series::channels::Channel;
use std::sync::OnceLock;

const G: f64 = 9.81;

/// The truck of the full model without its second axle.
fn two_axles() -> Truck {
    let mut truck = roll_off();
    truck.axles.remove(1);
    truck
}

fn record(list: Vec<(String, Vec<f64>)>) -> Channels {
    let channel = |(name, samples)| Channel {
        name,
        unit: String::new(),
        samples,
    };
    Channels::from_list(RATE_HZ, list.into_iter().map(channel).collect()).unwrap()
}

/// Returns the channels of accelerometers that do not measure gravity.
fn without_gravity(mut r: Channels) -> Channels {
    let accelerations = r.list.iter_mut().filter(|c| c.name.starts_with("a_"));
    accelerations.for_each(|c| c.samples.iter_mut().for_each(|v| *v -= G));
    r
}

fn front(r: &Readings) -> Channels {
    record(vec![
        ("a_body".into(), r.body[0].clone()),
        ("a_wheel".into(), r.hub[0].clone()),
        ("f_wheel".into(), r.force[0].clone()),
    ])
}

/// Combines both sides of two axles into one: the means of accelerations and the sums of forces.
fn half(r: &Readings) -> Channels {
    let joined = |x: &[Vec<f64>], axle: usize, share: f64| -> Vec<f64> {
        let sides = x[2 * axle].iter().zip(&x[2 * axle + 1]);
        sides.map(|(a, b)| share * (a + b)).collect()
    };
    let mut list = Vec::new();
    for (axle, name) in ["front", "rear"].into_iter().enumerate() {
        list.push((format!("a_body_{name}"), joined(&r.body, axle, 0.5)));
        list.push((format!("a_{name}"), joined(&r.hub, axle, 0.5)));
        list.push((format!("f_{name}"), joined(&r.force, axle, 1.0)));
    }
    record(list)
}

fn full_truck_record(r: &Readings) -> Channels {
    let mut list = Vec::new();
    for (i, corner) in ["lf", "rf", "lr", "rr"].into_iter().enumerate() {
        list.push((format!("a_body_{corner}"), r.body[i].clone()));
        list.push((format!("a_{corner}"), r.hub[i].clone()));
        list.push((format!("f_{corner}"), r.force[i].clone()));
    }
    record(list)
}

/// Returns the tasks of a quarter, half and full truck with two axles.
fn tasks() -> [IdentifyTask; 3] {
    let truck = two_axles();
    let of = |model: &str, places: BTreeMap<String, [f64; 2]>| {
        let request = PresetRequest {
            model: model.into(),
            places,
            ..PresetRequest::default()
        };
        IdentifyTask {
            vehicle: vehicle(&request).unwrap(),
            ..task("front2", &[], (0.7, 10.0))
        }
    };
    let (mut of_half, mut of_full) = (BTreeMap::new(), BTreeMap::new());
    for (axle, (name, letter)) in truck.axles.iter().zip([("front", "f"), ("rear", "r")]) {
        of_half.insert(name.to_owned(), [axle.x, 0.0]);
        of_half.insert(format!("spring_{name}"), [axle.seat, 0.0]);
        for (side, y) in [("l", 1.0), ("r", -1.0)] {
            let corner = format!("{side}{letter}");
            of_full.insert(corner.clone(), [axle.x, y * axle.half_track]);
            let spring = [axle.seat, y * axle.half_spring];
            of_full.insert(format!("spring_{corner}"), spring);
        }
    }
    [
        of("front2", BTreeMap::new()),
        of("half", of_half),
        of("full2", of_full),
    ]
}

fn readings() -> &'static Readings {
    static READINGS: OnceLock<Readings> = OnceLock::new();
    READINGS.get_or_init(|| drive(&two_axles(), 14.0, 14.0, 0.01, 5, [0.05, 100.0]))
}

fn records() -> [Channels; 3] {
    let r = readings();
    [front(r), half(r), full_truck_record(r)].map(without_gravity)
}

fn scale_channels(r: &Channels, is: impl Fn(&str) -> bool, factor: f64) -> Channels {
    let mut out = r.clone();
    let channels = out.list.iter_mut().filter(|c| is(&c.name));
    channels.for_each(|c| c.samples.iter_mut().for_each(|v| *v *= factor));
    out
}

fn exchange_channels(r: &Channels, a: &str, b: &str) -> Channels {
    let mut out = r.clone();
    for c in &mut out.list {
        if c.name == a {
            c.name = b.to_owned();
        } else if c.name == b {
            c.name = a.to_owned();
        }
    }
    out
}

/// Fails unless a fault is found with its code, as an error, and with its subject or an equivalent description.
fn finds(task: &IdentifyTask, r: &Channels, code: &str, subject: &str, described: &str) {
    let found = identify(task, r, None).unwrap();
    let wrong = found.wrong_input();
    let wrong = wrong.unwrap_or_else(|| panic!("{code} {subject}: {:?}", found.fit));
    assert_eq!(wrong.severity, Severity::Error, "{}", wrong.message);
    assert_eq!(wrong.code, code, "{subject}: {}", wrong.message);
    let named = wrong.subject == subject || wrong.message.contains(described);
    assert!(named, "{subject}: {}: {}", wrong.subject, wrong.message);
    for text in found.unidentifiable.iter().chain([&wrong.message]) {
        assert!(!text.contains("NaN") && !text.contains("()"), "{text}");
        assert!(!text.contains("Measure this force"), "{text}");
    }
    assert!(found.fit.iter().all(|f| f.relative_rms.is_finite()));
}

#[test]
fn a_reversed_channel_is_found_in_quarter_half_and_full_trucks() {
    for (task, r) in tasks().iter().zip(&records()) {
        // The full truck has twelve channels: test one of each kind.
        let every = if r.list.len() > 6 { 5 } else { 1 };
        for channel in r.list.iter().step_by(every) {
            let name = &channel.name;
            let reversed = scale_channels(r, |c| c == name, -1.0);
            let described = format!("`{name}` has reversed sign");
            finds(task, &reversed, "input-sign-reversed", name, &described);
        }
    }
}

#[test]
fn all_forces_reversed_are_found_as_such() {
    let [_, task, _] = tasks();
    let [_, r, _] = records();
    let reversed = scale_channels(&r, |c| c.starts_with("f_"), -1.0);
    let code = "input-sign-reversed";
    finds(&task, &reversed, code, "all", "all wheel forces have");
}

#[test]
fn exchanged_channels_are_found() {
    let pairs: [&[[&str; 2]]; 3] = [
        &[["a_body", "a_wheel"]],
        &[
            ["a_body_front", "a_body_rear"],
            ["a_front", "a_rear"],
            ["f_front", "f_rear"],
        ],
        &[
            ["a_body_lf", "a_body_rf"],
            ["a_lf", "a_lr"],
            ["f_lf", "f_rf"],
        ],
    ];
    for ((task, r), pairs) in tasks().iter().zip(&records()).zip(pairs) {
        for [a, b] in pairs {
            let described = format!("`{a}` and `{b}` are exchanged");
            let wrong = exchange_channels(r, a, b);
            finds(
                task,
                &wrong,
                "inputs-exchanged",
                &format!("{a}, {b}"),
                &described,
            );
        }
    }
}

/// In a quarter truck, a scaled body acceleration resembles another mass, except for the stretch of the spring. The model must fit well.
#[test]
fn one_channel_in_another_unit_is_found() {
    let quarter = super::parts::quarter(10_000, 12, [3200.0, 1100.0, 490e3, 8000.0]);
    let r = without_gravity(quarter);
    let [mut task, ..] = tasks();
    (task.band.low_hz, task.band.high_hz) = (1.0, 15.0);
    for (factor, unit) in [(1.0 / 9.80665, "g"), (1e3, "mm/s2")] {
        let wrong = scale_channels(&r, |c| c == "a_body", factor);
        let described = format!("`a_body` is in {unit} and is read as m/s2");
        finds(&task, &wrong, "input-unit", "a_body", &described);
    }
}

/// Masses and springs scale with the ratio of forces to accelerations. Only the weight and the size of a vehicle show the unit.
#[test]
fn the_unit_of_all_accelerations_or_forces_is_found_by_the_masses() {
    for (task, r) in tasks().iter().zip(&records()) {
        let acceleration = |c: &str| c.starts_with("a_");
        let force = |c: &str| c.starts_with("f_");
        let code = "input-unit";
        let in_g = scale_channels(r, acceleration, 1.0 / 9.80665);
        finds(
            task,
            &in_g,
            code,
            "all",
            "accelerations are in g and are read as m/s2",
        );
        let in_mm = scale_channels(r, acceleration, 1e3);
        finds(task, &in_mm, code, "all", "accelerations are in mm/s2");
        let in_kn = scale_channels(r, force, 1e-3);
        finds(task, &in_kn, code, "all", "may be in kN and are read as N");
    }
}

#[test]
fn a_record_that_confirms_no_unit_is_a_warning_that_states_the_assumed_one() {
    let [task, ..] = tasks();
    let [mut r, ..] = records();
    // Remove the static force as well.
    let mean = crate::series::detrend::mean(&r.list[2].samples);
    r.list[2].samples.iter_mut().for_each(|v| *v -= mean);
    let wrong = identify(&task, &r, None).unwrap().wrong_input().unwrap();
    assert_eq!(
        (wrong.code, wrong.severity),
        ("input-unit", Severity::Warning)
    );
    assert!(
        wrong.message.contains("m/s2 is assumed"),
        "{}",
        wrong.message
    );
    for c in r.list.iter_mut().take(2) {
        c.unit = "m/s2".to_owned();
    }
    assert_eq!(identify(&task, &r, None).unwrap().wrong_input(), None);
}

/// Correct records: quarter, half and full trucks on smooth and rough roads, slow and fast, with and without gravity in the means.
#[test]
fn sound_records_have_no_wrong_input() {
    const SEEDS: u64 = 4;
    let (mut n, mut alarms) = (0, Vec::new());
    for seed in 0..SEEDS {
        let roughness = [0.003, 0.006, 0.012, 0.02][seed as usize % 4];
        let speed = [6.0, 12.0, 20.0][seed as usize % 3];
        let r = drive(
            &two_axles(),
            14.0,
            speed,
            roughness,
            100 + seed,
            [0.05, 100.0],
        );
        for (task, r) in tasks()
            .iter()
            .zip([front(&r), half(&r), full_truck_record(&r)])
        {
            let r = match seed % 2 {
                0 => r,
                _ => without_gravity(r),
            };
            let found = identify(task, &r, None).unwrap();
            n += 1;
            alarms.extend(found.wrong_input().map(|f| format!("{seed}: {f:?}")));
        }
    }
    assert!(alarms.is_empty(), "{} of {n}: {alarms:#?}", alarms.len());
}
