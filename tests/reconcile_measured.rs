//! The dynamic workflow on published measured records: Silverbox (Wigren & Schoukens 2013), F-16 (Noel & Schoukens
//! 2017).

#[path = "../nastran/tests/support/mod.rs"]
mod support;

use std::collections::BTreeMap;
use strainbridge::reconcile::Verdict;
use strainbridge::reconcile::motion::{MotionFrame, examine, simulated_gap};
use strainbridge::series::channels::{Channel, Channels};
use strainbridge::series::csv::read_csv;
use strainbridge::series::spectrum::Band;
use strainbridge::units::UnitSystem;
use strainbridge::vehicle::layout::Measures;
use strainbridge::vehicle::preset::{PresetRequest, vehicle};
use strainbridge::vehicle::term::UnitNames;

/// Returns a model with one mass on a linear spring and damper. It is fitted to `cut` samples and tested on the
/// following ones.
fn frame(
    file: &str,
    rate_hz: f64,
    columns: [&str; 2],
    cut: usize,
    band: [f64; 2],
    measures: Measures,
) -> Option<MotionFrame> {
    let bytes = support::bytes(&format!("hidden_effects/real/{file}"))?;
    let all = read_csv(&bytes, Some(rate_hz)).unwrap();
    let part = |from: usize, to: usize| {
        let list = columns
            .iter()
            .zip(["u", "y"])
            .map(|(column, name)| Channel {
                name: name.into(),
                unit: String::new(),
                samples: all.samples(column).unwrap()[from..to].to_vec(),
            })
            .collect();
        Channels::from_list(rate_hz, list).unwrap()
    };
    let request = PresetRequest {
        model: "oscillator".into(),
        terms: vec!["k".into(), "c".into()],
        ..PresetRequest::default()
    };
    let mut model = vehicle(&request).unwrap();
    model.sensors[0].measures = measures;
    Some(MotionFrame {
        vehicle: model,
        bodies: vec![0],
        not_compared: vec![],
        known: BTreeMap::new(),
        data: part(0, cut),
        hold_out: Some(part(cut, (2 * cut).min(all.n_samples()))),
        band: Band {
            low_hz: band[0],
            high_hz: band[1],
        },
        gravity: 9.81,
        noise_acc: None,
        noise_force: None,
        gain_tolerance: 0.0,
        sync_tolerance_s: 0.0,
        corrections: vec![],
        units: UnitNames::from_system(UnitSystem::MKgS),
        rules: Default::default(),
        stop: Default::default(),
    })
}

#[test]
fn the_cubic_spring_of_the_silverbox_is_named_from_the_linear_model() {
    let Some(f) = frame(
        "silverbox_estimation.csv",
        610.35,
        ["u_V", "y_V"],
        20_000,
        [3.0, 200.0],
        Measures::Displacement,
    ) else {
        return;
    };
    let o = examine(&f, &[]).unwrap();
    assert_eq!(o.verdict, Verdict::Named);
    assert!(
        o.effects.iter().any(|e| e.id == "cubic_stiffness"),
        "{:?}",
        o.effects
    );
    assert!(o.gap.after < 0.25 * o.gap.before, "{:?}", o.gap);
    // Linear models of this circuit have an error of about 7 mV. A model with 37 parameters reaches .26 mV.
    let simulated = simulated_gap(&f, &o).unwrap();
    let y = &simulated.channels[0];
    assert!((5e-3..9e-3).contains(&y.before), "{y:?}");
    assert!(y.after < 0.5e-3, "{y:?}");
}

#[test]
fn the_sliding_store_of_the_f16_is_never_a_sensor_fault() {
    let Some(f) = frame(
        "f16_estimation.csv",
        400.0,
        ["x2", "acc_y"],
        8_000,
        [5.0, 9.0],
        Measures::Acceleration,
    ) else {
        return;
    };
    let o = examine(&f, &[]).unwrap();
    let faults = [
        "accel_gain",
        "time_offset",
        "sign_flip",
        "channel_swap",
        "dead_channel",
        "saturated_channel",
    ];
    assert!(
        o.verdict == Verdict::Unknown
            || o.effects
                .iter()
                .all(|e| faults.iter().all(|f| !e.id.starts_with(f))),
        "{:?}",
        o.effects
    );
}
