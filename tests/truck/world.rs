//! Trucks that are solved once for all tests, and random numbers.

use crate::deck::DeckText;
use crate::parameters::Truck as Parameters;
use crate::{beam_frame, running_gear, shell_frame};
use nastran::bdf::{MemoryLoader, read_deck};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::OnceLock;
use strainbridge::fe::floor::{FloorSolution, solve_standing};
use strainbridge::fe::{CaseResult, UnitLoad};
use strainbridge::model::{FaultWeight, GridIx, Model, Vec3};

pub const WHEELS: [u32; 6] = [900_001, 900_002, 900_003, 900_004, 900_005, 900_006];
pub const NAMES: [&str; 6] = ["LF.FZ", "RF.FZ", "LM.FZ", "RM.FZ", "LR.FZ", "RR.FZ"];
pub const PAYLOAD: u32 = 900_101;
pub const GRAVITY: f64 = 9806.65;
/// Payload that the thesis found from wheel forces (6.5), t. Both models of 6.7 to 6.9 carry it.
pub const PAYLOAD_TONNES: f64 = 5.40717;

/// Truck with the strain of unit loads.
pub struct Truck {
    pub model: Model,
    /// Unit forces up at the wheels, then FZ, MX, MY at the payload, then FX FY MX MY MZ at each wheel.
    pub standing: FloorSolution,
}

impl Truck {
    /// Returns the cases of the other loads of wheel w: FX FY MX MY MZ.
    pub fn others_of(&self, w: usize) -> &[CaseResult] {
        &self.standing.others[3 + 5 * w..8 + 5 * w]
    }

    /// Returns the reactions to the weight of the truck, N.
    pub fn reactions(&self) -> Vec<f64> {
        self.standing.under_weight(&self.model, GRAVITY)
    }
}

/// Returns the deck of the truck with this largest element edge. The payload grid carries `tonnes`.
pub fn deck_text(size: f64, frame: Frame, with_ballast: bool, tonnes: f64) -> String {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/models/truck.toml");
    let mut truck: Parameters = toml::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    truck.mesh.size = size;
    if !with_ballast {
        truck.compensating.clear();
    }
    let mut deck = DeckText::new();
    let built = match frame {
        Frame::Shell => shell_frame::build(&truck, &mut deck),
        Frame::Beam => beam_frame::build(&truck, &mut deck),
    };
    running_gear::add(&truck, &built, &mut deck);
    let text = deck.finish("truck");
    if tonnes == 0.0 {
        return text;
    }
    let card = format!("CONM2,990101,{PAYLOAD},,{tonnes}\nENDDATA");
    text.replace("ENDDATA", &card)
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    Shell,
    Beam,
}

pub fn model_of(text: &str) -> Model {
    let deck = read_deck(
        "truck.bdf",
        text.as_bytes().to_vec(),
        &mut MemoryLoader::default(),
    );
    let (model, faults) = Model::from_deck(&deck);
    let errors: Vec<_> = faults
        .iter()
        .filter(|f| f.weight() == FaultWeight::Error)
        .collect();
    assert!(errors.is_empty(), "{errors:?}");
    model
}

pub fn grid(model: &Model, id: u32) -> GridIx {
    model.grid_ix(id).unwrap()
}

fn solve(text: &str) -> Truck {
    let model = model_of(text);
    let wheels: Vec<GridIx> = WHEELS.iter().map(|w| grid(&model, *w)).collect();
    let unit = |i: usize| {
        let mut v = Vec3::zeros();
        v[i % 3] = 1.0;
        v
    };
    let at = |grid: GridIx, dof: usize| UnitLoad::AtGrid {
        grid,
        force: if dof < 3 { unit(dof) } else { Vec3::zeros() },
        moment: if dof < 3 { Vec3::zeros() } else { unit(dof) },
    };
    let payload = grid(&model, PAYLOAD);
    let mut others: Vec<UnitLoad> = [2, 3, 4].map(|d| at(payload, d)).to_vec();
    for w in &wheels {
        others.extend([0, 1, 3, 4, 5].map(|d| at(*w, d)));
    }
    let standing = solve_standing(&model, 2, &wheels, &others, None).unwrap();
    Truck { model, standing }
}

/// Returns the analyst's model with 45 mm shells.
pub fn analyst_truck() -> &'static Truck {
    static TRUCK: OnceLock<Truck> = OnceLock::new();
    TRUCK.get_or_init(|| solve(&deck_text(45.0, Frame::Shell, true, PAYLOAD_TONNES)))
}

/// Returns the other model with 22.5 mm shells.
pub fn finer_truck() -> &'static Truck {
    static TRUCK: OnceLock<Truck> = OnceLock::new();
    TRUCK.get_or_init(|| solve(&deck_text(22.5, Frame::Shell, true, PAYLOAD_TONNES)))
}

/// Returns the model with rails and cross members as bars.
pub fn beam() -> &'static Truck {
    static TRUCK: OnceLock<Truck> = OnceLock::new();
    TRUCK.get_or_init(|| solve(&deck_text(45.0, Frame::Beam, true, PAYLOAD_TONNES)))
}

/// Seeded random numbers.
pub struct Lot(ChaCha8Rng);

impl Lot {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }
    pub fn draw_between(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }
    pub fn draw_normal(&mut self) -> f64 {
        crate::drawn::draw_normal(&mut self.0)
    }
}
