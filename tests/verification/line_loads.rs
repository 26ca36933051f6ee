//! Loads along beams, enforced displacements by SPCD, forces along grids, scalar springs.

use crate::mesh::{Bulk, assert_near};
use strainbridge::fe::{CaseResult, UnitLoad};
use strainbridge::model::Model;

const E: f64 = 210_000.0;
const I1: f64 = 9000.0;
const L: f64 = 500.0;

/// Returns one bar along x, fixed at a wall. Plane 1 is x-y. Recovery point C is at y = 5.
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
fn distributed_loads_bend_a_cantilever_as_the_closed_forms_state() {
    let q = 2.0;
    for beam in [false, true] {
        for load in [
            "PLOAD1,1,1,FY,FR,0.,2.,1.,2.",
            "PLOAD1,1,1,FYE,LE,0.,2.,500.,2.",
            "PLOAD1,1,1,FY,FRPR,0.,2.,1.,2.",
        ] {
            let s = cantilever(beam, "", load).solve();
            assert_near(
                load,
                s.displacement_at(2)[1],
                q * L.powi(4) / (8.0 * E * I1),
                1e-9,
            );
            assert_near(
                "slope",
                s.displacement_at(2)[5],
                q * L.powi(3) / (6.0 * E * I1),
                1e-9,
            );
            // The moment at the wall is q L^2 / 2, which compresses the side of positive y. The tip is free.
            let stations = &s.case.beams.stations[0];
            assert_near(
                "root",
                stations[0].1[0],
                -q * L * L / 2.0 * 5.0 / (E * I1),
                1e-9,
            );
            let last = stations[stations.len() - 1].1[0];
            assert!(last.abs() < 1e-12, "{last:e}");
        }
        // Triangular load from zero at the wall to q at the tip: 11 q L^4 / 120 E I.
        let s = cantilever(beam, "", "PLOAD1,1,1,FY,FR,0.,0.,1.,2.").solve();
        assert_near(
            "triangle",
            s.displacement_at(2)[1],
            11.0 * q * L.powi(4) / (120.0 * E * I1),
            1e-9,
        );
        // Force in the middle: 5 P L^3 / 48 E I. Moment in the middle: 3 M L^2 / 8 E I. Axial force in the middle: P L
        // / 2 E A.
        let s = cantilever(beam, "", "PLOAD1,1,1,FY,FR,.5,30.").solve();
        assert_near(
            "middle",
            s.displacement_at(2)[1],
            5.0 * 30.0 * L.powi(3) / (48.0 * E * I1),
            1e-9,
        );
        let s = cantilever(beam, "", "PLOAD1,1,1,MZ,FR,.5,900.").solve();
        assert_near(
            "moment",
            s.displacement_at(2)[1],
            3.0 * 900.0 * L * L / (8.0 * E * I1),
            1e-9,
        );
        let s = cantilever(beam, "", "PLOAD1,1,1,FX,LE,250.,40.").solve();
        assert_near(
            "along",
            s.displacement_at(2)[0],
            40.0 * L / (2.0 * E * 200.0),
            1e-9,
        );
    }
}

#[test]
fn a_propped_beam_with_a_pin_at_the_wall_hangs_between_its_ends() {
    // Supported in y at the far end and pinned about z at the wall, the far end rotates back by q L^3 / 24 E I.
    let mut b = cantilever(false, ",\n,6", "PLOAD1,1,1,FY,FR,0.,2.,1.,2.");
    b.hold("2", [2]);
    let s = b.solve();
    assert_near(
        "end slope",
        s.displacement_at(2)[5],
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
    assert_near("enforced", s.displacement_at(2)[1], 3.0, 1e-12);
    // An enforced tip displacement w alone gives the slope 3 w / 2 L.
    assert_near(
        "slope",
        s.displacement_at(2)[5],
        3.0 * 3.0 / (2.0 * L),
        1e-9,
    );
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
    assert_near(
        "across",
        s.displacement_at(2)[1],
        30.0 * L.powi(3) / (3.0 * E * I1),
        1e-9,
    );
    let s = cantilever(
        false,
        "",
        "GRID,3,,500.,3.,0.\nGRID,4,,500.,0.,4.\nSPC1,1,123456,3,4\nFORCE2,1,2,50.,2,3,2,4",
    )
    .solve();
    assert_near(
        "normal of two sides",
        s.displacement_at(2)[0],
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
    assert_near(
        "second point",
        s.displacement_at(102)[0],
        10.0 / 50.0,
        1e-12,
    );
    assert_near(
        "first point",
        s.displacement_at(101)[0],
        10.0 / 50.0 + 10.0 / 100.0,
        1e-12,
    );
}

/// Returns the strain at C of the bar of `cantilever` under the bending moment `m`, from E, I and y = 5.
fn by_moment(m: f64) -> f64 {
    -m * 5.0 / (E * I1)
}

#[test]
fn strain_at_a_station_follows_the_moment_there() {
    type Moment<'a> = &'a dyn Fn(f64) -> f64;
    let step = |x: f64| if x < 200.0 { 1.0 } else { 0.0 };
    let cases: [(&str, Moment<'_>); 6] = [
        ("PLOAD1,1,1,FY,FR,0.,2.,1.,2.", &|x| (L - x).powi(2)),
        // Load from zero at the wall to 2 per length at the tip.
        ("PLOAD1,1,1,FY,FR,0.,0.,1.,2.", &|x| {
            2.0 / L * (L.powi(3) / 3.0 - x * L * L / 2.0 + x.powi(3) / 6.0)
        }),
        // Load over the first 200 only.
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

/// The area and the second moment of a beam double from A to B. Sections between the ends are interpolated linearly.
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
        assert_near(
            "end moment",
            at("MOMENT,1,2,0,900.,0.,0.,1.").0[0],
            by_moment(900.0) / grown,
            1e-9,
        );
        assert_near(
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

/// Mass per length of the cantilever.
const MU: f64 = 7.85e-9 * 200.0;

/// Compares strain at C and at the neutral axis of element 1 at some stations with the moment and axial force there.
fn follows(
    what: &str,
    s: &(Model, CaseResult),
    moment: impl Fn(f64) -> f64,
    force: impl Fn(f64) -> f64,
) {
    let stations = [0.0, 0.1, 0.3, 0.5, 0.75, 0.9, 1.0];
    let size = |of: &dyn Fn(f64) -> f64| {
        stations
            .iter()
            .fold(0.0, |a: f64, x| a.max(of(x * L).abs()))
    };
    let largest = by_moment(size(&moment)).abs() + size(&force) / (E * 200.0);
    assert!(largest > 0.0, "{what}");
    for x in stations {
        let beam = s.0.beam_ix(1).unwrap();
        let (points, axial) = s.1.beams.strain_at(beam, x).unwrap();
        let along = force(x * L) / (E * 200.0);
        let at_c = by_moment(moment(x * L)) + along;
        for (got, expected) in [(points[0], at_c), (axial, along)] {
            let off = (got - expected).abs();
            assert!(off < 1e-9 * largest, "{what} at {x}: {got} for {expected}");
        }
    }
}

#[test]
fn coupled_mass_acts_along_a_bar() {
    let w = 3.0 * std::f64::consts::TAU;
    for beam in [false, true] {
        let solved = |load: &str| {
            let s = cantilever(beam, "", &format!("PARAM,COUPMASS,1\n{load}")).solve();
            (s.model, s.case)
        };
        let weight = MU * 9810.0;
        let s = solved("GRAV,1,,9810.,0.,1.,0.");
        let tip = s.1.displacement[1][1];
        assert_near("tip", tip, weight * L.powi(4) / (8.0 * E * I1), 1e-9);
        follows("weight", &s, |x| weight * (L - x).powi(2) / 2.0, |_| 0.0);
        let s = solved(
            "PARAM,WTMASS,.5\nLOAD,1,3.,2.,6,1.,7\nGRAV,6,,9810.,0.,1.,0.\nPLOAD1,7,1,FY,FR,0.,2.,1.,2.",
        );
        let both = 3.0 * weight + 3.0 * 2.0;
        follows("scaled", &s, |x| both * (L - x).powi(2) / 2.0, |_| 0.0);
        let s = solved("ACCEL,1,,9810.,9810.,0.");
        let bent = |x: f64| weight * (L - x).powi(2) / 2.0;
        follows("skew", &s, bent, |x| weight * (L - x));
        let s = solved("RFORCE,1,1,,3.,0.,0.,1.");
        let pull = |x: f64| MU * w * w * (L * L - x * x) / 2.0;
        follows("spin", &s, |_| 0.0, pull);
    }
    // Fixed at both ends, the bar carries its weight by the moment w L^2 / 12 at the ends and w L^2 / 24 in the middle.
    let mut b = cantilever(false, "", "PARAM,COUPMASS,1\nGRAV,1,,1.,0.,1.,0.");
    b.hold("123456", [2]);
    let s = b.solve();
    let fixed = |x: f64| MU * (L * L / 12.0 - x * (L - x) / 2.0);
    follows("fixed", &(s.model, s.case), fixed, |_| 0.0);
    // With a pin at the wall, the moment is that of a propped cantilever.
    let mut b = cantilever(false, ",\n,6", "PARAM,COUPMASS,1\nGRAV,1,,1.,0.,1.,0.");
    b.hold("123456", [2]);
    let s = b.solve();
    let propped = |x: f64| MU * x * (x / 2.0 - 3.0 * L / 8.0);
    follows("propped", &(s.model, s.case), propped, |_| 0.0);
}

#[test]
fn inertia_relief_acts_along_a_bar_of_coupled_mass() {
    // A lateral force at one end bends a free bar by F x (1 - x / L)^2. An axial force there gives F (1 - x / L).
    for (force, bent, pulled) in [("0.,1.,0.", 30.0, 0.0), ("-1.,0.,0.", 0.0, 30.0)] {
        let mut b = cantilever(
            false,
            "",
            &format!("PARAM,COUPMASS,1\nFORCE,1,1,0,30.,{force}"),
        );
        b.text = b.text.replace("SPC1", "$");
        let model = b.model();
        let case = strainbridge::fe::LoadCase {
            subcase: 1,
            label: String::new(),
            loads: vec![UnitLoad::Set(1)],
            spc: None,
            mpc: None,
            relief: strainbridge::fe::Relief::Automatic,
        };
        let solved = strainbridge::fe::solve_cases(&model, &[case], &Default::default());
        let mut solution = solved.unwrap_or_else(|e| panic!("{e}")).0;
        let s = (model, solution.cases.remove(0));
        let share = |x: f64| 1.0 - x / L;
        follows(
            force,
            &s,
            |x| bent * x * share(x).powi(2),
            |x| pulled * share(x),
        );
    }
}
