//! Tests connector cards that are faulty, and the messages about them.

use crate::connectors::plates;
use crate::mesh::{Bulk, assert_near};
use strainbridge::fe::*;
use strainbridge::model::{FaultWeight, ModelFault};

/// Returns the faults of weight error: card, field, message.
fn faults(b: &Bulk) -> Vec<(String, &'static str, String)> {
    let of = |f: ModelFault| (f.card.clone(), f.field, format!("{f}: {}", f.remedy()));
    let (_, faults) = b.read_model();
    faults
        .into_iter()
        .filter(|f| f.weight() == FaultWeight::Error)
        .map(of)
        .collect()
}

const LOAD: &str = "FORCE,1,50,0,10.,0.,0.,1.";

#[test]
fn a_connector_from_a_patch_or_grid_to_itself_is_a_fault() {
    let cases = [
        (
            "CWELD,500,7,101,GRIDID,,,,,\n,12,17,18,13,,,,,\n,12,17,18,13",
            "one patch",
        ),
        // The same corners with another first corner, then three of the four corners.
        (
            "CWELD,500,7,101,GRIDID,,,,,\n,12,17,18,13,,,,,\n,17,18,13,12",
            "one patch",
        ),
        (
            "CWELD,500,7,101,GRIDID,,,,,\n,12,17,18,13,,,,,\n,17,18,13",
            "one patch",
        ),
        ("CWELD,500,7,101,ELEMID,,17,,,\n,10", "one of its corners"),
        (
            "CWELD,500,7,101,GRIDID,,17,,,\n,12,17,18,13",
            "one of its corners",
        ),
        ("PGAP,6,0.,0.,1000.\nCGAP,500,6,40,40,,,,0", "to itself"),
        ("PBUSH,6,K,1.,1.\nCBUSH,500,6,40,40,,,,0", "to itself"),
    ];
    for (card, words) in cases {
        let found = faults(&plates(card, LOAD));
        assert_eq!(found.len(), 1, "{card}: {found:?}");
        assert!(found[0].0.ends_with(" 500"), "{found:?}");
        assert!(found[0].2.contains(words), "{found:?}");
    }
}

#[test]
fn negative_stiffness_of_a_gap_a_torsion_or_a_warping_constant_is_a_fault_at_its_card() {
    let cases = [
        ("PGAP,6,0.,0.,-1000.\nCGAP,500,6,15,40,,,,0", "PGAP 6", "KA"),
        (
            "PGAP,6,1.,0.,1000.,-1.\nCGAP,500,6,15,40,,,,0",
            "PGAP 6",
            "KB",
        ),
        (
            "PGAP,6,0.,0.,1000.,,-5.\nCGAP,500,6,15,40,,,,0",
            "PGAP 6",
            "KT",
        ),
        (
            "PBAR,9,1,200.,9000.,9000.,-1.\nCBAR,500,9,15,40,0.,1.,0.",
            "PBAR 9",
            "J",
        ),
        (
            "PWELD,9,1,5.,,,,,,\n,-1.\nCWELD,500,9,101,ELPAT,,,,,\n,10,26",
            "PWELD 9",
            "LDMIN",
        ),
    ];
    for (card, name, field) in cases {
        let found = faults(&plates(card, LOAD));
        assert_eq!(found.len(), 1, "{card}: {found:?}");
        assert_eq!((found[0].0.as_str(), found[0].1), (name, field));
        assert!(found[0].2.contains("negative"), "{found:?}");
    }
}

#[test]
fn faults_of_both_sides_of_a_connector_are_reported_at_once_each_at_its_field() {
    let cases: [(&str, &[&str]); 7] = [
        ("CWELD,500,7,101,ELPAT,,,,,\n,96,196", &["SHIDA", "SHIDB"]),
        ("CWELD,500,7,101,PARTPAT,,,,,\n,96,97", &["PIDA", "PIDB"]),
        (
            "CFAST,500,9,PROP,96,97,101\nPFAST,9,6.,,,5000.,2000.,2000.,40000.,\n,80000.,80000.",
            &["IDA", "IDB"],
        ),
        (
            "CWELD,500,7,101,GRIDID,,,,,\n,12,17,18,992,,,,,\n,37,42,43,991",
            &["GA4", "GB4"],
        ),
        ("CWELD,500,7,999,ELPAT,,,,,\n,10,26", &["GS"]),
        ("CWELD,500,7,,ELPAT,998,999,,,\n,10,26", &["GA", "GB"]),
        ("CWELD,500,7,,ALIGN,998,103", &["GA"]),
    ];
    for (card, fields) in cases {
        let found = faults(&plates(card, LOAD));
        let at: Vec<&str> = found.iter().map(|f| f.1).collect();
        assert_eq!(at, fields, "{card}: {found:?}");
        assert!(found.iter().all(|f| f.2.contains("missing")), "{found:?}");
    }
}

#[test]
fn a_dof_dependent_twice_is_reported_with_the_name_and_field_of_each_kind_of_card() {
    let cases = [
        ("RBE2,500,1,123456,31", "RBE2 500", "GM"),
        ("RBAR,500,1,31,123456,,,123456", "RBAR 500", "CMA"),
        ("RBE3,500,,31,123,1.,123,1,2,\n,6", "RBE3 500", "REFC"),
        (
            "PBUSH,9,K,RIGID,RIGID,RIGID\nCBUSH,500,9,31,32,,,,0",
            "CBUSH 500",
            "GA",
        ),
    ];
    for (card, name, field) in cases {
        let mut b = plates(card, LOAD);
        b.card("RBE2,100,3,123456,31,32");
        let found = faults(&b);
        assert!(!found.is_empty(), "{card}");
        for f in found {
            assert_eq!((f.0.as_str(), f.1), (name, field), "{card}");
        }
    }
}

#[test]
fn a_bad_section_is_reported_once_and_not_as_a_property_that_is_missing() {
    let found = faults(&plates(
        "PBARL,9,1,,TUBE,,,,,\n,5.,9.\nCBAR,500,9,15,40,0.,1.,0.",
        LOAD,
    ));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].0 == "PBARL 9", "{found:?}");
}

fn findings_of(b: &Bulk) -> Vec<strainbridge::finding::Finding> {
    let case = LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(1)],
        spc: Some(1),
        mpc: None,
        relief: Relief::None,
    };
    let solved = solve_cases(&b.model(), &[case], &SolveOptions::default());
    solved.unwrap_or_else(|e| panic!("{e}")).0.findings
}

#[test]
fn a_gap_whose_axis_is_off_its_line_is_reported_to_leave_a_moment_and_one_along_it_is_not() {
    let told = |cid: &str| {
        let mut b = Bulk::default();
        b.card("MAT1,1,210000.,,.3\nPBAR,2,1,200.,9000.,9000.,18000.");
        b.card("GRID,1,,0.,0.,0.\nGRID,2,,500.,0.,0.\nGRID,3,,500.,0.,50.");
        b.card("CBAR,1,2,1,2,0.,1.,0.\nSPC1,1,123456,1,3\nFORCE,1,2,0,100.,1.,0.,0.");
        b.card(&format!("PGAP,6,0.,0.,1000.\nCGAP,7,6,2,3,1.,0.,0.{cid}"));
        let all = findings_of(&b);
        let f = all.iter().find(|f| f.code == "gap-linear");
        f.unwrap_or_else(|| panic!("{all:?}")).message.clone()
    };
    assert!(told(",0").contains("is not balanced"));
    assert!(!told("").contains("is not balanced"));
}

#[test]
fn an_spc_set_that_no_case_selects_does_not_choose_which_end_of_a_rigid_bush_follows() {
    let deck = |unselected: &str| {
        let mut b = Bulk::default();
        b.card("MAT1,1,210000.,,.3\nPBAR,2,1,200.,9000.,9000.,18000.");
        b.card("GRID,1,,0.,0.,0.\nGRID,2,,500.,0.,0.\nGRID,3,,500.,80.,0.\nGRID,4,,600.,80.,0.");
        // Grid 3 depends on grid 4 through the rigid element. Only end 2 of the bush can become dependent.
        b.card("CBAR,1,2,1,2,0.,1.,0.\nRBE2,90,4,123456,3\nSPC1,1,123456,1");
        b.card("FORCE,1,4,0,100.,1.,0.,0.\nCBUSH,5,7,2,3,,,,0");
        b.card("PBUSH,7,K,RIGID,RIGID,RIGID,RIGID,RIGID,RIGID");
        b.card(unselected);
        let found = faults(&b);
        assert!(found.is_empty(), "{unselected}: {found:?}");
        b.solve().displacement_at(4)
    };
    let plain = deck("$");
    // Axial force, and the moment of the force with an arm of 80 above the bar.
    let turn = 100.0 * 80.0 * 500.0 / (210_000.0 * 9000.0);
    assert_near("turn", plain[5], -turn, 1e-9);
    for card in ["SPC1,2,3,2", "MPC,2,2,3,1.,1,3,-1."] {
        assert_eq!(deck(card), plain, "{card}");
    }
}

#[test]
fn sheets_at_an_angle_are_reported_where_their_corners_are_named_too() {
    // The upper patch is inclined by 45 degrees about y.
    let mut b = plates(
        "CWELD,500,7,101,GRIDID,,,,,\n,12,17,18,13,,,,,\n,201,202,203,204",
        LOAD,
    );
    for (id, x, y, z) in [
        (201, 16.0, 10.0, 5.0),
        (202, 26.0, 10.0, 15.0),
        (203, 26.0, 20.0, 15.0),
        (204, 16.0, 20.0, 5.0),
    ] {
        b.card(&format!("GRID,{id},,{x:?},{y:?},{z:?}"));
    }
    b.card("CQUAD4,201,1,201,202,203,204\nSPC1,1,123456,201,THRU,204");
    b.card("SPC1,1,123456,26,THRU,50");
    let all = findings_of(&b);
    let f = all.iter().find(|f| f.code == "connector-angle");
    let f = f.unwrap_or_else(|| panic!("{all:?}"));
    assert_near("angle", f.measured.unwrap(), 45.0, 1e-9);
}
