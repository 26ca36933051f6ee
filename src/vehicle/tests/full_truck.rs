//! Quarter and full models on an independently simulated truck.

use super::truck_simulator::{RATE_HZ, Readings, drive, roll_off};
use super::*;
use crate::series::channels::Channel;

fn record(r: &Readings, pick: &[(&str, &Vec<f64>)]) -> Channels {
    let _ = r;
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
    record(
        r,
        &[
            ("a_body", &r.body[0]),
            ("a_wheel", &r.hub[0]),
            ("f_wheel", &r.force[0]),
        ],
    )
}

fn rear(r: &Readings) -> Channels {
    record(
        r,
        &[
            ("a_body", &r.body[2]),
            ("a_mid", &r.hub[2]),
            ("a_rear", &r.hub[4]),
            ("f_mid", &r.force[2]),
            ("f_rear", &r.force[4]),
        ],
    )
}

fn whole(r: &Readings) -> Channels {
    let corners = ["lf", "rf", "lm", "rm", "lr", "rr"];
    let mut list = Vec::new();
    for (i, c) in corners.iter().enumerate() {
        for (prefix, samples) in [
            ("a_body_", &r.body[i]),
            ("a_", &r.hub[i]),
            ("f_", &r.force[i]),
        ] {
            list.push(Channel {
                name: format!("{prefix}{c}"),
                unit: String::new(),
                samples: samples.clone(),
            });
        }
    }
    Channels::from_list(RATE_HZ, list).unwrap()
}

fn full3() -> Question {
    let truck = roll_off();
    let mut places = BTreeMap::new();
    for (axle, letter) in truck.axles.iter().zip(["f", "m", "r"]) {
        for (side, sign) in [("l", 1.0), ("r", -1.0)] {
            places.insert(format!("{side}{letter}"), [axle.x, sign * axle.half_track]);
            places.insert(
                format!("spring_{side}{letter}"),
                [axle.x, sign * axle.half_spring],
            );
        }
    }
    let wish = Wish {
        model: "full3".into(),
        places,
        ..Wish::default()
    };
    Question {
        vehicle: vehicle(&wish).unwrap(),
        ..question("front2", &[], (0.7, 10.0))
    }
}

#[test]
fn explore_truck() {
    let s = std::time::Instant::now();
    let noise = [0.05, 100.0];
    let fitted = drive(&roll_off(), 64.0, 11.0, 0.0035, 3, noise);
    let other = drive(&roll_off(), 24.0, 16.0, 0.0035, 8, noise);
    eprintln!(
        "lifted {} {} {:?}",
        fitted.lifted_share,
        other.lifted_share,
        s.elapsed()
    );
    for (q, f, o) in [
        (
            question("front2", &[], (0.7, 10.0)),
            front(&fitted),
            front(&other),
        ),
        (
            question("rear3", &[], (0.7, 10.0)),
            rear(&fitted),
            rear(&other),
        ),
        (full3(), whole(&fitted), whole(&other)),
    ] {
        let s = std::time::Instant::now();
        let id = identify(&q, &f, Some(&o)).unwrap();
        eprintln!("{} {:?}", q.vehicle.name, s.elapsed());
        for p in &id.parameters {
            eprintln!(
                "  {:8} {:?} +- {:?} {}",
                p.name, p.value, p.sigma, p.identifiable
            );
        }
        for f in &id.fit {
            eprintln!(
                "  {} {:.4} {:.4}",
                f.channel, f.relative_rms, f.relative_rms_fitted
            );
        }
        eprintln!(
            "{:?} {:?} {:?} {:?}",
            id.blend, id.mass_closure, id.findings, id.unidentifiable
        );
    }
}
