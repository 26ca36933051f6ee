//! Structures on supports: closed forms of cantilevers, reactions against what acts, and what is said of supports and loads that make
//! no sense.

use crate::mesh::Bulk;
use strainbridge::fe::*;
use strainbridge::finding::{Finding, Severity};

const E: f64 = 210_000.0;
const LENGTH: f64 = 1000.0;
/// Second moments of the bar's section: bending in x-y (element plane 1), in x-z (plane 2).
const I1: f64 = 9000.0;
const I2: f64 = 4000.0;
const AREA: f64 = 200.0;
const RHO: f64 = 7.85e-9;

/// A straight bar of `n` elements along x, end A at the origin.
fn bar(n: u32) -> Bulk {
    let mut b = Bulk::default();
    b.card(&format!("MAT1,1,{E:?},,.3,7.85-9"));
    b.card(&format!("PBAR,2,1,{AREA:?},{I1:?},{I2:?},8000."));
    let g: Vec<u32> = (0..=n)
        .map(|i| b.grid([LENGTH * f64::from(i) / f64::from(n), 0.0, 0.0]))
        .collect();
    for i in 0..n as usize {
        b.card(&format!("CBAR,{},2,{},{},0.,1.,0.", i + 1, g[i], g[i + 1]));
    }
    b
}

fn on(spc: Option<u32>, relief: Relief, load: UnitLoad) -> LoadCase {
    LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![load],
        spc,
        mpc: None,
        relief,
    }
}

fn solved(b: &Bulk) -> (Solution, SolveReport) {
    let case = on(Some(1), Relief::None, UnitLoad::Set(1));
    solve_cases(&b.model(), &[case], &SolveOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn told<'a>(findings: &'a [Finding], code: &str) -> &'a Finding {
    findings
        .iter()
        .find(|f| f.code == code)
        .unwrap_or_else(|| panic!("no `{code}` among {findings:?}"))
}

/// Relative to the larger: rounding of a few dozen unknowns.
const ROUNDING: f64 = 1e-9;

fn same(what: &str, got: f64, expected: f64) {
    assert!(
        (got - expected).abs() <= ROUNDING * expected.abs(),
        "{what}: {got} for {expected}"
    );
}

#[test]
fn a_cantilever_bends_by_pl3_over_3ei_and_its_support_reacts_with_p_and_pl() {
    let mut b = bar(10);
    b.hold("123456", [1]);
    b.force(11, [0.0, 30.0, 100.0]);
    let (solution, report) = solved(&b);
    let tip = solution.cases[0].displacement[10];
    let cube = LENGTH.powi(3) / (3.0 * E);
    same("along y", tip[1], 30.0 * cube / I1);
    same("along z", tip[2], 100.0 * cube / I2);
    let reactions = &report.reactions[0];
    assert_eq!((reactions.subcase, reactions.grids.len()), (1, 1));
    assert_eq!(reactions.grids[0].grid, 1);
    let force = reactions.grids[0].force;
    for (got, expected) in
        force
            .iter()
            .zip([0.0, -30.0, -100.0, 0.0, 100.0 * LENGTH, -30.0 * LENGTH])
    {
        assert!((got - expected).abs() < 1e-5, "{force:?}");
    }
    for i in 0..6 {
        assert!((reactions.total[i] + reactions.applied[i]).abs() < 1e-5);
    }
    assert!(reactions.residual < ROUNDING, "{}", reactions.residual);
}

#[test]
fn reactions_reach_supports_through_rigid_elements_and_turned_frames() {
    // The same cantilever, its root tied to a support grid 50 below it; that grid's displacement frame is turned about x.
    let mut b = bar(10);
    b.card("CORD2R,5,,0.,0.,0.,0.,1.,1.\n,1.,0.,0.");
    b.card("GRID,50,,0.,0.,-50.,5");
    b.card("RBE2,900,50,123456,1");
    b.hold("123456", [50]);
    b.force(11, [7.0, 0.0, 100.0]);
    let (solution, report) = solved(&b);
    same(
        "tip",
        solution.cases[0].displacement[10][2],
        100.0 * LENGTH.powi(3) / (3.0 * E * I2),
    );
    let reaction = &report.reactions[0].grids;
    assert_eq!((reaction.len(), reaction[0].grid), (1, 50));
    // About grid 50: the force 7 along x acts 50 above it.
    let expected = [-7.0, 0.0, -100.0, 0.0, 100.0 * LENGTH - 7.0 * 50.0, 0.0];
    for (got, expected) in reaction[0].force.iter().zip(expected) {
        assert!((got - expected).abs() < 1e-5, "{reaction:?}");
    }
}

#[test]
fn gravity_on_a_cantilever_is_carried_by_its_support_alone() {
    let mut b = bar(10);
    b.hold("123456", [1]);
    b.card("GRAV,1,,9810.,0.,0.,-1.");
    let (_, report) = solved(&b);
    let weight = RHO * AREA * LENGTH * 9810.0;
    same("reaction", report.reactions[0].total[2], weight);
}

#[test]
fn a_load_on_a_held_grid_says_that_it_strains_nothing() {
    let mut b = bar(4);
    b.hold("123456", [1]);
    b.force(1, [0.0, 0.0, 100.0]);
    b.force(5, [0.0, 0.0, 300.0]);
    let (solution, _) = solved(&b);
    let finding = told(&solution.findings, "load-into-support");
    assert_eq!(finding.severity, Severity::Warning);
    // 100 of 400.
    assert!((finding.measured.unwrap() - 0.25).abs() < 1e-12);
    assert!(finding.message.contains("grid 1, dof 3"), "{finding:?}");
    let mut b = bar(4);
    b.hold("123456", [1]);
    b.force(5, [0.0, 0.0, 300.0]);
    let (solution, _) = solved(&b);
    assert!(
        solution
            .findings
            .iter()
            .all(|f| f.code != "load-into-support")
    );
}

#[test]
fn every_dof_held_is_a_finding_and_no_strain() {
    let mut b = Bulk::shell(E, 0.3, 2.0);
    let ids = b.patch(2, 2, |x, y| [100.0 * x, 100.0 * y, 0.0]);
    let all: Vec<u32> = ids.into_iter().flatten().collect();
    b.force(all[4], [0.0, 0.0, 5.0]);
    b.hold("123456", all);
    let (solution, report) = solved(&b);
    told(&solution.findings, "every-dof-held");
    let case = &solution.cases[0];
    assert_eq!(case.shells.centre.len(), 4);
    assert!(
        case.shells
            .centre
            .iter()
            .flatten()
            .flatten()
            .all(|e| *e == 0.0)
    );
    same("reaction", report.reactions[0].total[2], -5.0);
}

#[test]
fn numbers_that_overflow_are_refused() {
    let mut b = bar(2);
    b.hold("123456", [1]);
    b.card("FORCE,1,3,0,1.+308,0.,0.,10.");
    let case = || on(Some(1), Relief::None, UnitLoad::Set(1));
    let error = solve_cases(&b.model(), &[case()], &SolveOptions::default()).unwrap_err();
    assert!(
        matches!(error, FeError::Overflow { what: "loads", .. }),
        "{error}"
    );
    // A modulus of 1e-300: displacements beyond what a result file holds.
    let mut b = Bulk::default();
    b.card("MAT1,1,1.-300,,.3,7.85-9");
    b.card("PSHELL,1,1,2.,1,,1");
    let ids = b.patch(2, 2, |x, y| [100.0 * x, 100.0 * y, 0.0]);
    b.hold("123456", ids[0].clone());
    b.force(ids[2][2], [1.0, 0.0, 5.0]);
    let error = solve_cases(&b.model(), &[case()], &SolveOptions::default()).unwrap_err();
    assert!(
        matches!(error, FeError::Overflow { .. } | FeError::NotANumber { .. }),
        "{error}"
    );
}

#[test]
fn nothing_that_acts_and_gravity_without_mass_are_said() {
    let mut b = bar(2);
    b.hold("123456", [1]);
    b.force(3, [0.0; 3]);
    let (solution, _) = solved(&b);
    assert!(
        told(&solution.findings, "no-load")
            .message
            .contains("nothing acts")
    );
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3");
    b.card("PBAR,2,1,200.,9000.,4000.,8000.");
    let (a, e) = (b.grid([0.0; 3]), b.grid([100.0, 0.0, 0.0]));
    b.card(&format!("CBAR,1,2,{a},{e},0.,1.,0."));
    b.hold("123456", [a]);
    b.card("GRAV,1,,9810.,0.,0.,-1.");
    let (solution, _) = solved(&b);
    assert!(told(&solution.findings, "no-load").message.contains("mass"));
}

#[test]
fn a_support_that_leaves_a_motion_free_is_a_mechanism_without_relief_and_balanced_with_it() {
    let mut b = bar(4);
    // Held along y and z and against turning, free along x.
    b.hold("23456", [1]);
    b.force(5, [50.0, 0.0, 0.0]);
    let model = b.model();
    let case = |relief| on(Some(1), relief, UnitLoad::Set(1));
    let error = solve_cases(&model, &[case(Relief::None)], &SolveOptions::default()).unwrap_err();
    let FeError::Mechanism { dofs, .. } = &error else {
        panic!("{error}")
    };
    assert_eq!(dofs[0].dof, 1);
    let (solution, _) =
        solve_cases(&model, &[case(Relief::Automatic)], &SolveOptions::default()).unwrap();
    // The force is carried by inertia: left of the middle lie 3/8 of the lumped mass, which the second element pulls along.
    let axial = &solution.cases[0].beams.axial;
    same("middle", axial[1][1], 50.0 * 3.0 / 8.0 / (E * AREA));
    // Without any mass a structure that its supports hold needs no relief to be solved.
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3");
    b.card("PBAR,2,1,200.,9000.,4000.,8000.");
    let (a, e) = (b.grid([0.0; 3]), b.grid([1000.0, 0.0, 0.0]));
    b.card(&format!("CBAR,1,2,{a},{e},0.,1.,0."));
    b.hold("123456", [a]);
    b.force(e, [0.0, 0.0, 100.0]);
    let (solution, _) = solve_cases(
        &b.model(),
        &[case(Relief::Automatic)],
        &SolveOptions::default(),
    )
    .unwrap();
    same(
        "tip",
        solution.cases[0].displacement[1][2],
        100.0 * LENGTH.powi(3) / (3.0 * E * I2),
    );
}

#[test]
fn inside_out_solids_re_entrant_and_folded_quadrilaterals_are_named() {
    let mut b = Bulk::shell(E, 0.3, 2.0);
    let x = [
        [0.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.9, 0.9, 0.0],
        [0.0, 2.0, 0.0],
    ];
    let g = x.map(|x| b.grid(x));
    b.quad(g);
    let x = [
        [5.0, 0.0, 0.0],
        [7.0, 0.0, 0.0],
        [7.0, 2.0, 1.0],
        [5.0, 2.0, 0.0],
    ];
    let g = x.map(|x| b.grid(x));
    b.quad(g);
    let x = [
        [10.0, 0.0, 0.0],
        [11.0, 0.0, 0.0],
        [10.0, 1.0, 0.0],
        [10.0, 0.0, 1.0],
    ];
    let g = x.map(|x| b.grid(x));
    b.card("PSOLID,8,1");
    b.card(&format!("CTETRA,31,8,{},{},{},{}", g[0], g[1], g[2], g[3]));
    b.card(&format!("CTETRA,32,8,{},{},{},{}", g[0], g[2], g[1], g[3]));
    let findings = check_shapes(&b.model());
    assert!(told(&findings, "re-entrant-quad").subject.ends_with(" 1"));
    assert!(told(&findings, "folded-quad").subject.ends_with(" 2"));
    assert!(told(&findings, "inverted-solid").subject.ends_with(" 32"));
    assert_eq!(findings.len(), 3);
}

#[test]
fn work_that_is_to_stop_gives_no_solution() {
    let mut b = bar(4);
    b.hold("123456", [1]);
    b.force(5, [0.0, 0.0, 100.0]);
    let case = on(Some(1), Relief::None, UnitLoad::Set(1));
    let options = SolveOptions {
        stop: strainbridge::stop::Stop::new(),
        ..SolveOptions::default()
    };
    let model = b.model();
    assert!(solve_cases(&model, std::slice::from_ref(&case), &options).is_ok());
    options.stop.ask();
    assert!(matches!(
        solve_cases(&model, &[case], &options),
        Err(FeError::Stopped)
    ));
}
