//! Decks of `../shared/nastran` with results of other solvers.

use crate::decks::{find_shared_path, model_of};
use crate::mesh::mass_of;
use serde_json::Value;
use strainbridge::fe::*;

fn read_expected_values(folder: &str) -> Option<Value> {
    let path = find_shared_path(&format!("nastran/{folder}/expected.json"))?;
    Some(serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap())
}

fn deck_cases(deck: &str) -> Option<(strainbridge::model::Model, Vec<LoadCase>)> {
    let (model, control) = model_of(&find_shared_path(deck)?);
    let cases = control
        .effective_subcases()
        .iter()
        .map(|s| LoadCase {
            loads: s.load.into_iter().map(UnitLoad::Set).collect(),
            ..LoadCase::of_subcase(&model, s, String::new())
        })
        .collect();
    Some((model, cases))
}

/// The grid point weight of the other solver against the rigid mass of the model about the origin.
#[test]
fn mass_agrees_with_the_grid_point_weight_generator() {
    for (folder, deck) in [
        ("nx_gpwg_1", "rdop2gpwg_1.dat"),
        ("nx_opg_1", "rdop2opg_1.dat"),
    ] {
        let Some(e) = read_expected_values(folder) else {
            return;
        };
        let Some(path) = find_shared_path(&format!("nastran/{folder}/{deck}")) else {
            return;
        };
        let (model, _) = model_of(&path);
        let p = mass_of(&model);
        let mo = e["op2"]["grid_point_weight"]
            .as_object()
            .unwrap()
            .values()
            .next()
            .unwrap()["MO"]
            .clone();
        // The weight is mass over WTMASS, moved from the centre of gravity to the origin.
        let c = p.cg.cross_matrix();
        let mut shift = nalgebra::Matrix6::<f64>::identity();
        // u_cg = u + theta x cg
        shift.fixed_view_mut::<3, 3>(0, 3).copy_from(&-c);
        let about_origin = shift.transpose() * p.matrix * shift / model.params.wtmass;
        let largest = about_origin.amax();
        for i in 0..6 {
            for j in 0..6 {
                let reference = mo[i][j].as_f64().unwrap();
                let got = about_origin[(i, j)];
                assert!(
                    (got - reference).abs() < 1e-6 * largest,
                    "{folder} MO[{i}][{j}]: {got} for {reference}"
                );
            }
        }
    }
}

#[test]
fn the_displacements_of_a_cbeam_cantilever_agree() {
    let Some(e) = read_expected_values("msc_svanberg_beam") else {
        return;
    };
    let Some((model, cases)) = deck_cases("nastran/msc_svanberg_beam/static.dat") else {
        return;
    };
    let (solution, _) =
        solve_cases(&model, &cases, &SolveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let results = e["op2"]["results"].as_array().unwrap();
    let table = results
        .iter()
        .find(|r| r["result"] == "displacements")
        .unwrap();
    compare_rows(&model, &solution.cases[0], table, 6, 1e-5);
}

fn compare_rows(
    model: &strainbridge::model::Model,
    case: &CaseResult,
    table: &Value,
    components: usize,
    tolerance: f64,
) {
    let rows: Vec<(u32, Vec<f64>)> = displacement_rows(table);
    assert!(!rows.is_empty(), "{table}");
    for c in 0..components {
        let largest = rows.iter().map(|r| r.1[c].abs()).fold(0.0, f64::max);
        for (id, row) in &rows {
            let got = case.displacement[model.grid_ix(*id).unwrap().us()][c];
            assert!(
                (got - row[c]).abs() <= tolerance * largest.max(1e-12),
                "grid {id} {c}: {got} for {}",
                row[c]
            );
        }
    }
}

fn displacement_rows(table: &Value) -> Vec<(u32, Vec<f64>)> {
    let list = |v: &Value| v.as_array().cloned().unwrap_or_default();
    list(&table["rows"])
        .iter()
        .map(|r| {
            let r = list(r);
            let n = r.len();
            // A row of a table has time, row, grid, grid type and six values. A printed row has grid and six values.
            let grid = if n > 7 { 2 } else { 0 };
            (
                r[grid].as_u64().unwrap() as u32,
                r[n - 6..].iter().map(|v| v.as_f64().unwrap()).collect(),
            )
        })
        .collect()
}

#[test]
fn a_free_ring_under_a_force_and_rotation_moves_as_nastran_95_printed() {
    let Some(e) = read_expected_values("n95_inertia_relief_ring") else {
        return;
    };
    let Some((model, mut cases)) = deck_cases("nastran/n95_inertia_relief_ring/d02011a.dat") else {
        return;
    };
    // Rigid format 2 always includes inertia relief.
    cases
        .iter_mut()
        .for_each(|c| c.relief = Relief::Suport(None));
    let (solution, _) =
        solve_cases(&model, &cases, &SolveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let case = &solution.cases[0];
    let rows = displacement_rows(&serde_json::json!({ "rows": e["printed"]["displacements"] }));
    for c in [0, 1, 5] {
        let largest = rows.iter().map(|r| r.1[c].abs()).fold(0.0, f64::max);
        for (id, row) in &rows {
            let g = model.grid_ix(*id).unwrap();
            let (u, axes) = (case.displacement[g.us()], model.cd_axes(g));
            let half = if c < 3 { 0 } else { 3 };
            let local = axes * nalgebra::Vector3::new(u[half], u[half + 1], u[half + 2]);
            let got = local[c - half];
            assert!(
                (got - row[c]).abs() <= 5e-4 * largest,
                "grid {id} component {c}: {got} for {}",
                row[c]
            );
        }
    }
}

#[test]
fn a_plate_in_tension_and_shear_agrees_with_msc() {
    let Some(e) = read_expected_values("msc_plate") else {
        return;
    };
    let Some((model, cases)) = deck_cases("nastran/msc_plate/plate.bdf") else {
        return;
    };
    let (solution, _) =
        solve_cases(&model, &cases, &SolveOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    let results = e["op2"]["results"].as_array().unwrap();
    let table = results
        .iter()
        .find(|r| r["result"] == "displacements")
        .unwrap();
    // Only translations. The rotation about the normal depends on the drilling stiffness, which differs between
    // programs.
    compare_rows(&model, &solution.cases[0], table, 3, 0.02);
}
