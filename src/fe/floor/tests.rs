//! Reactions compared with statics, a beam on three supports, and the truck on springs to ground solved with supports.

use super::*;
use crate::fe::{LoadCase, Relief, SolveOptions, UnitLoad, solve_cases};
use crate::model::{GridIx, Model, Vec3};
use nastran::bdf::{MemoryLoader, read_deck};

fn model(text: &str) -> Model {
    let deck = read_deck(
        "test.bdf",
        text.as_bytes().to_vec(),
        &mut MemoryLoader::default(),
    );
    let (model, faults) = Model::from_deck(&deck);
    assert!(
        faults
            .iter()
            .all(|f| f.weight() != crate::model::FaultWeight::Error),
        "{faults:?}"
    );
    model
}

fn grid(model: &Model, id: u32) -> GridIx {
    model.grid_ix(id).expect("the grid exists")
}

/// Returns a stiff square table of side 2 with legs 1 2 3 4 at (+-1, +-1) around the point mass 5 at the origin.
fn table() -> Model {
    let mut t = String::from("BEGIN BULK\n");
    for (id, x, y) in [
        (1, -1.0, -1.0),
        (2, 1.0, -1.0),
        (3, 1.0, 1.0),
        (4, -1.0, 1.0),
        (5, 0.0, 0.0),
    ] {
        t += &format!("GRID,{id},,{x:.1},{y:.1},0.0\n");
    }
    for id in 1..=4 {
        t += &format!("CBAR,{id},1,5,{id},0.,0.,1.\n");
    }
    t += "PBAR,1,1,1.0,1.0,1.0,1.0\nMAT1,1,1000.0,,0.3\nCONM2,9,5,,10.0,,,,,\n,1.0,,1.0,,,1.0\nENDDATA\n";
    model(&t)
}

#[test]
fn a_symmetric_table_carries_a_quarter_of_its_weight_on_each_leg() {
    let m = table();
    let legs: Vec<GridIx> = (1..=4).map(|i| grid(&m, i)).collect();
    let standing = solve_standing(&m, 2, &legs, &[], None).expect("solvable");
    for r in standing.under_weight(&m, 9.81) {
        assert!((r - 10.0 * 9.81 / 4.0).abs() < 1e-9, "{r}");
    }
}

#[test]
fn a_force_over_a_leg_stays_there_on_a_rigid_floor_and_tilts_the_table_on_soft_tyres() {
    // On a rigid floor nothing deforms: the leg under the force carries all of it.
    let m = table();
    let legs: Vec<GridIx> = (1..=4).map(|i| grid(&m, i)).collect();
    let standing = solve_standing(&m, 2, &legs, &[], None).expect("solvable");
    let r = standing.under_forces(&m, &[(legs[0], Vec3::new(0.0, 0.0, -8.0))]);
    for (got, expected) in r.iter().zip([8.0, 0.0, 0.0, 0.0]) {
        assert!((got - expected).abs() < 1e-9, "{r:?}");
    }
    // On tyres far softer than the table, the reaction is P (1 + x x_P + y y_P) / 4 as on a rigid plate.
    let rigid_share = [0.75, 0.25, -0.25, 0.25];
    let soft = solve_standing(&m, 2, &legs, &[], Some(1e-6)).expect("solvable");
    let r = soft.under_forces(&m, &[(legs[0], Vec3::new(0.0, 0.0, -1.0))]);
    for (got, expected) in r.iter().zip(rigid_share) {
        assert!((got - expected).abs() < 1e-4, "{r:?}");
    }
}

#[test]
fn contacts_on_a_line_are_refused() {
    let m = table();
    let legs = [grid(&m, 1), grid(&m, 5), grid(&m, 3)];
    assert!(matches!(
        solve_standing(&m, 2, &legs, &[], None),
        Err(FloorError::OnALine { contacts: 3 })
    ));
}

/// Returns the beam truck, which is quick to solve and has every joint of the shell truck.
fn truck_text() -> String {
    include_str!("../../../models/truck-beam/truck.bdf").to_owned()
}

const WHEELS: [u32; 6] = [900_001, 900_002, 900_003, 900_004, 900_005, 900_006];
const GRAVITY: f64 = 9806.65;

#[test]
fn reactions_of_the_truck_are_those_of_a_solution_on_supports() {
    // Springs to ground under the hubs and three more fixed dofs. Without inertia relief, the solver takes another path.
    let rate = 4.0e4;
    let mut text = truck_text();
    let mut extra = format!("GRAV,7,,{GRAVITY},0.,0.,-1.\n");
    for (i, g) in WHEELS.iter().enumerate() {
        extra += &format!("CELAS2,{},{rate},{g},3\n", 990_001 + i);
    }
    extra += "SPC1,5,12,900001\nSPC1,5,2,900005\nENDDATA\n";
    text = text.replace("ENDDATA", &extra);
    let held = model(&text);
    let case = LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(7)],
        spc: Some(5),
        mpc: None,
        relief: Relief::None,
    };
    let (solution, _) = solve_cases(&held, &[case], &SolveOptions::default()).expect("solvable");
    let expected: Vec<f64> = WHEELS
        .iter()
        .map(|g| -rate * solution.cases[0].displacement[grid(&held, *g).us()][2])
        .collect();
    let free = model(&truck_text());
    let wheels: Vec<GridIx> = WHEELS.iter().map(|g| grid(&free, *g)).collect();
    let standing = solve_standing(&free, 2, &wheels, &[], Some(rate)).expect("solvable");
    let r = standing.under_weight(&free, GRAVITY);
    let weight = free.weight().mass * GRAVITY;
    assert!((r.iter().sum::<f64>() - weight).abs() < 1e-8 * weight);
    for (got, expected) in r.iter().zip(&expected) {
        assert!(
            (got - expected).abs() < 1e-5 * weight,
            "{r:?} against {expected:?}"
        );
    }
}

#[test]
fn a_payload_weighs_on_the_wheels_as_its_moments_state_and_reciprocity_holds() {
    let free = model(&truck_text());
    let wheels: Vec<GridIx> = WHEELS.iter().map(|g| grid(&free, *g)).collect();
    let payload = grid(&free, 900_101);
    let down = UnitLoad::AtGrid {
        grid: payload,
        force: Vec3::new(0.0, 0.0, -1000.0),
        moment: Vec3::zeros(),
    };
    let standing = solve_standing(&free, 2, &wheels, &[down], None).expect("solvable");
    let at = free.grids[payload.us()].x;
    let direct = standing.floor.reactions(&standing.floor.load(
        at,
        Vec3::new(0.0, 0.0, -1000.0),
        Vec3::zeros(),
        standing.lift(&standing.others[0]),
    ));
    let reciprocal = standing.under_forces(&free, &[(payload, Vec3::new(0.0, 0.0, -1000.0))]);
    for (a, b) in direct.iter().zip(&reciprocal) {
        assert!((a - b).abs() < 1e-4, "{direct:?} against {reciprocal:?}");
    }
    let x = standing.floor.positions();
    let moment: f64 = direct.iter().zip(x).map(|(r, x)| r * x.x).sum();
    assert!((direct.iter().sum::<f64>() - 1000.0).abs() < 1e-6);
    assert!((moment - 1000.0 * at.x).abs() < 1e-6 * moment.abs());
}
