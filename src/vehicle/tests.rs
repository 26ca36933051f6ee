use super::identify::{Identification, IdentifyTask, identify};
use super::preset::{PresetRequest, vehicle};
use super::term::UnitNames;
use crate::series::channels::Channels;
use crate::series::csv::read_csv;
use crate::series::spectrum::Band;
use crate::units::UnitSystem;
use std::collections::BTreeMap;

mod full_truck;
mod parts;
mod rig;
mod shared_cases;
mod silverbox;
mod truck_simulator;
mod wrong_inputs;

fn task(model: &str, terms: &[&str], band: (f64, f64)) -> IdentifyTask {
    let request = PresetRequest {
        model: model.into(),
        terms: terms.iter().map(|t| (*t).to_owned()).collect(),
        ..PresetRequest::default()
    };
    IdentifyTask {
        vehicle: vehicle(&request).unwrap(),
        known: BTreeMap::new(),
        bounds: BTreeMap::new(),
        band: Band {
            low_hz: band.0,
            high_hz: band.1,
        },
        gravity: 9.81,
        gain_tolerance: 0.0,
        sync_tolerance_s: 0.0,
        units: UnitNames::from_system(UnitSystem::MKgS),
        noise_acc: None,
        noise_force: None,
        corrections: vec![],
    }
}
