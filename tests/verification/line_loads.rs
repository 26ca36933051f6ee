//! Loads along beams, enforced displacements by SPCD, forces along grids, scalar springs.

use crate::mesh::{Bulk, near};
use strainbridge::fe::UnitLoad;

const E: f64 = 210_000.0;
const I1: f64 = 9000.0;
const L: f64 = 500.0;

/// One bar along x from a wall; plane 1 is x-y. Recovery point C at y = 5.
fn cantilever(beam: bool, pins: &str, load: &str) -> Bulk {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3,7.85-9");
    let (a, c) = (b.grid([0.0, 0.0, 0.0]), b.grid([L, 0.0, 0.0]));
    if beam {
        b.card("PBEAM,2,1,200.,9000.,4000.,0.,8000.,0.,\n,5.,0.,0.,0.,0.,0.,0.,0.,\n,0.,0.,0.,0.");
        b.card(&format!("CBEAM,1,2,{a},{c},0.,1.,0."));
    } else {
        b.card("PBAR,2,1,200.,9000.,4000.,8000.\n,5.,0.");
        b.card(&format!("CBAR,1,2,{a},{c},0.,1.,0.{pins}"));
    }
    b.hold("123456", [a]);
    b.card(load);
    b
}

#[test]
fn distributed_loads_bend_a_cantilever_as_the_closed_forms_say() {
    let q = 2.0;
    for beam in [false, true] {
        for load in [
            "PLOAD1,1,1,FY,FR,0.,2.,1.,2.",
            "PLOAD1,1,1,FYE,LE,0.,2.,500.,2.",
            "PLOAD1,1,1,FY,FRPR,0.,2.,1.,2.",
        ] {
            let s = cantilever(beam, "", load).solve();
            near(load, s.at(2)[1], q * L.powi(4) / (8.0 * E * I1), 1e-9);
            near("slope", s.at(2)[5], q * L.powi(3) / (6.0 * E * I1), 1e-9);
            // The wall holds the moment q L^2 / 2, which presses the side of positive y together; the tip is free.
            let stations = &s.case.beams.stations[0];
            near(
                "root",
                stations[0].1[0],
                -q * L * L / 2.0 * 5.0 / (E * I1),
                1e-9,
            );
            let last = stations[stations.len() - 1].1[0];
            assert!(last.abs() < 1e-12, "{last:e}");
        }
        // Triangular, from nothing at the wall to q at the tip: 11 q L^4 / 120 E I.
        let s = cantilever(beam, "", "PLOAD1,1,1,FY,FR,0.,0.,1.,2.").solve();
        near(
            "triangle",
            s.at(2)[1],
            11.0 * q * L.powi(4) / (120.0 * E * I1),
            1e-9,
        );
        // A force in the middle: 5 P L^3 / 48 E I; a moment there: 3 M L^2 / 8 E I; along: P L / 2 E A.
        let s = cantilever(beam, "", "PLOAD1,1,1,FY,FR,.5,30.").solve();
        near(
            "middle",
            s.at(2)[1],
            5.0 * 30.0 * L.powi(3) / (48.0 * E * I1),
            1e-9,
        );
        let s = cantilever(beam, "", "PLOAD1,1,1,MZ,FR,.5,900.").solve();
        near(
            "moment",
            s.at(2)[1],
            3.0 * 900.0 * L * L / (8.0 * E * I1),
            1e-9,
        );
        let s = cantilever(beam, "", "PLOAD1,1,1,FX,LE,250.,40.").solve();
        near("along", s.at(2)[0], 40.0 * L / (2.0 * E * 200.0), 1e-9);
    }
}

#[test]
fn a_propped_beam_with_a_pin_at_the_wall_hangs_between_its_ends() {
    // Held in y at the far end, pinned about z at the wall: the far end turns back by q L^3 / 24 E I.
    let mut b = cantilever(false, ",\n,6", "PLOAD1,1,1,FY,FR,0.,2.,1.,2.");
    b.hold("2", [2]);
    let s = b.solve();
    near(
        "end slope",
        s.at(2)[5],
        -2.0 * L.powi(3) / (24.0 * E * I1),
        1e-9,
    );
    for (_, strain) in &s.case.beams.stations[0] {
        assert!(strain[0].abs() < 1e-12, "no moment at the ends: {strain:?}");
    }
}

#[test]
fn spcd_moves_what_spc_holds_and_only_that() {
    let mut b = cantilever(false, "", "SPCD,1,2,2,3.0");
    b.hold("2", [2]);
    let s = b.solve();
    near("enforced", s.at(2)[1], 3.0, 1e-12);
    // A tip displacement alone: slope 3 w / 2 L.
    near("slope", s.at(2)[5], 3.0 * 3.0 / (2.0 * L), 1e-9);
    let free = cantilever(false, "", "SPCD,1,2,2,3.0").model();
    let case = strainbridge::fe::LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(1)],
        spc: Some(1),
        mpc: None,
        relief: strainbridge::fe::Relief::None,
    };
    let error = strainbridge::fe::solve_cases(&free, &[case], &Default::default()).unwrap_err();
    assert!(error.to_string().contains("SPCD moves dof 2"), "{error}");
}

#[test]
fn forces_along_grids_are_those_written_out() {
    let s = cantilever(
        false,
        "",
        "GRID,3,,500.,3.,4.\nSPC1,1,123456,3\nFORCE1,1,2,50.,2,3",
    )
    .solve();
    near(
        "across",
        s.at(2)[1],
        30.0 * L.powi(3) / (3.0 * E * I1),
        1e-9,
    );
    let s = cantilever(
        false,
        "",
        "GRID,3,,500.,3.,0.\nGRID,4,,500.,0.,4.\nSPC1,1,123456,3,4\nFORCE2,1,2,50.,2,3,2,4",
    )
    .solve();
    near(
        "normal of two sides",
        s.at(2)[0],
        50.0 * L / (E * 200.0),
        1e-9,
    );
}

#[test]
fn scalar_springs_in_a_row_give_way_one_after_the_other() {
    let s = cantilever(
        false,
        "",
        "PELAS,5,100.\nCELAS3,11,5,101,102\nCELAS4,12,50.,102\nSLOAD,1,101,10.",
    )
    .solve();
    near("second point", s.at(102)[0], 10.0 / 50.0, 1e-12);
    near(
        "first point",
        s.at(101)[0],
        10.0 / 50.0 + 10.0 / 100.0,
        1e-12,
    );
}
