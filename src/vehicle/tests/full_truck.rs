//! Quarter and full models on an independently simulated truck.

use super::truck_simulator::{RATE_HZ, Readings, drive, roll_off};
use super::*;
use crate::series::channels::Channel;
use std::sync::OnceLock;

fn record(pick: &[(&str, &Vec<f64>)]) -> Channels {
    let list = pick
        .iter()
        .map(|(n, s)| Channel {
            name: (*n).into(),
            unit: String::new(),
            samples: (*s).clone(),
        })
        .collect();
    Channels::from_list(RATE_HZ, list).unwrap()
}

fn front(r: &Readings) -> Channels {
    record(&[
        ("a_body", &r.body[0]),
        ("a_wheel", &r.hub[0]),
        ("f_wheel", &r.force[0]),
    ])
}

fn rear_record(r: &Readings) -> Channels {
    record(&[
        ("a_body", &r.body[2]),
        ("a_mid", &r.hub[2]),
        ("a_rear", &r.hub[4]),
        ("f_mid", &r.force[2]),
        ("f_rear", &r.force[4]),
    ])
}

/// Returns 64 s at 11 m/s for the fit and 24 s on another road at 16 m/s for the test. Noise is 0.05 m/s2 and 100 N.
fn drives() -> &'static (Readings, Readings) {
    static DRIVES: OnceLock<(Readings, Readings)> = OnceLock::new();
    DRIVES.get_or_init(|| {
        let noise = [0.05, 100.0];
        (
            drive(&roll_off(), 64.0, 11.0, 0.015, 3, noise),
            drive(&roll_off(), 24.0, 16.0, 0.015, 8, noise),
        )
    })
}

fn wheel_misfits(id: &Identification) -> Vec<(String, f64)> {
    id.fit
        .iter()
        .filter(|f| f.channel.starts_with("f_"))
        .map(|f| (f.channel.clone(), f.relative_rms))
        .collect()
}

#[test]
fn the_drives_are_rough_enough_for_tyres_to_lift_off() {
    let (fitted, other) = drives();
    assert!(
        fitted.lifted_share > 0.002 && other.lifted_share > 0.01,
        "{} {}",
        fitted.lifted_share,
        other.lifted_share
    );
}

#[test]
fn quarter_models_give_wheel_forces_within_five_per_cent_on_another_road_and_speed() {
    let (fitted, other) = drives();
    for (q, f, o) in [
        (
            task("front2", &[], (0.7, 10.0)),
            front(fitted),
            front(other),
        ),
        (
            task("rear3", &[], (0.7, 10.0)),
            rear_record(fitted),
            rear_record(other),
        ),
    ] {
        let id = identify(&q, &f, Some(&o)).unwrap();
        for (wheel, misfit) in wheel_misfits(&id) {
            assert!(misfit < 0.05, "{wheel} {misfit}");
        }
    }
}

fn whole_truck_record(r: &Readings) -> Channels {
    let corners = ["lf", "rf", "lm", "rm", "lr", "rr"];
    let mut list = Vec::new();
    for (i, c) in corners.iter().enumerate() {
        for (n, s) in [
            ("a_body_", &r.body[i]),
            ("a_", &r.hub[i]),
            ("f_", &r.force[i]),
        ] {
            list.push(Channel {
                name: format!("{n}{c}"),
                unit: String::new(),
                samples: s.clone(),
            });
        }
    }
    Channels::from_list(RATE_HZ, list).unwrap()
}

/// Returns the places of the truck. Springs are inboard of the wheels, and the rear springs are near a common trunnion.
fn full_task(terms: &[&str], high: f64) -> IdentifyTask {
    let truck = roll_off();
    let mut places = std::collections::BTreeMap::new();
    for (a, letter) in truck.axles.iter().zip(["f", "m", "r"]) {
        for (side, y) in [("l", 1.0), ("r", -1.0)] {
            places.insert(format!("{side}{letter}"), [a.x, y * a.half_track]);
            places.insert(
                format!("spring_{side}{letter}"),
                [a.seat, y * a.half_spring],
            );
        }
    }
    let request = PresetRequest {
        model: "full3".into(),
        terms: terms.iter().map(|t| (*t).to_owned()).collect(),
        places,
        ..PresetRequest::default()
    };
    IdentifyTask {
        vehicle: vehicle(&request).unwrap(),
        ..task("front2", &[], (0.7, high))
    }
}

#[test]
fn the_full_model_gives_every_wheel_force_within_two_per_cent_on_another_road_and_speed() {
    let (fitted, other) = drives();
    // No model contains the memory of the friction (Dahl). The second model contains friction without memory.
    for terms in [&[][..], &["k", "c", "coulomb_friction"]] {
        let q = full_task(terms, 10.0);
        let id = identify(
            &q,
            &whole_truck_record(fitted),
            Some(&whole_truck_record(other)),
        )
        .unwrap();
        let misfits = wheel_misfits(&id);
        assert_eq!(misfits.len(), 6);
        for (wheel, misfit) in misfits {
            assert!(misfit < 0.02, "{terms:?}: {wheel} {misfit}");
        }
        let mass = id.value("m_b").unwrap();
        assert!((mass / 10_500.0 - 1.0).abs() < 0.005, "sprung mass {mass}");
    }
}
