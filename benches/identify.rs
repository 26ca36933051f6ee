//! Identifies a quarter truck from a record of 64 s at 500 Hz.
//!
//! Run: `cargo bench --bench identify`. The record is a sum of sines that follows the model exactly.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use strainbridge::series::channels::{Channel, Channels};
use strainbridge::series::spectrum::Band;
use strainbridge::units::UnitSystem;
use strainbridge::vehicle::identify::{IdentifyTask, identify};
use strainbridge::vehicle::preset::{PresetRequest, vehicle};
use strainbridge::vehicle::term::UnitNames;

fn main() {
    divan::main();
}

const RATE_HZ: f64 = 500.0;

/// Returns a record that follows the model exactly. The stretch is 60 sines between 0.9 and 18 Hz. Body and wheel follow from m_b a_b = -(k d + c v)
/// and F = m_b a_b + m_f a_w.
fn record() -> Channels {
    let (m_b, m_f, k, c) = (3200.0, 1100.0, 490e3, 8000.0);
    let (mut body, mut wheel, mut force) = (vec![], vec![], vec![]);
    for i in 0..32_000 {
        let t = i as f64 / RATE_HZ;
        let (mut d, mut v, mut a) = (0.0, 0.0, 0.0);
        for s in 0..60 {
            let f = 0.9 + 17.1 * f64::from(s) / 59.0 + 0.013 * f64::from(s % 7);
            let (w, phase) = (2.0 * PI * f, 2.4 * f64::from(s * s));
            let size = 0.02 / (1.0 + f * f);
            d += size * (w * t + phase).sin();
            v += size * w * (w * t + phase).cos();
            a -= size * w * w * (w * t + phase).sin();
        }
        let a_b = -(k * d + c * v) / m_b;
        let a_w = a_b - a;
        // A small deterministic signal represents sensor noise.
        let unrest = |p: f64| 0.02 * (i as f64 * p).sin() * (i as f64 * 0.7 * p).cos();
        body.push(9.81 + a_b + unrest(1.1));
        wheel.push(9.81 + a_w + unrest(1.3));
        force.push((m_b + m_f) * 9.81 + m_b * a_b + m_f * a_w + 3000.0 * unrest(1.7));
    }
    let channel = |n: &str, s| Channel {
        name: n.into(),
        unit: String::new(),
        samples: s,
    };
    Channels {
        rate_hz: RATE_HZ,
        start_s: 0.0,
        list: vec![
            channel("a_body", body),
            channel("a_wheel", wheel),
            channel("f_wheel", force),
        ],
    }
}

fn task() -> Option<IdentifyTask> {
    Some(IdentifyTask {
        vehicle: vehicle(&PresetRequest {
            model: "front2".into(),
            ..PresetRequest::default()
        })
        .ok()?,
        known: BTreeMap::new(),
        bounds: BTreeMap::new(),
        band: Band {
            low_hz: 0.7,
            high_hz: 20.0,
        },
        gravity: 9.81,
        gain_tolerance: 0.0,
        sync_tolerance_s: 0.0,
        units: UnitNames::from_system(UnitSystem::MKgS),
        noise_acc: None,
        noise_force: None,
        corrections: vec![],
    })
}

#[divan::bench]
fn least_squares(bencher: divan::Bencher) {
    let (Some(q), r) = (task(), record()) else {
        return;
    };
    bencher.bench(|| identify(&q, &r, None).map(|id| id.values));
}
