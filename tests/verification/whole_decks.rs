//! Solves whole structures from other sources as free bodies: satellites and a support structure.

use crate::decks::{faulty_model_of, find_shared_path};
use crate::mesh::free_modes;
use strainbridge::fe::*;
use strainbridge::model::Model;

/// Returns the first elastic frequencies, and the strain under a unit load at a distant grid.
fn solve(
    deck: &str,
    alter: impl Fn(&mut Model),
) -> Option<(Model, Vec<Mode>, Solution, SolveReport)> {
    let path = find_shared_path(&format!("nastran/{deck}"))?;
    let (mut model, control) = faulty_model_of(&path);
    alter(&mut model);
    let mpc = control.mpc_of_structure();
    let modal = free_modes(&model, mpc, 4);
    // The shell grid with the largest distance from the centre of gravity.
    let cg = modal.mass.unwrap().cg;
    let far = model
        .shells
        .iter()
        .flat_map(|s| s.grids)
        .max_by(|a, b| {
            let away = |g: &strainbridge::model::GridIx| (model.grids[g.us()].x - cg).norm();
            away(a).total_cmp(&away(b))
        })
        .unwrap();
    let loads: Vec<UnitLoad> = (0..3)
        .map(|i| {
            let mut force = nalgebra::Vector3::zeros();
            force[i] = 1.0;
            UnitLoad::AtGrid {
                grid: far,
                force,
                moment: nalgebra::Vector3::zeros(),
            }
        })
        .collect();
    let cases: Vec<LoadCase> = (1..)
        .zip(loads)
        .map(|(subcase, load)| LoadCase {
            subcase,
            label: String::new(),
            loads: vec![load],
            spc: None,
            mpc,
            relief: Relief::Automatic,
        })
        .collect();
    let (solution, report) = solve_cases(&model, &cases, &SolveOptions::default())
        .unwrap_or_else(|e| panic!("{deck}: {e}"));
    Some((model, modal.modes, solution, report))
}

fn check(deck: &str, alter: impl Fn(&mut Model)) {
    let Some((model, modes, solution, report)) = solve(deck, alter) else {
        return;
    };
    let mass = report.mass.unwrap().mass;
    eprintln!(
        "{deck}: {} grids, {} unknowns, mass {mass:.6e}, modes {:?}, smallest pivot {:.1e}",
        model.grids.len(),
        report.dofs,
        modes.iter().map(|m| m.frequency).collect::<Vec<_>>(),
        report.smallest_pivot
    );
    assert!(modes.len() == 4 && modes[0].frequency > 0.0);
    assert!(
        modes
            .windows(2)
            .all(|m| m[0].frequency <= m[1].frequency * (1.0 + 1e-9))
    );
    for balance in &report.balance {
        assert!(balance.residual < 1e-9, "{balance:?}");
    }
    for case in &solution.cases {
        let mut largest = 0.0_f64;
        for e in case.shells.centre.iter().flatten().flatten() {
            assert!(e.is_finite());
            largest = largest.max(e.abs());
        }
        assert!(largest > 0.0);
        assert!(case.displacement.iter().flatten().all(|u| u.is_finite()));
    }
    // The lumped mass of the solver against the mass of the cards.
    let weight = model.weight().mass;
    assert!((mass / weight - 1.0).abs() < 1e-6, "{mass} for {weight}");
}

#[test]
fn a_deployed_satellite_vibrates_and_strains_freely() {
    check("deck_isat_deployed/ISat_Dploy_Sm.dat", |_| {});
}

#[test]
fn a_support_structure_vibrates_and_strains_freely() {
    check("deck_support_structure/W1000BOstat.dat", |_| {});
}

#[test]
fn a_satellite_of_many_files_vibrates_and_strains_freely() {
    // The deck does not join the outer panel 06 (grids 55010 and up) to anything. The error reports it. The test then
    // removes the panel.
    let deck = "deck_satellite_includes/JOBS/QS/relative_path.bdf";
    let Some(path) = find_shared_path(&format!("nastran/{deck}")) else {
        return;
    };
    let (model, _) = faulty_model_of(&path);
    let error = solve_modes(&model, None, None, 1, &SolveOptions::default()).unwrap_err();
    assert!(
        error.to_string().contains("not joined to the rest"),
        "{error}"
    );
    assert!(error.to_string().contains("55010"), "{error}");
    check(deck, |model| {
        let loose: Vec<usize> = (0..model.grids.len())
            .filter(|g| (55010..=55080).contains(&model.grids[*g].id))
            .collect();
        model
            .shells
            .retain(|s| !s.grids.iter().any(|g| loose.contains(&g.us())));
    });
}
