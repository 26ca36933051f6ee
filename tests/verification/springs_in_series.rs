//! Chains of scalar springs: displacements in closed form, and no finding `loads-unbalanced`.

use crate::small_decks::{assert_close, displacement_at, solve};

/// Tests a chain of springs of stiffness 100 that begins at ground, with loads at its points.
fn chain(points: &str, first: &str) {
    let springs = format!(
        "{points}CELAS2,1,100.,{first}\nCELAS2,2,100.,2,COMP2,3,COMP3\nCELAS2,3,100.,3,COMP3,4,COMP4\n\
         SLOAD,1,2,1.,3,2.\nSLOAD,1,4,3.\nSPC1,1,1,1\nSPC1,1,23456,1\n"
    );
    let of = |id: &str| {
        if points.contains(&format!("GRID,{id},")) {
            "1"
        } else {
            "0"
        }
    };
    let springs = ["2", "3", "4"].iter().fold(springs, |text, id| {
        text.replace(&format!("COMP{id}"), of(id))
    });
    let solved = solve("SPC = 1\nLOAD = 1", &springs);
    // The forces are 6 in the first spring, 5 in the second and 3 in the third.
    for (id, expected) in [(2, 0.06), (3, 0.11), (4, 0.14)] {
        assert_close(points, displacement_at(&solved, id)[0], expected, 1e-12);
    }
    let codes: Vec<&str> = solved.1.findings.iter().map(|f| f.code).collect();
    assert!(!codes.contains(&"loads-unbalanced"), "{points}: {codes:?}");
}

#[test]
fn a_chain_of_springs_balances_wherever_its_points_are_scalar() {
    let grid = |ids: &[u32]| -> String {
        ids.iter()
            .map(|id| format!("GRID,{id},,{id}.,0.,0.,,23456\n"))
            .collect()
    };
    // Supported at a grid, at a scalar point, and by a spring to ground.
    chain(&format!("{}SPOINT,2\nSPOINT,3,4\n", grid(&[1])), "1,1,2");
    chain(&format!("{}SPOINT,2,THRU,4\n", grid(&[1])), "2,0");
    chain(&format!("{}SPOINT,3\n", grid(&[1, 2, 4])), "1,1,2,1");
    chain(&format!("{}SPOINT,2,3\n", grid(&[1, 4])), "1,1,2");
    chain(&grid(&[1, 2, 3, 4]), "1,1,2,1");
}
