//! Tests how a structure is supported and whether reactions balance the loads.
//!
//! The cases are dofs with almost no stiffness, springs of negative stiffness, springs to ground and scalar points. The
//! references are closed forms, the same structure modelled in another way, and the balance of forces.

use crate::mesh::{Bulk, assert_near};
use strainbridge::fe::*;
use strainbridge::finding::Severity;

const E: f64 = 210_000.0;
/// Second moment of area of the section of the bar in both planes.
const I: f64 = 9000.0;

fn case(relief: Relief) -> LoadCase {
    LoadCase {
        subcase: 1,
        label: String::new(),
        loads: vec![UnitLoad::Set(1)],
        spc: matches!(relief, Relief::None).then_some(1),
        mpc: None,
        relief,
    }
}

fn answer(b: &Bulk, case: LoadCase) -> Result<(Solution, SolveReport), FeError> {
    let (model, faults) = b.read_model();
    let faults: Vec<_> = faults
        .iter()
        .filter(|f| f.weight() == strainbridge::model::FaultWeight::Error)
        .collect();
    assert!(faults.is_empty(), "{faults:?}");
    solve_cases(&model, &[case], &SolveOptions::default())
}

fn solve_without_relief(b: &Bulk) -> (Solution, SolveReport) {
    answer(b, case(Relief::None)).unwrap_or_else(|e| panic!("{e}"))
}

/// Returns `n` bars of length 500 along x with the grids 1 to n + 1.
fn bar(n: u32) -> Bulk {
    let mut b = Bulk::default();
    b.card("MAT1,1,210000.,,.3,7.85-9\nPBAR,2,1,200.,9000.,9000.,18000.");
    for i in 0..=n {
        b.grid([500.0 * f64::from(i), 0.0, 0.0]);
    }
    for i in 1..=n {
        b.card(&format!("CBAR,{i},2,{i},{},0.,1.,0.", i + 1));
    }
    b
}

fn cantilever(n: u32) -> Bulk {
    let mut b = bar(n);
    b.hold("123456", [1]);
    b
}

/// Returns the lateral stiffness at the tip of a cantilever of length 500.
fn tip_stiffness() -> f64 {
    3.0 * E * I / 500.0_f64.powi(3)
}

fn codes(s: &Solution) -> Vec<(&str, Severity)> {
    s.findings.iter().map(|f| (f.code, f.severity)).collect()
}

/// Fails if reactions and loads do not sum to zero.
#[track_caller]
fn assert_reactions_balance(report: &SolveReport) {
    let r = &report.reactions[0];
    // Rounding error of a few dozen unknowns.
    assert!(r.residual < 1e-9, "{r:?}");
    assert!(
        (0..3).all(|i| (r.total[i] + r.applied[i]).abs() < 1e-6),
        "{r:?}"
    );
}

#[test]
fn a_load_that_autospc_takes_next_to_a_far_stiffer_spring_is_an_error_and_without_autospc_the_answer_is_right()
 {
    // The bending stiffness of the middle grid is hundreds of N/mm. That is less than 1e-8 of the spring along x.
    let deck = |param: &str| {
        let mut b = cantilever(2);
        b.card("GRID,4,,500.,50.,0.\nGRID,5,,500.,100.,0.\nCBAR,3,2,4,5,1.,0.,0.");
        b.card("SPC1,1,123456,5\nCELAS2,9,1.+11,2,1,4,1\nFORCE,1,3,0,100.,0.,1.,0.");
        b.card(param);
        b
    };
    let (solution, report) = solve_without_relief(&deck("PARAM,AUTOSPC,YES"));
    assert!(report.reactions[0].residual > 0.1);
    assert!(
        codes(&solution).contains(&("autospc-holds-load", Severity::Error)),
        "{:?}",
        solution.findings
    );
    let (solution, report) = solve_without_relief(&deck("PARAM,AUTOSPC,NO"));
    let expected = 100.0 * 1000.0_f64.powi(3) / (3.0 * E * I);
    // The stiff spring of the strut leaves only five digits of the softest terms.
    assert_near("tip", solution.cases[0].displacement[2][1], expected, 1e-4);
    assert!(
        codes(&solution).iter().all(|c| c.0 != "autospc-holds-load"),
        "{:?}",
        solution.findings
    );
    assert!(report.reactions[0].residual < 1e-4);
}

/// Returns a plate of 2 x 2 elements with side 10, without drilling stiffness, fixed along its first side. The plate is
/// rotated by `angle` about an axis along x.
fn plate(angle: f64) -> (Bulk, Vec<Vec<u32>>) {
    let mut b = Bulk::shell(E, 0.3, 1.0);
    b.card("PARAM,K6ROT,0.");
    let ids = b.patch(2, 2, |x, y| {
        [20.0 * x, 20.0 * y * angle.cos(), 20.0 * y * angle.sin()]
    });
    b.hold("123456", ids[0].clone());
    (b, ids)
}

#[test]
fn a_moment_about_the_normal_of_a_flat_shell_is_refused_in_any_displacement_frame_and_through_rigid_elements()
 {
    let refused = |b: &Bulk, what: &str| {
        let error = answer(b, case(Relief::None)).map(|_| ()).unwrap_err();
        assert!(
            matches!(error, FeError::LoadOnNothing { dof: 6, .. }),
            "{what}: {error}"
        );
        assert!(error.to_string().contains("no element holds"), "{error}");
    };
    let (mut b, ids) = plate(0.0);
    let corner = ids[2][2];
    b.card(&format!("MOMENT,1,{corner},0,100.,0.,0.,1."));
    refused(&b, "basic");
    // The same moment at a grid with a displacement frame that is turned about the normal.
    let turned = b.text.replace(
        &format!("GRID*   {corner:16}"),
        &format!("$ GRID*   {corner:16}"),
    );
    let mut cd = Bulk::default();
    let kept: Vec<&str> = turned.lines().collect();
    let skip = kept.iter().position(|l| l.starts_with("$ GRID*")).unwrap();
    for (i, line) in kept.iter().enumerate() {
        if i != skip && i != skip + 1 {
            cd.card(line);
        }
    }
    cd.card(&format!("GRID,{corner},,20.,20.,0.,3"));
    cd.card("CORD2R,3,0,0.,0.,0.,0.,0.,1.\n,.8,.6,0.");
    refused(&cd, "CD");
    // Loads that reach the corner through an RBE2: a moment, and a force that has an offset from the corner.
    for (x, load) in [
        ("20.,20.,30.", "MOMENT,1,400,0,100.,0.,0.,1."),
        ("20.,30.,0.", "FORCE,1,400,0,100.,1.,0.,0."),
    ] {
        let (mut b, ids) = plate(0.0);
        b.card(&format!("GRID,400,,{x}"));
        b.card(&format!("RBE2,90,{},123456,400\n{load}", ids[2][2]));
        refused(&b, load);
    }
}

#[test]
fn a_moment_along_a_shell_is_carried_in_every_orientation() {
    // A moment about y of the plate. In the basic frame it has components along y and z, and neither of them is the
    // normal.
    let tip = |angle: f64| {
        let (mut b, ids) = plate(angle);
        let (c, s) = (angle.cos(), angle.sin());
        b.card(&format!("MOMENT,1,{},0,100.,0.,{c:.9},{s:.9}", ids[2][1]));
        let u = solve_without_relief(&b).0.cases[0].displacement[(ids[2][2] - 1) as usize];
        u[2] * c - u[1] * s
    };
    let flat = tip(0.0);
    assert!(flat.abs() > 1e-3);
    // The direction is written with nine digits.
    assert_near("deflection", tip(0.7), flat, 1e-7);
}

#[test]
fn a_negative_spring_softens_as_its_closed_form_and_is_named_where_it_outweighs_the_rest() {
    let deck = |k: f64| {
        let mut b = cantilever(1);
        b.card(&format!("CELAS2,9,{k:?},2,2\nFORCE,1,2,0,100.,0.,1.,0."));
        b
    };
    let (solution, report) = solve_without_relief(&deck(-20.0));
    let expected = 100.0 / (tip_stiffness() - 20.0);
    assert_near("tip", solution.cases[0].displacement[1][1], expected, 1e-9);
    assert_reactions_balance(&report);
    for k in [-100.0, -1000.0, -1e6] {
        let error = answer(&deck(k), case(Relief::None))
            .map(|_| ())
            .unwrap_err();
        let faults = error.faults();
        assert!(
            faults[0].card == "CELAS 9" && faults[0].reason.contains("equilibrium"),
            "{k}: {error}"
        );
    }
    // The spring acts on a dof that nothing else supports.
    let mut b = cantilever(1);
    b.card("GRID,3,,900.,0.,0.\nSPC1,1,23456,3\nCELAS2,9,-1000.,3,1");
    b.card("FORCE,1,2,0,100.,0.,1.,0.");
    let error = answer(&b, case(Relief::None)).map(|_| ()).unwrap_err();
    assert_eq!(error.faults()[0].card, "CELAS 9", "{error}");
}

#[test]
fn springs_and_bushes_to_ground_are_reactions_and_balance_the_loads_with_the_supports() {
    let expected = 100.0 / (tip_stiffness() + 1000.0);
    let ways = [
        "CELAS2,9,1000.,2,2",
        "CELAS2,9,1000.,,,2,2",
        "SPOINT,900\nSPC1,1,,900\nCELAS2,9,1000.,2,2,900",
        "SPOINT,900\nCELAS2,9,2000.,900,,2,2\nCELAS2,10,2000.,900",
        "PBUSH,7,K,,1000.\nCBUSH,9,7,2,,,,,0",
    ];
    for card in ways {
        let mut b = cantilever(1);
        b.card(card);
        b.card("FORCE,1,2,0,100.,0.,1.,0.");
        let (solution, report) = solve_without_relief(&b);
        let tip = solution.cases[0].displacement[1][1];
        assert_near(card, tip, expected, 1e-9);
        assert_reactions_balance(&report);
        let at: Vec<u32> = report.reactions[0].grids.iter().map(|r| r.grid).collect();
        assert_eq!(at, [1, 2], "{card}");
        assert_near(
            card,
            report.reactions[0].grids[1].force[1],
            -1000.0 * tip,
            1e-9,
        );
        assert!(codes(&solution).is_empty(), "{:?}", solution.findings);
    }
}

#[test]
fn a_load_on_a_scalar_point_that_follows_a_grid_is_a_load_on_that_grid() {
    let follows = "SPOINT,900\nMPC,1,900,,1.,2,2,-2.";
    for relief in [Relief::None, Relief::Automatic] {
        let deck = |load: &str| {
            let mut b = match relief {
                Relief::None => cantilever(2),
                _ => bar(2),
            };
            b.card(follows);
            b.card(load);
            let mut case = case(relief);
            case.mpc = Some(1);
            answer(&b, case).unwrap_or_else(|e| panic!("{e}"))
        };
        // The displacement of the scalar point is twice that of the grid. A force of 100 at the point acts as 200 at
        // the grid.
        let (direct, at_grid) = deck("FORCE,1,2,0,200.,0.,1.,0.");
        let (through, report) = deck("SLOAD,1,900,100.");
        for (a, b) in direct.cases[0]
            .displacement
            .iter()
            .zip(&through.cases[0].displacement)
        {
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() < 1e-9, "{relief:?}: {a} {b}");
            }
        }
        let u = &through.cases[0].displacement;
        assert_near("point", u[3][0], 2.0 * u[1][1], 1e-9);
        match relief {
            Relief::None => assert_reactions_balance(&report),
            _ => {
                let (a, b) = (&at_grid.balance[0], &report.balance[0]);
                assert_near("applied", b.applied[1], a.applied[1], 1e-12);
                assert_near("carried", b.applied[1], 200.0, 1e-12);
            }
        }
    }
}

#[test]
fn a_load_on_a_scalar_point_of_a_free_structure_that_follows_nothing_is_refused_by_name() {
    let mut b = bar(2);
    b.card("SPOINT,900\nCELAS2,9,1000.,2,2,900\nSLOAD,1,900,100.");
    let error = answer(&b, case(Relief::Automatic)).map(|_| ()).unwrap_err();
    assert_eq!(error.faults()[0].card, "SPOINT 900", "{error}");
}

#[test]
fn springs_and_equations_that_hold_the_structure_to_ground_unseen_are_reported() {
    let told = |card: &str, mpc: Option<u32>| {
        let mut b = cantilever(1);
        b.card("GRID,3,,500.,0.,80.");
        b.card("SPC1,1,123456,3");
        b.card(card);
        b.card("FORCE,1,2,0,100.,1.,0.,0.");
        let mut case = case(Relief::None);
        case.mpc = mpc;
        let (solution, _) = answer(&b, case).unwrap_or_else(|e| panic!("{e}"));
        solution.findings
    };
    // The spring pulls along x at two ends that are 80 apart in z. No support reports the moment of these forces.
    let findings = told("CELAS2,9,1000.,2,1,3,1", None);
    let f = findings
        .iter()
        .find(|f| f.code == "loads-unbalanced")
        .unwrap_or_else(|| panic!("{findings:?}"));
    assert_eq!(f.severity, Severity::Warning);
    assert!(f.message.contains("CELAS 9"), "{f:?}");
    // The equation couples the rotation of the bar's end to its displacement. Nothing balances the force of the
    // equation.
    let findings = told("MPC,1,2,1,1.,2,5,1000.", Some(1));
    let f = findings
        .iter()
        .find(|f| f.code == "loads-unbalanced")
        .unwrap_or_else(|| panic!("{findings:?}"));
    assert_eq!(f.severity, Severity::Warning);
    assert!(f.message.contains("MPC"), "{f:?}");
    // A spring along the line between its ends leaves no moment.
    assert!(told("CELAS2,9,1000.,2,3,3,3", None).is_empty());
}

#[test]
fn supports_that_all_move_alike_strain_nothing_and_are_not_reported_as_lost_load() {
    let mut b = bar(8);
    b.card("SPC,1,1,123456,0.\nSPC,1,9,123,0.");
    b.card("SPCD,1,1,2,5.\nSPCD,1,9,2,5.");
    let (solution, _) = solve_without_relief(&b);
    assert_near("middle", solution.cases[0].displacement[4][1], 5.0, 1e-9);
    assert!(
        codes(&solution).iter().all(|c| c.0 != "loads-unbalanced"),
        "{:?}",
        solution.findings
    );
}

/// Two bars end to end. A spring joins every dof, or two springs of twice its stiffness with a scalar point between
/// them.
#[test]
fn springs_in_series_tie_a_free_structure_to_no_ground() {
    let joined = |between: &dyn Fn(usize) -> String| {
        let mut b = bar(2);
        b.grid([1000.0, 0.0, 0.0]);
        b.grid([1500.0, 0.0, 0.0]);
        b.card("CBAR,11,2,4,5,0.,1.,0.");
        (1..=6).for_each(|dof| b.card(&between(dof)));
        b.card("FORCE,1,2,0,100.,.3,1.,-.5\nMOMENT,1,5,0,1.+4,1.,.2,.7");
        answer(&b, case(Relief::Automatic)).unwrap_or_else(|e| panic!("{e}"))
    };
    let k = |dof: usize| [1e4, 1e4, 1e4, 1e8, 1e8, 1e8][dof - 1];
    let (direct, _) = joined(&|dof| format!("CELAS2,{},{:?},3,{dof},4,{dof}", 20 + dof, k(dof)));
    let (series, _) = joined(&|dof| {
        let (point, twice) = (900 + dof, 2.0 * k(dof));
        format!(
            "SPOINT,{point}\nCELAS2,{},{twice:?},3,{dof},{point}\nCELAS2,{},{twice:?},{point},,4,{dof}",
            30 + dof,
            40 + dof
        )
    });
    for solution in [&direct, &series] {
        let told = codes(solution);
        assert!(told.iter().all(|c| c.0 != "tied-to-ground"), "{told:?}");
    }
    let (a, b) = (&direct.cases[0].displacement, &series.cases[0].displacement);
    for (a, b) in a.iter().take(5).zip(b) {
        for (dof, (a, b)) in a.iter().zip(b).enumerate() {
            // Rotations are of the order of the displacements divided by the length.
            let scale = if dof < 3 { 1.0 } else { 1e-3 };
            assert!((a - b).abs() < 1e-7 * scale, "{a} {b}");
        }
    }
    for dof in 0..6 {
        assert_near("point", b[5 + dof][0], 0.5 * (b[2][dof] + b[3][dof]), 1e-6);
    }
}
