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

/// Strain at C along the bar of `cantilever` by its bending moment, in terms of E, I and y = 5.
fn by_moment(m: f64) -> f64 {
    -m * 5.0 / (E * I1)
}

#[test]
fn strain_at_a_station_follows_the_moment_there() {
    type Moment<'a> = &'a dyn Fn(f64) -> f64;
    let step = |x: f64| if x < 200.0 { 1.0 } else { 0.0 };
    let cases: [(&str, Moment<'_>); 6] = [
        ("PLOAD1,1,1,FY,FR,0.,2.,1.,2.", &|x| (L - x).powi(2)),
        // From nothing at the wall to 2 per length at the tip.
        ("PLOAD1,1,1,FY,FR,0.,0.,1.,2.", &|x| {
            2.0 / L * (L.powi(3) / 3.0 - x * L * L / 2.0 + x.powi(3) / 6.0)
        }),
        // Over the first 200 alone.
        ("PLOAD1,1,1,FY,LE,0.,2.,200.,2.", &|x| {
            (200.0 - x).max(0.0).powi(2)
        }),
        ("PLOAD1,1,1,FY,LE,200.,30.", &|x| {
            30.0 * (200.0 - x).max(0.0)
        }),
        ("PLOAD1,1,1,MZ,LE,200.,900.", &|x| 900.0 * step(x)),
        ("FORCE,1,2,0,30.,0.,1.,0.", &|x| 30.0 * (L - x)),
    ];
    for beam in [false, true] {
        for (load, moment) in &cases {
            let s = cantilever(beam, "", load).solve();
            let largest = by_moment(moment(0.0)).abs();
            for station in [0.0, 0.1, 0.3, 0.5, 0.75, 1.0] {
                let (points, axial) = s
                    .case
                    .beams
                    .strain_at(s.model.beam_ix(1).unwrap(), station)
                    .unwrap();
                let expected = by_moment(moment(station * L));
                assert!(
                    (points[0] - expected).abs() < 1e-10 * largest && axial.abs() < 1e-10 * largest,
                    "{load} at {station}: {} for {expected}",
                    points[0]
                );
            }
        }
    }
}

/// A beam whose area and second moment double from A to B; stations between the ends are those of the straight line between both.
#[test]
fn strain_at_a_station_of_a_tapered_beam_is_that_of_the_section_there() {
    let solved = |load: &str| {
        let mut b = Bulk::default();
        b.card("MAT1,1,210000.,,.3,7.85-9");
        b.card("PBEAM,2,1,200.,9000.,4000.,0.,8000.,0.,\n,5.,0.,0.,0.,0.,0.,0.,0.,\n,YES,1.,400.,18000.,8000.,0.,16000.,0.,\n,5.,0.,0.,0.,0.,0.,0.,0.");
        let (a, c) = (b.grid([0.0; 3]), b.grid([L, 0.0, 0.0]));
        b.card(&format!("CBEAM,1,2,{a},{c},0.,1.,0."));
        b.hold("123456", [a]);
        b.card(load);
        b.solve()
    };
    for x in [0.0, 0.25, 0.5, 0.9, 1.0] {
        let at = |load: &str| {
            let s = solved(load);
            s.case
                .beams
                .strain_at(s.model.beam_ix(1).unwrap(), x)
                .unwrap()
        };
        let grown = 1.0 + x;
        near(
            "end moment",
            at("MOMENT,1,2,0,900.,0.,0.,1.").0[0],
            by_moment(900.0) / grown,
            1e-9,
        );
        near(
            "axial",
            at("FORCE,1,2,0,700.,1.,0.,0.").1,
            700.0 / (E * 200.0 * grown),
            1e-9,
        );
        let tip = at("FORCE,1,2,0,30.,0.,1.,0.").0[0];
        let expected = by_moment(30.0 * L * (1.0 - x)) / grown;
        assert!(
            (tip - expected).abs() < 1e-9 * by_moment(30.0 * L).abs(),
            "{tip} for {expected}"
        );
    }
}
