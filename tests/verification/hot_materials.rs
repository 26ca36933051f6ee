//! Compares materials at the temperature of their elements (MATT1) with closed forms.

use crate::small_decks::{assert_close, displacement_at, list_refused_cards, model, solve};

const ROUNDING: f64 = 1e-12;

/// Bar of two rods along x, 2 and 1 long, area .01, under a force of 600. E on the card is 1e10.
const ROD: &str = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,3.,0.,0.\nCROD,1,7,1,2\nCROD,2,7,2,3\nPROD,7,5,.01\n\
     FORCE,1,3,,600.,1.,0.,0.\nSPC1,1,123456,1\nSPC1,1,23456,2,3\n";
const STEEL: &str = "MAT1,5,1.+10,,.3,800.,1.-5,20.\nMATT1,5,9\n";
const TABLE: &str = "TABLEM1,9\n,0.,1.+10,100.,3.+10,200.,2.+10,ENDT\n";

/// Returns the elongation of both rods with these moduli.
fn rod_elongation(e: [f64; 2]) -> f64 {
    600.0 * (2.0 / e[0] + 1.0 / e[1]) / 0.01
}

#[track_caller]
fn tip(case_control: &str, cards: &str) -> f64 {
    let case_control = format!("SPC = 1\nLOAD = 1\n{case_control}");
    displacement_at(&solve(&case_control, &format!("{ROD}{cards}")), 3)[0]
}

#[test]
fn every_element_has_the_modulus_at_the_mean_temperature_of_its_grids() {
    // The mean temperatures 50 and 125 give 2e10 and 2.75e10.
    let field = "TEMP,3,1,0.,2,100.,3,150.\n";
    let cards = format!("{STEEL}{TABLE}{field}");
    let expected = rod_elongation([2.0e10, 2.75e10]);
    for word in [
        "TEMP(MATERIAL) = 3",
        "TEMPERATURE(MATE)=3",
        "TEMP(INIT) = 3",
    ] {
        assert_close(word, tip(word, &cards), expected, ROUNDING);
    }
    // A uniform temperature changes the material of all elements.
    let even = format!("{STEEL}{TABLE}TEMPD,3,50.\n");
    assert_close(
        "even",
        tip("TEMP(MATERIAL) = 3", &even),
        rod_elongation([2.0e10; 2]),
        ROUNDING,
    );
    // A temperature stated for the element has priority over the temperatures of its grids.
    let own = format!("{STEEL}{TABLE}TEMPD,3,50.\nTEMPRB,3,2,100.,150.\n");
    let expected = rod_elongation([2.0e10, 2.75e10]);
    assert_close("own", tip("TEMP(MATERIAL) = 3", &own), expected, ROUNDING);
}

#[test]
fn without_temperatures_of_materials_the_values_of_mat1_hold() {
    let cards = format!("{STEEL}{TABLE}TEMPD,3,50.\n");
    assert_close(
        "none",
        tip("", &cards),
        rod_elongation([1.0e10; 2]),
        ROUNDING,
    );
    // TEMPERATURE(LOAD) heats by 30 degrees above TREF.
    let hot = rod_elongation([1.0e10; 2]) + 1.0e-5 * 30.0 * 3.0;
    assert_close("load", tip("TEMP(LOAD) = 3", &cards), hot, ROUNDING);
}

#[test]
fn both_changes_the_material_and_heats() {
    // The expansion at 50 degrees is 2e-5, from its table.
    let cards = "MAT1,5,1.+10,,.3,800.,1.-5,20.\nMATT1,5,9,,,,10\nTABLEM1,10\n,0.,1.-5,100.,3.-5,ENDT\nTEMPD,3,50.\n";
    let expected = rod_elongation([2.0e10; 2]) + 2.0e-5 * 30.0 * 3.0;
    for word in ["TEMP(BOTH) = 3", "TEMPERATURE = 3"] {
        assert_close(
            word,
            tip(word, &format!("{TABLE}{cards}")),
            expected,
            ROUNDING,
        );
    }
}

#[test]
fn the_four_tables_give_what_their_formulas_state() {
    for (table, t, e) in [
        // Linear extrapolation beyond the ends, the mean value at a jump, and a descending table.
        ("TABLEM1,9\n,0.,1.+10,100.,3.+10,ENDT\n", -20.0, 0.6e10),
        ("TABLEM1,9\n,0.,1.+10,100.,3.+10,ENDT\n", 150.0, 4.0e10),
        (
            "TABLEM1,9\n,0.,1.+10,50.,2.+10,50.,4.+10,90.,5.+10\n,ENDT\n",
            50.0,
            3.0e10,
        ),
        (
            "TABLEM1,9\n,100.,3.+10,40.,SKIP,0.,1.+10,ENDT\n",
            50.0,
            2.0e10,
        ),
        // The formulas are z y(x - x1), z y((x - x1) / x2) and z sum a_i s^i, with z = 1e10.
        ("TABLEM2,9,20.\n,0.,1.,10.,3.,ENDT\n", 25.0, 2.0e10),
        ("TABLEM3,9,20.,2.\n,0.,1.,10.,3.,ENDT\n", 30.0, 2.0e10),
        ("TABLEM4,9,0.,10.,0.,50.\n,1.,2.,3.,ENDT\n", 20.0, 17.0e10),
        ("TABLEM4,9,0.,10.,0.,50.\n,1.,2.,3.,ENDT\n", 90.0, 86.0e10),
    ] {
        let cards = format!("{STEEL}{table}TEMPD,3,{t:?}\n");
        assert_close(
            table,
            tip("TEMP(MATERIAL) = 3", &cards),
            rod_elongation([e; 2]),
            ROUNDING,
        );
    }
}

/// G follows E if MAT1 leaves it blank. The hot density enters the weight.
#[test]
fn shear_modulus_follows_and_density_weighs() {
    let bar = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nCBAR,1,7,1,2,0.,0.,1.\nPBAR,7,5,.01,1.-5,1.-5,2.-5\nMOMENT,1,2,,10.,1.,0.,0.\n\
        SPC1,1,123456,1\nMAT1,5,1.+10,,.25,800.\nMATT1,5,9,,,8\nTABLEM1,8\n,0.,800.,100.,900.,ENDT\nTEMPD,3,50.\n";
    let solved = solve(
        "SPC = 1\nLOAD = 1\nTEMP(MATERIAL) = 3",
        &format!("{bar}{TABLE}"),
    );
    // The twist is M L / (G J) with G = 2e10 / 2.5.
    assert_close(
        "twist",
        displacement_at(&solved, 2)[3],
        10.0 * 2.0 / (8.0e9 * 2.0e-5),
        ROUNDING,
    );
    assert_close("mass", solved.0.weight().mass, 850.0 * 0.02, ROUNDING);
}

/// Plates, solids and panels with one property at several temperatures.
#[test]
fn shells_and_solids_of_one_property_differ_by_their_temperature() {
    let plates = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\nGRID,5,,2.,0.,0.\nGRID,6,,2.,1.,0.\n\
        CQUAD4,1,7,1,2,3,4\nCQUAD4,2,7,2,5,6,3\nPSHELL,7,5,.01\nMAT1,5,1.+10,,0.,800.\nMATT1,5,9\n\
        FORCE,1,5,,300.,1.,0.,0.\nFORCE,1,6,,300.,1.,0.,0.\nSPC1,1,1,1,4\nSPC1,1,2,1,2,5\nSPC1,1,3456,1,THRU,6\n\
        TEMPD,3,50.\nTEMPP1,3,2,100.\n";
    let solved = solve(
        "SPC = 1\nLOAD = 1\nTEMP(MATERIAL) = 3",
        &format!("{plates}{TABLE}"),
    );
    // A force of 600 on a section of .01 and a length of 1. E is 2e10 on the left and 3e10 on the right.
    let left = 600.0 / 0.01 / 2.0e10;
    assert_close("left", displacement_at(&solved, 2)[0], left, 1e-11);
    assert_close(
        "right",
        displacement_at(&solved, 6)[0],
        left + 600.0 / 0.01 / 3.0e10,
        1e-11,
    );
    // All copies of the property keep its id.
    let ids: Vec<u32> = solved.0.shell_properties.iter().map(|p| p.id).collect();
    assert_eq!(ids, [7, 7, 7]);
}

#[test]
fn what_no_rule_covers_is_refused_or_a_fault() {
    let cards = format!("{STEEL}{TABLE}TEMPD,3,50.\nTEMPD,4,60.\n");
    let of = |case_control: &str, cards: &str| {
        let case_control = format!("SPC = 1\nLOAD = 1\n{case_control}");
        list_refused_cards(&case_control, &format!("{ROD}{cards}"))
    };
    let differs = "SUBCASE 1\nTEMP(MATERIAL) = 3\nSUBCASE 2\nTEMP(MATERIAL) = 4";
    assert_eq!(of(differs, &cards).len(), 1);
    assert_eq!(of("TEMP(MATERIAL) = 3\nTEMP(INIT) = 4", &cards).len(), 1);
    let flat =
        "MAT1,5,1.+10,,.3\nMATT1,5,9\nTABLEM1,9,,,FLAT\n,0.,1.+10,9.,2.+10,ENDT\nTEMPD,3,50.";
    assert_eq!(of("TEMP(MATERIAL) = 3", flat), ["TABLEM with FLAT 9"]);
    let faults = |cards: &str| {
        model("TEMP(MATERIAL) = 3", &format!("{ROD}{cards}"))
            .1
            .len()
    };
    // No table, no temperature set, a grid without temperature, E below 0, no MAT1.
    assert_eq!(faults(&format!("{STEEL}TEMPD,3,50.")), 1);
    assert_eq!(faults(&format!("{STEEL}{TABLE}TEMPD,4,50.")), 1);
    assert_eq!(faults(&format!("{STEEL}{TABLE}TEMP,3,1,50.")), 1);
    assert_eq!(faults(&format!("{STEEL}{TABLE}TEMPD,3,-100.")), 1);
    assert_eq!(faults(&format!("{STEEL}{TABLE}TEMPD,3,5.\nMATT1,6,9")), 1);
}

/// RIGID = LAGRAN requests rigid elements that expand, which the built-in solver does not support. By default they do
/// not expand.
#[test]
fn rigid_elements_that_would_expand_are_refused() {
    let rigid =
        "GRID,4,,5.,0.,0.\nRBE2,40,3,123456,4,1.-5\nMAT1,5,1.+10,,.3,800.,1.-5,20.\nTEMPD,3,50.\n";
    let of = |word: &str| {
        list_refused_cards(
            &format!("SPC = 1\nLOAD = 1\n{word}"),
            &format!("{ROD}{rigid}"),
        )
    };
    assert_eq!(of("RIGID = LAGRAN\nTEMP(LOAD) = 3"), ["RBE2 40"]);
    assert_eq!(of("RIGI = LAGR\nTEMP(LOAD) = 3"), ["RBE2 40"]);
    assert_eq!(of("RIGID = LGELIM\nTEMP(LOAD) = 3"), ["RBE2 40"]);
    assert!(of("RIGID = LINEAR\nTEMP(LOAD) = 3").is_empty());
    assert!(of("RIGID = LAGRAN").is_empty());
    assert!(of("TEMP(LOAD) = 3").is_empty());
}
