//! Compares ACCEL, ACCEL1 and RFORCE1 with the closed form of the inertia forces in an acceleration field.

use crate::small_decks::{assert_close, displacement_at, list_refused_cards, model, solve};

/// Rounding error of a solution with a few unknowns.
const ROUNDING: f64 = 1e-12;

/// Rod along x, fixed at its left end, with lumped masses of 25 and 15 kg at the free grids. Two elements with lengths
/// 2 and 3, area .02, E 4e9, density 500.
const ROD: &str = "GRID,1,,1.,0.,0.\nGRID,2,,3.,0.,0.\nGRID,3,,6.,0.,0.\nCROD,1,7,1,2\nCROD,2,7,2,3\nPROD,7,3,.02\n\
     MAT1,3,4.+9,,.3,500.\nSPC1,1,123456,1\nSPC1,1,23456,2,3\n";

/// Returns the x displacements of both free grids under the forces `f2` and `f3` there, from k = E A / L.
fn exact_displacements(f2: f64, f3: f64) -> [f64; 2] {
    let u2 = (f2 + f3) * 2.0 / 8.0e7;
    [u2, u2 + f3 * 3.0 / 8.0e7]
}

#[track_caller]
fn moves(case_control: &str, cards: &str, [f1, f2, f3]: [f64; 3]) {
    let case_control = format!("SPC = 1\nLOAD = 5\n{case_control}");
    let solved = solve(&case_control, &format!("{ROD}{cards}"));
    for (grid, expected) in [2, 3].into_iter().zip(exact_displacements(f2, f3)) {
        assert_close(cards, displacement_at(&solved, grid)[0], expected, ROUNDING);
    }
    let total = solved.1.report.reactions[0].total[0];
    assert_close("reaction", total, -(f1 + f2 + f3), ROUNDING);
}

#[test]
fn accel1_acts_on_the_mass_of_the_grids_it_names() {
    // 25 kg and 15 kg at 6 m/s^2. The direction has length 5 and x component 3.
    moves("", "ACCEL1,5,,2.,3.,4.,0.\n,2,3", [0.0, 150.0, 90.0]);
    moves("", "ACCEL1,5,,2.,3.,4.,0.\n,3", [0.0, 0.0, 90.0]);
    // A range with THRU selects only grids that exist.
    moves("", "ACCEL1,5,,2.,3.,4.,0.\n,2,THRU,900", [0.0, 150.0, 90.0]);
}

#[test]
fn accel1_takes_its_direction_in_a_system_its_factor_from_load_and_mass_from_wtmass_and_conm2() {
    // The first axis of the system is basic y, the second is basic -x.
    let turned = "CORD2R,9,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n";
    moves(
        "",
        &format!("{turned}ACCEL1,5,9,2.,0.,-3.,0.\n,3"),
        [0.0, 0.0, 90.0],
    );
    moves(
        "",
        "LOAD,5,2.,3.,6\nACCEL1,6,,1.,1.,0.,0.\n,3",
        [0.0, 0.0, 90.0],
    );
    moves(
        "",
        "PARAM,WTMASS,.1\nACCEL1,5,,6.,1.,0.,0.\n,3",
        [0.0, 0.0, 9.0],
    );
    moves(
        "",
        "CONM2,70,3,,10.\nACCEL1,5,,6.,1.,0.,0.\n,3",
        [0.0, 0.0, 150.0],
    );
    moves(
        "NSM = 4",
        "NSM1,4,ELEMENT,2.,2\nACCEL1,5,,6.,1.,0.,0.\n,3",
        [0.0, 0.0, 108.0],
    );
}

#[test]
fn accel_varies_along_an_axis_and_stays_even_beyond_its_last_locations() {
    // Without an axis, ACCEL equals the field of GRAV. Grid 1 has 10 kg.
    moves("", "ACCEL,5,,6.,0.,0.", [60.0, 150.0, 90.0]);
    // The factors at x = 1, 3 and 6 are 1, 1.5 and 2.
    moves(
        "",
        "ACCEL,5,,4.,0.,0.,X\n,1.,1.,5.,2.",
        [40.0, 150.0, 120.0],
    );
    // The third axis of the system is basic x. Locations are measured from its origin at x = 2.
    let turned = "CORD2R,9,,2.,0.,0.,3.,0.,0.\n,2.,1.,0.\n";
    let varied = format!("{turned}ACCEL,5,9,0.,0.,2.,Z\n,-1.,0.,3.,4.");
    // The acceleration is 2 (x - 1) at x = 3 and 6. From x = 5 on, the last factor applies.
    moves("", &varied, [0.0, 100.0, 120.0]);
}

#[test]
fn accel_without_table_equals_grav() {
    let one = solve("SPC = 1\nLOAD = 5", &format!("{ROD}ACCEL,5,,6.,1.,2."));
    let other = solve("SPC = 1\nLOAD = 5", &format!("{ROD}GRAV,5,,1.,6.,1.,2."));
    assert_eq!(one.1.displacements, other.1.displacements);
}

#[test]
fn rforce1_turns_the_structure_as_rforce_does() {
    // 3 rev/s about z through grid 1 give the force m w^2 r at r = 2 and 5.
    let w = 3.0 * std::f64::consts::TAU;
    let (f2, f3) = (25.0 * w * w * 2.0, 15.0 * w * w * 5.0);
    for card in ["RFORCE1", "RFORCE"] {
        moves("", &format!("{card},5,1,,3.,0.,0.,1."), [0.0, f2, f3]);
        moves("", &format!("{card},5,1,,1.5,0.,0.,2.,2"), [0.0, f2, f3]);
    }
}

#[test]
fn rotations_that_ask_for_more_are_refused_by_their_name() {
    let of = |card: &str| list_refused_cards("SPC = 1\nLOAD = 5", &format!("{ROD}{card}"));
    assert_eq!(of("RFORCE1,5,1,,3.,0.,0.,1.\n,1."), ["RFORCE1 with RACC 5"]);
    assert_eq!(
        of("RFORCE1,5,1,,3.,0.,0.,1.\n,,,8"),
        ["RFORCE1 with GROUPID 5"]
    );
    assert_eq!(of("RFORCE,5,1,,3.,0.,0.,1.\n,,,8"), ["RFORCE with IDRF 5"]);
}

/// 10 kg at grid 3 with the offset 1 along x and 2 along z, and with products of inertia. The force is m w^2 r. The
/// moment about y is h F + w^2 I31.
const OFF_GRID: &str = "CONM2,70,3,,10.,1.,0.,2.\n,7.,.4,8.,.6,.3,9.\n";

#[test]
fn mass_at_an_offset_turns_where_it_is() {
    let w = 3.0 * std::f64::consts::TAU;
    let (f2, f3) = (25.0 * w * w * 2.0, 15.0 * w * w * 5.0);
    let force = 10.0 * w * w * 6.0;
    for card in [
        "RFORCE,5,1,,3.,0.,0.,1.",
        "RFORCE,5,1,,3.,0.,0.,1.,1",
        "RFORCE1,5,1,,3.,0.,0.,1.,1",
    ] {
        let cards = format!("{OFF_GRID}{card}");
        moves("", &cards, [0.0, f2, f3 + force]);
        let held = solve("SPC = 1\nLOAD = 5", &format!("{ROD}{cards}"));
        let moment = held.1.report.reactions[0].total[4];
        assert_close(card, moment, -(2.0 * force + w * w * 0.6), ROUNDING);
    }
}

#[test]
fn method_2_is_refused_with_mass_at_an_offset_and_other_methods_are_faults() {
    let of = |cards: &str| list_refused_cards("SPC = 1\nLOAD = 5", &format!("{ROD}{cards}"));
    let why = "with METHOD 2 and mass at an offset from its grid 5";
    for mass in [OFF_GRID, "CONM2,70,3,,10.\n,7.\n"] {
        assert_eq!(
            of(&format!("{mass}RFORCE,5,1,,3.,0.,0.,1.,2")),
            [format!("RFORCE {why}")]
        );
        // RFORCE1 takes the same method by default.
        assert_eq!(
            of(&format!("{mass}RFORCE1,5,1,,3.,0.,0.,1.")),
            [format!("RFORCE1 {why}")]
        );
    }
    let w = 3.0 * std::f64::consts::TAU;
    let forces = [0.0, 25.0 * w * w * 2.0, 25.0 * w * w * 5.0];
    moves("", "CONM2,70,3,,10.\nRFORCE,5,1,,3.,0.,0.,1.,2", forces);
    let (_, faults) = model("LOAD = 5", &format!("{ROD}RFORCE,5,1,,3.,0.,0.,1.,3"));
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert_eq!((faults[0].field, faults[0].at.line), ("METHOD", 14));
}
