//! Structures on supports: closed forms of cantilevers, reactions and loads, and messages about supports and loads that
//! are not possible.

use crate::mesh::Bulk;
use strainbridge::fe::*;
use strainbridge::finding::{Finding, Severity};

const E: f64 = 210_000.0;
const LENGTH: f64 = 1000.0;
/// Second moments of area of the bar: I1 in x-y (element plane 1), I2 in x-z (plane 2).
const I1: f64 = 9000.0;
const I2: f64 = 4000.0;
const AREA: f64 = 200.0;
const RHO: f64 = 7.85e-9;

/// Returns a straight bar of `n` elements along x. End A is at the origin.
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

fn build_load_case(spc: Option<u32>, relief: Relief, load: UnitLoad) -> LoadCase {
    LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![load],
        spc,
        mpc: None,
        relief,
    }
}

fn solve_load_case(b: &Bulk) -> (Solution, SolveReport) {
    let case = build_load_case(Some(1), Relief::None, UnitLoad::Set(1));
    solve_cases(&b.model(), &[case], &SolveOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn find_finding<'a>(findings: &'a [Finding], code: &str) -> &'a Finding {
    findings
        .iter()
        .find(|f| f.code == code)
        .unwrap_or_else(|| panic!("no `{code}` among {findings:?}"))
}

/// Relative rounding error of a few dozen unknowns.
const ROUNDING: f64 = 1e-9;

fn assert_equal_to_rounding(what: &str, got: f64, expected: f64) {
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
    let (solution, report) = solve_load_case(&b);
    let tip = solution.cases[0].displacement[10];
    let cube = LENGTH.powi(3) / (3.0 * E);
    assert_equal_to_rounding("along y", tip[1], 30.0 * cube / I1);
    assert_equal_to_rounding("along z", tip[2], 100.0 * cube / I2);
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
    // The same cantilever. An RBE2 ties its root to a support grid 50 below it, whose displacement frame is turned
    // about x.
    let mut b = bar(10);
    b.card("CORD2R,5,,0.,0.,0.,0.,1.,1.\n,1.,0.,0.");
    b.card("GRID,50,,0.,0.,-50.,5");
    b.card("RBE2,900,50,123456,1");
    b.hold("123456", [50]);
    b.force(11, [7.0, 0.0, 100.0]);
    let (solution, report) = solve_load_case(&b);
    assert_equal_to_rounding(
        "tip",
        solution.cases[0].displacement[10][2],
        100.0 * LENGTH.powi(3) / (3.0 * E * I2),
    );
    let reaction = &report.reactions[0].grids;
    assert_eq!((reaction.len(), reaction[0].grid), (1, 50));
    // Moments are about grid 50. The force 7 along x acts 50 above it.
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
    let (_, report) = solve_load_case(&b);
    let weight = RHO * AREA * LENGTH * 9810.0;
    assert_equal_to_rounding("reaction", report.reactions[0].total[2], weight);
}

#[test]
fn a_load_on_a_held_grid_is_reported_as_without_strain() {
    let mut b = bar(4);
    b.hold("123456", [1]);
    b.force(1, [0.0, 0.0, 100.0]);
    b.force(5, [0.0, 0.0, 300.0]);
    let (solution, _) = solve_load_case(&b);
    let finding = find_finding(&solution.findings, "load-into-support");
    assert_eq!(finding.severity, Severity::Warning);
    // 100 of 400.
    assert!((finding.measured.unwrap() - 0.25).abs() < 1e-12);
    assert!(finding.message.contains("grid 1, dof 3"), "{finding:?}");
    let mut b = bar(4);
    b.hold("123456", [1]);
    b.force(5, [0.0, 0.0, 300.0]);
    let (solution, _) = solve_load_case(&b);
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
    let (solution, report) = solve_load_case(&b);
    find_finding(&solution.findings, "every-dof-held");
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
    assert_equal_to_rounding("reaction", report.reactions[0].total[2], -5.0);
}

#[test]
fn numbers_that_overflow_are_refused() {
    let mut b = bar(2);
    b.hold("123456", [1]);
    b.card("FORCE,1,3,0,1.+308,0.,0.,10.");
    let case = || build_load_case(Some(1), Relief::None, UnitLoad::Set(1));
    let error = solve_cases(&b.model(), &[case()], &SolveOptions::default()).unwrap_err();
    assert!(
        matches!(error, FeError::Overflow { what: "loads", .. }),
        "{error}"
    );
    // A modulus of 1e-300 gives displacements that a result file cannot contain.
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
fn missing_loads_and_gravity_without_mass_are_reported() {
    let mut b = bar(2);
    b.hold("123456", [1]);
    b.force(3, [0.0; 3]);
    let (solution, _) = solve_load_case(&b);
    assert!(
        find_finding(&solution.findings, "no-load")
            .message
            .contains("Nothing acts")
    );
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3");
    b.card("PBAR,2,1,200.,9000.,4000.,8000.");
    let (a, e) = (b.grid([0.0; 3]), b.grid([100.0, 0.0, 0.0]));
    b.card(&format!("CBAR,1,2,{a},{e},0.,1.,0."));
    b.hold("123456", [a]);
    b.card("GRAV,1,,9810.,0.,0.,-1.");
    let (solution, _) = solve_load_case(&b);
    assert!(
        find_finding(&solution.findings, "no-load")
            .message
            .contains("mass")
    );
}

#[test]
fn a_support_that_leaves_a_motion_free_is_a_mechanism_without_relief_and_balanced_with_it() {
    let mut b = bar(4);
    // The bar is fixed along y and z and in rotation, and free along x.
    b.hold("23456", [1]);
    b.force(5, [50.0, 0.0, 0.0]);
    let model = b.model();
    let case = |relief| build_load_case(Some(1), relief, UnitLoad::Set(1));
    let error = solve_cases(&model, &[case(Relief::None)], &SolveOptions::default()).unwrap_err();
    let FeError::Mechanism { dofs, .. } = &error else {
        panic!("{error}")
    };
    assert_eq!(dofs[0].dof, 1);
    let (solution, _) =
        solve_cases(&model, &[case(Relief::Automatic)], &SolveOptions::default()).unwrap();
    // Inertia balances the force. 3/8 of the lumped mass are left of the middle, and the second element accelerates
    // them.
    let axial = &solution.cases[0].beams.axial;
    assert_equal_to_rounding("middle", axial[1][1], 50.0 * 3.0 / 8.0 / (E * AREA));
    // Without any mass, a supported structure is solved without inertia relief.
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
    assert_equal_to_rounding(
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
    assert!(
        find_finding(&findings, "re-entrant-quad")
            .subject
            .ends_with(" 1")
    );
    assert!(
        find_finding(&findings, "folded-quad")
            .subject
            .ends_with(" 2")
    );
    assert!(
        find_finding(&findings, "inverted-solid")
            .subject
            .ends_with(" 32")
    );
    assert_eq!(findings.len(), 3);
}

#[test]
fn work_that_is_to_stop_gives_no_solution() {
    let mut b = bar(4);
    b.hold("123456", [1]);
    b.force(5, [0.0, 0.0, 100.0]);
    let case = build_load_case(Some(1), Relief::None, UnitLoad::Set(1));
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

/// Tip force P on a cantilever of length L: u = P L^3 / (3 E I). The property states bending stiffness and no area.
#[test]
fn a_bar_without_area_bends_as_a_cantilever() {
    for (property, plane, inertia) in [
        (format!("PBAR,2,1,,{I1:?}"), 2, I1),
        (format!("PBAR,2,1,0.,,{I2:?}"), 3, I2),
    ] {
        let mut b = Bulk::default();
        b.card(&format!("MAT1,1,{E:?},,.3,7.85-9"));
        b.card(&property);
        let g = [0.0, LENGTH].map(|x| b.grid([x, 0.0, 0.0]));
        b.card(&format!("CBAR,1,2,{},{},0.,1.,0.", g[0], g[1]));
        b.card(&format!("SPC1,1,123456,{}", g[0]));
        let direction = if plane == 2 { "0.,1.,0." } else { "0.,0.,1." };
        b.card(&format!("FORCE,1,{},,100.,{direction}", g[1]));
        let (solution, _) = solve_load_case(&b);
        let tip = solution.cases[0].displacement[1][plane - 1];
        assert_equal_to_rounding(&property, tip, 100.0 * LENGTH.powi(3) / (3.0 * E * inertia));
    }
}

#[test]
fn a_bar_without_any_stiffness_is_a_fault() {
    let mut b = bar(1);
    b.card("PBAR,9,1");
    b.card("CBAR,9,9,1,2,0.,1.,0.");
    let found = b.read_model().1;
    let wrong = "PBAR 9: a bar whose A, I1, I2 and J are all 0 is not supported";
    assert!(found.iter().any(|f| f.to_string() == wrong), "{found:?}");
}

#[test]
fn a_rod_without_any_stiffness_is_a_fault_and_one_with_torsion_alone_twists() {
    for (cards, name) in [
        (&["PROD,9,1", "CROD,9,9,1,2"][..], "PROD 9"),
        (&["PTUBE,9,1,0.", "CTUBE,9,9,1,2"], "PTUBE 9"),
        (&["CONROD,9,1,2,1,0."], "CONROD 9"),
    ] {
        let mut b = bar(1);
        cards.iter().for_each(|c| b.card(c));
        let found = b.read_model().1;
        let wrong = format!("{name}: a rod whose A and J are both 0 is not supported");
        assert!(found.iter().any(|f| f.to_string() == wrong), "{found:?}");
    }
    // The bar fixes everything except its twist, which the rod resists with GJ / L alone.
    let torsion = 500.0;
    let mut b = Bulk::default();
    b.card(&format!("MAT1,1,{E:?},,.3"));
    let g = [0.0, LENGTH].map(|x| b.grid([x, 0.0, 0.0]));
    b.card(&format!("CONROD,1,{},{},1,0.,{torsion:?}", g[0], g[1]));
    b.card(&format!("SPC1,1,123456,{}", g[0]));
    b.card(&format!("SPC1,1,12356,{}", g[1]));
    b.card(&format!("MOMENT,1,{},,100.,1.,0.,0.", g[1]));
    let (solution, _) = solve_load_case(&b);
    let shear = E / 2.6;
    let twist = 100.0 * LENGTH / (shear * torsion);
    assert_equal_to_rounding("twist", solution.cases[0].displacement[1][3], twist);
}

#[test]
fn a_dof_that_is_held_and_dependent_is_found_before_a_solution() {
    // The bar is from grid 1 to grid 2. One dependent dof joins grid 3 to grid 2.
    let deck = |joint: &str, support: &str| {
        let mut b = bar(1);
        b.grid([LENGTH, 1.0, 0.0]);
        b.card("SPC1,1,123456,1");
        b.card(joint);
        b.card(support);
        held_dependents(&b.model(), Some(1), Some(4))
    };
    for (joint, card) in [
        ("RBE2,7,2,123,3", "RBE2 7"),
        ("RBE3,7,,3,123,1.,123456,2", "RBE3 7"),
        ("MPC,4,3,2,1.,2,2,-1.", "MPC 4"),
    ] {
        let finding = deck(joint, "SPC1,1,2,3").unwrap_or_else(|| panic!("{joint}"));
        assert_eq!(
            (finding.severity, finding.code),
            (Severity::Error, "contradicting-spc")
        );
        let both = format!("grid 3 dof 2: SPC 1 and {card}");
        assert!(finding.message.contains(&both), "{finding:?}");
        assert!(deck(joint, "SPC1,1,456,3").is_none(), "{joint}");
        assert!(deck(joint, "SPC1,2,2,3").is_none(), "another set: {joint}");
    }
}

/// Returns a bar of length 2 on bushes or springs to ground, without an SPC set. `rho` is the density of its material.
fn bar_on(springs: &str, rho: &str) -> Bulk {
    let mut b = Bulk::default();
    b.card(&format!("MAT1,1,1.+10,,.3,{rho}"));
    b.card("PBAR,1,1,.01,1.-5,1.-5,1.-5\n,.05,0.");
    let (a, e) = (b.grid([0.0; 3]), b.grid([2.0, 0.0, 0.0]));
    b.card(&format!("CBAR,1,1,{a},{e},0.,1.,0."));
    b.card(springs);
    b.card("FORCE,1,2,,1000.,1.,0.,0.");
    b
}

/// A stiffness far below or above that of the bar is a valid support. Neither mass nor an SPC set is needed.
#[test]
fn a_structure_on_springs_to_ground_is_held_by_them() {
    for k in [1e3, 1e6, 1e12] {
        let bush = format!(
            "CBUSH,2,2,1,,,,,0\nPBUSH,2,K{}",
            format!(",{k:?}").repeat(6)
        );
        let springs: Vec<String> = (1..=6)
            .map(|c| format!("CELAS2,{},{k:?},1,{c}", 10 + c))
            .collect();
        let springs = springs.join("\n");
        let anchored = format!(
            "GRID,9,,0.,0.,0.,,123456\nCBUSH,2,2,1,9,,,,0\nPBUSH,2,K{}",
            format!(",{k:?}").repeat(6)
        );
        for (held, rho) in [
            (&bush, "100."),
            (&bush, ""),
            (&springs, ""),
            (&anchored, ""),
        ] {
            let model = bar_on(held, rho).model();
            let support = support_of(&model, SupportChoice::Deck).unwrap();
            assert!(support.is_held(), "{held}");
            assert!(relief_finding(&model, support, SupportChoice::Deck).is_none());
            for relief in [Relief::Automatic, support.relief] {
                let case = build_load_case(None, relief, UnitLoad::Set(1));
                let (solution, report) =
                    solve_cases(&model, &[case], &SolveOptions::default()).unwrap();
                assert!(
                    solution
                        .findings
                        .iter()
                        .all(|f| f.severity == Severity::Info),
                    "{:?}",
                    solution.findings
                );
                let u = &solution.cases[0].displacement;
                assert_equal_to_rounding("grid 1", u[0][0], 1000.0 / k);
                assert_equal_to_rounding(
                    "grid 2",
                    u[1][0],
                    1000.0 / k + 1000.0 * 2.0 / (1e10 * 0.01),
                );
                assert_equal_to_rounding("strain", solution.cases[0].beams.axial[0][0], 1e-5);
                assert_equal_to_rounding("reaction", report.reactions[0].total[0], -1000.0);
            }
        }
    }
}

/// Statically determinate springs, one more at each step. Each one removes one motion from the motions that nothing
/// resists.
#[test]
fn each_spring_to_ground_takes_one_rigid_motion() {
    let at = [(1, 3), (2, 3), (3, 3), (1, 1), (1, 2), (2, 2)];
    for n in 0..=6 {
        let mut b = Bulk::default();
        b.card("MAT1,1,210000.,,.3,7.85-9\nPBAR,2,1,200.,9000.,4000.,8000.");
        // The structure is far from the origin, on springs far softer than the bars.
        for x in [[0.0, 0.0], [1000.0, 0.0], [0.0, 1000.0]] {
            b.grid([1e5 + x[0], x[1] - 1e5, 0.0]);
        }
        b.card("CBAR,1,2,1,2,0.,0.,1.\nCBAR,2,2,1,3,0.,0.,1.");
        for (i, (grid, dof)) in at.iter().take(n).enumerate() {
            b.card(&format!("CELAS2,{},1.-3,{grid},{dof}", 10 + i));
        }
        b.force(2, [3.0, 5.0, 7.0]);
        let model = b.model();
        let support = Support::without_spc(&model);
        assert_eq!(usize::from(support.by_springs), n);
        assert_eq!(support.is_held(), n == 6);
        assert_eq!(determinate_dofs(&model).len(), 6 - n);
        let modes = solve_modes(&model, None, None, 3, &SolveOptions::default()).unwrap();
        assert_eq!(modes.rigid_motions, 6 - n);
    }
}

/// Returns a frame on three springs along z. It is free along x and y and about z.
fn on_vertical_springs(k: f64) -> Bulk {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3,7.85-9\nPBAR,2,1,200.,9000.,4000.,8000.");
    for x in [[0.0, 0.0], [1000.0, 0.0], [0.0, 800.0], [1000.0, 800.0]] {
        b.grid([x[0], x[1], 0.0]);
    }
    b.card("CBAR,1,2,1,2,0.,0.,1.\nCBAR,2,2,1,3,0.,0.,1.\nCBAR,3,2,2,4,0.,0.,1.\nCBAR,4,2,3,4,0.,0.,1.");
    (1..=3).for_each(|g| b.card(&format!("CELAS2,{},{k:?},{g},3", 10 + g)));
    b
}

#[test]
fn springs_carry_what_they_resist_and_inertia_balances_the_rest() {
    let k = 40.0;
    let mut b = on_vertical_springs(k);
    b.force(4, [20.0, 0.0, 90.0]);
    let model = b.model();
    let support = support_of(&model, SupportChoice::Deck).unwrap();
    assert_eq!((support.by_springs, support.relief), (3, Relief::Automatic));
    let assumed = relief_finding(&model, support, SupportChoice::Deck).unwrap();
    assert_eq!(assumed.code, "inertia-relief-assumed");
    let case = build_load_case(None, support.relief, UnitLoad::Set(1));
    let (solution, report) = solve_cases(&model, &[case], &SolveOptions::default()).unwrap();
    assert!(solution.findings.iter().all(|f| f.code != "tied-to-ground"));
    // Equilibrium of a plate on three feet under a force at the fourth corner: -1, 1, 1 times the force.
    for (g, share) in [(0, -1.0), (1, 1.0), (2, 1.0)] {
        assert_equal_to_rounding(
            "foot",
            solution.cases[0].displacement[g][2] * k,
            90.0 * share,
        );
    }
    let balance = &report.balance[0];
    let mass = report.mass.as_ref().unwrap().mass;
    assert_equal_to_rounding("along x", balance.acceleration[0], 20.0 / mass);
    assert!(balance.inertia[2].abs() < 1e-9, "{balance:?}");
    // The deck that is written for such a job supports the free motions by SUPORT.
    let dofs = determinate_dofs(&model);
    assert!(
        dofs.len() == 3 && dofs.iter().all(|(_, dof)| [1, 2].contains(dof)),
        "{dofs:?}"
    );
    for (grid, dof) in dofs {
        b.card(&format!("SUPORT,{},{dof}", model.grids[grid.us()].id));
    }
    let stated = build_load_case(None, Relief::Suport(None), UnitLoad::Set(1));
    let (by_suport, _) = solve_cases(&b.model(), &[stated], &SolveOptions::default()).unwrap();
    let strain = |s: &Solution| s.cases[0].beams.axial[3][1];
    assert!((strain(&solution) - strain(&by_suport)).abs() <= ROUNDING * strain(&solution).abs());
}

#[test]
fn stated_relief_of_a_structure_on_springs_is_limited_with_a_warning() {
    let mut b = on_vertical_springs(40.0);
    let free = support_of(&b.model(), SupportChoice::Free).unwrap();
    let finding = relief_finding(&b.model(), free, SupportChoice::Free).unwrap();
    assert_eq!(
        (finding.code, finding.severity),
        ("tied-to-ground", Severity::Warning)
    );
    assert!(
        finding.message.contains("3 rigid motions of 6"),
        "{}",
        finding.message
    );
    b.card("PARAM,INREL,-2");
    let deck = support_of(&b.model(), SupportChoice::Deck).unwrap();
    assert!(relief_finding(&b.model(), deck, SupportChoice::Deck).is_some());
}

/// Springs in series through scalar points are springs to ground. A spring between grids, or an idle spring, is not a
/// spring to ground.
#[test]
fn chains_of_scalar_points_reach_ground_and_springs_within_the_structure_do_not() {
    let by = |cards: &str| {
        let mut b = bar(2);
        b.card(cards);
        Support::without_spc(&b.model()).by_springs
    };
    assert_eq!(
        by("SPOINT,91,92\nCELAS2,11,5.,1,3,91\nCELAS2,12,7.,91,,92\nCELAS2,13,9.,92"),
        1
    );
    assert_eq!(
        by("SPOINT,91,92\nCELAS2,11,5.,1,3,91\nCELAS2,12,7.,91,,92"),
        0
    );
    assert_eq!(by("CELAS2,11,5.,1,1,2,1"), 0);
    assert_eq!(by("CELAS2,11,0.,1,1"), 0);
    assert_eq!(by("PARAM,K6ROT,100."), 0);
}

#[test]
fn a_floor_under_a_structure_on_springs_is_refused() {
    let model = on_vertical_springs(40.0).model();
    let contacts: Vec<_> = (1..=4).filter_map(|g| model.grid_ix(g)).collect();
    let error = floor::solve_standing(&model, 2, &contacts, &[], None).unwrap_err();
    assert!(error.to_string().contains("springs to ground"), "{error}");
}
