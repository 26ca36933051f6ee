//! Compares SUBCOM, SYMCOM and REPCASE with closed forms of rods.

use std::path::Path;
use strainbridge::fe::{Corners, SolveOptions};
use strainbridge::finding::Finding;
use strainbridge::host::context::InMemory;
use strainbridge::host::outcome::Outcome;
use strainbridge::workflow::check::check;
use strainbridge::workflow::solve::{SolvedCases, solve_deck};
use strainbridge::{Context, Faults, strains};

/// Axial stiffness of the bars.
const EA: f64 = 1e8;
/// Rounding error of a solution with a few unknowns.
const ROUNDING: f64 = 1e-12;

fn deck(case_control: &str, bulk: &str) -> String {
    format!(
        "SOL 101\nCEND\n{case_control}BEGIN BULK\nPBAR,1,1,.01,1.-5,1.-5,1.-5\nMAT1,1,1.+10,,.3\n{bulk}ENDDATA\n"
    )
}

fn solve_bars(case_control: &str, bulk: &str) -> Result<Outcome<SolvedCases>, Faults> {
    let files = InMemory::default().with_file("bars.bdf", deck(case_control, bulk));
    let options = SolveOptions {
        corners: Corners::Compute,
        ..SolveOptions::default()
    };
    solve_deck(Path::new("bars.bdf"), options, &Context::new(&files))
}

/// Returns subcase ids and the axial displacement of the grid with this index.
fn displacements(o: &SolvedCases, grid: usize) -> Vec<(u32, f64)> {
    let cases = o.solution.cases.iter();
    cases
        .map(|c| (c.subcase, c.displacement[grid][0]))
        .collect()
}

/// Bar of length 2, fixed at grid 1, with axial forces at grid 2.
const BAR: &str = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nCBAR,1,1,1,2,0.,1.,0.\nSPC1,1,123456,1\n\
     FORCE,1,2,,1000.,1.,0.,0.\nFORCE,2,2,,300.,1.,0.,0.\n";

#[test]
fn subcom_adds_the_subcases_above_it() {
    let cases = "SPC = 1\nSUBCASE 1\nLOAD = 1\nSUBCASE 2\nLOAD = 2\nSUBCOM 3\nLABEL = both\nSUBSEQ = 1., -2.\n\
         REPCASE 4\nSUBCASE 11\nLOAD = 2\nSUBCOM 12\nSUBSEQ = 0., 1., 1.\n";
    let o = solve_bars(cases, BAR).unwrap();
    // R_n refers to the SUBCASEs directly above. SUBCOMs do not count.
    let forces = [
        (1, 1000.0),
        (2, 300.0),
        (3, 400.0),
        (4, 300.0),
        (11, 300.0),
        (12, 600.0),
    ];
    assert_eq!(o.cases.len(), forces.len());
    for (i, (subcase, force)) in forces.into_iter().enumerate() {
        let case = &o.solution.cases[i];
        assert_eq!((case.subcase, o.cases[i].subcase), (subcase, subcase));
        assert!((case.displacement[1][0] - force * 2.0 / EA).abs() < ROUNDING);
        assert!((case.beams.axial[0][0] - force / EA).abs() < ROUNDING);
        assert!((case.beams.stations[0][0].1[0] - force / EA).abs() < ROUNDING);
        let reactions = o.reactions.iter().find(|r| r.subcase == subcase).unwrap();
        assert!((reactions.total[0] + force).abs() < 1e-9 * 1000.0);
        assert!((reactions.grids[0].force[0] + force).abs() < 1e-9 * 1000.0);
    }
    assert_eq!(o.solution.cases[2].label, "both");
    assert!(o.findings.0.iter().all(|f| f.code != "subcase-left-out"));
}

/// A bar from -2 to 2 fixed at both ends, with F at x = 1. The model is its right half with symmetric and antisymmetric
/// supports at x = 0. u(1) = 3/4 F / EA, u(0) = 1/2 F / EA, u(-1) = 1/4 F / EA.
#[test]
fn symcom_adds_symmetric_and_antisymmetric_halves() {
    let half = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,2.,0.,0.\nCBAR,1,1,1,2,0.,1.,0.\nCBAR,2,1,2,3,0.,1.,0.\n\
         SPC1,1,123456,1,3\nSPC1,2,23456,1\nSPC1,2,123456,3\nFORCE,1,2,,500.,1.,0.,0.\n";
    let cases = "LOAD = 1\nSYM 1\nSPC = 1\nSYM 2\nSPC = 2\nSYMCOM 3\nSYMCOM 4\nSYMSEQ = 1., -1.\n";
    // Both SYMCOMs inherit the LOAD above the subcases, as in Nastran.
    let o = solve_bars(cases, half).unwrap();
    let unit = 1000.0 / EA;
    let at = |grid: usize| displacements(&o, grid);
    for (grid, values) in [(0, [0.0, 0.5, 0.5, -0.5]), (1, [0.25, 0.5, 0.75, -0.25])] {
        assert_eq!(at(grid).len(), values.len());
        for ((subcase, u), (expected, v)) in at(grid).into_iter().zip((1..).zip(values)) {
            assert_eq!(subcase, expected);
            assert!((u - v * unit).abs() < ROUNDING, "grid {grid}: {u}");
        }
    }
}

#[test]
fn combinations_that_state_no_sum_are_refused_by_line() {
    let two = "SPC = 1\nSUBCASE 1\nLOAD = 1\nSUBCASE 2\nLOAD = 2\n";
    for (cases, line, why) in [
        (format!("{two}SUBCOM 3\n"), 8, "0 factors are given for 2"),
        (
            format!("{two}SUBCOM 3\nSUBSEQ = 1.,1.,1.\n"),
            8,
            "3 factors are given for 2",
        ),
        (
            format!("{two}SUBCOM 3\nLOAD = 1\nSUBSEQ = 1.,1.\n"),
            8,
            "can't have a LOAD",
        ),
        (
            "SPC = 1\nSUBCASE 1\nLOAD = 1\nSUBCASE 2\nSUBCOM 3\nSUBSEQ = 1.,1.\n".to_owned(),
            7,
            "subcase 2 has no static solution",
        ),
    ] {
        let refused = solve_bars(&cases, BAR).err().unwrap().to_string();
        assert!(
            refused.contains(&format!("bars.bdf:{line}: SUBCOM 3: ")),
            "{refused}"
        );
        assert!(refused.contains(why), "{refused}");
    }
}

#[test]
fn a_repeated_subcase_number_is_refused_at_its_line() {
    for second in ["SUBCASE 1", "SUBCOM 1\nSUBSEQ = 2."] {
        let cases = format!("SPC = 1\nSUBCASE 1\nLOAD = 1\n{second}\nLOAD = 2\n");
        let refused = solve_bars(&cases, BAR).err().map(|f| f.to_string());
        let place = "bars.bdf:6: SUBCASE 1";
        assert!(
            refused.as_ref().is_some_and(|f| f.contains(place)),
            "{refused:?}"
        );
    }
    assert!(solve_bars("SPC = 1\nSUBCASE 1\nLOAD = 1\nSUBCASE 2\nLOAD = 2\n", BAR).is_ok());
}

#[test]
fn check_and_strains_warn_of_a_repeated_subcase_number() {
    let results = "$TITLE   =\n$SUBTITLE=\n$LABEL   =\n$DISPLACEMENTS\n$REAL OUTPUT\n$SUBCASE ID =           1\n\
         \x20        1       G      0.000000E+00      0.000000E+00      0.000000E+00\n\
         -CONT-                  0.000000E+00      0.000000E+00      0.000000E+00\n";
    for (second, times) in [("SUBCASE 2", None), ("SUBCASE 1", Some(2.0))] {
        let cases = format!("SPC = 1\nSUBCASE 1\nLOAD = 1\n{second}\nLOAD = 2\n");
        let files = InMemory::default()
            .with_file("bars.bdf", deck(&cases, BAR))
            .with_file("bars.pch", results);
        let cx = Context::new(&files);
        let checked = check(&["bars.bdf".into()], &cx).unwrap();
        let read = strains(Path::new("bars.bdf"), &["bars.pch".into()], &cx).unwrap();
        for findings in [&checked.findings.0, &read.findings.0] {
            let found = findings.iter().find(|f| f.code == "subcase-ambiguous");
            assert_eq!(found.and_then(|f| f.measured), times, "{findings:?}");
            let named = |f: &Finding| f.message.contains("`bars.bdf`:6");
            assert!(found.is_none_or(named), "{found:?}");
        }
    }
}
