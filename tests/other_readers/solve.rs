//! Files that `solve` writes, read by pyNastran (OP2) and meshio (VTU).

use crate::plate::{NoFiles, deck};
use crate::python::read_by;
use nastran::bdf::read_deck;
use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;
use strainbridge::fe::{CaseResult, SolveOptions, UnitLoad, solve_unit_loads};
use strainbridge::model::{Model, Vec3};

fn assert_near(what: &str, got: f64, expected: f64, largest: f64) {
    assert!(
        (got - expected).abs() <= 2e-7 * largest,
        "{what}: {got:e} for {expected:e}"
    );
}

fn list(v: &Value) -> &[Value] {
    v.as_array().map_or(&[], Vec::as_slice)
}

/// Compares rows [element, grid, fibre, exx, eyy, gxy] of one subcase with the strain of the solution.
fn compare_strain(model: &Model, case: &CaseResult, rows: &[Value]) -> usize {
    let strains = case.shells.centre.iter().flatten().flatten();
    let largest = strains.fold(0.0_f64, |a, v| a.max(v.abs()));
    for (i, row) in rows.iter().enumerate() {
        let row: Vec<f64> = list(row).iter().filter_map(Value::as_f64).collect();
        let shell = model
            .shells
            .iter()
            .position(|s| f64::from(s.id) == row[0])
            .unwrap();
        let grid = row[1] as u32;
        let surface = i % 2;
        let ours = if grid == 0 {
            case.shells.centre[shell][surface]
        } else {
            let corner = model.shells[shell]
                .grids
                .iter()
                .position(|g| model.grids[g.us()].id == grid)
                .unwrap();
            case.shells.corners[shell][corner][surface]
        };
        assert_near("fibre", row[2], [-1.0, 1.0][surface], 1.0);
        for c in 0..3 {
            assert_near("strain", row[3 + c], ours[c], 4.0 * largest);
        }
    }
    rows.len()
}

#[test]
fn pynastran_and_meshio_read_what_solve_writes() {
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("other_readers");
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).unwrap();
    let path = dir.join("model.bdf");
    std::fs::write(&path, deck()).unwrap();
    let solved = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["solve", path.to_str().unwrap(), "--no-cache"])
        .output()
        .unwrap();
    let err = String::from_utf8_lossy(&solved.stderr).into_owned();
    assert_eq!(solved.status.code(), Some(0), "{err}");
    let Some(read) = read_by(
        "read_results.py",
        &[dir.join("model.out").to_str().unwrap()],
    ) else {
        return;
    };

    let deck = read_deck("model.bdf", deck().into_bytes(), &mut NoFiles);
    let (model, _) = Model::from_cards(&deck.cards);
    let forces = [
        (3, Vec3::new(0.0, 20.0, 100.0)),
        (11, Vec3::new(50.0, 0.0, 15.0)),
    ];
    let loads = forces.map(|(grid, force)| UnitLoad::AtGrid {
        grid: model.grid_ix(grid).unwrap(),
        force,
        moment: Vec3::zeros(),
    });
    let (ours, _) = solve_unit_loads(&model, &loads, &SolveOptions::default())
        .unwrap_or_else(|e| panic!("{e}"));
    for case in &ours.cases {
        let theirs = &read["op2"][case.subcase.to_string()];
        // Six quadrilaterals with centre and four corners, four triangles, two surfaces each.
        assert_eq!(compare_strain(&model, case, list(&theirs["quads"])), 60);
        assert_eq!(compare_strain(&model, case, list(&theirs["trias"])), 8);
        let moved = list(&theirs["displacements"]);
        assert_eq!(moved.len(), 15);
        let largest = case
            .displacement
            .iter()
            .flatten()
            .fold(0.0_f64, |a, v| a.max(v.abs()));
        for row in moved {
            let row: Vec<f64> = list(row).iter().filter_map(Value::as_f64).collect();
            let u = case.displacement[model.grid_ix(row[0] as u32).unwrap().us()];
            (0..6).for_each(|c| assert_near("displacement", row[1 + c], u[c], largest));
        }
        let vtu = &read["vtu"];
        let name = format!("strain top {}", case.subcase);
        // Quadrilaterals and triangles have the order of the model.
        let strain: Vec<&Value> = list(&vtu["cell_data"][&name])
            .iter()
            .flat_map(list)
            .collect();
        assert_eq!(strain.len(), model.shells.len(), "{name}");
        let all = case.shells.centre.iter().flatten().flatten();
        let largest = all.fold(0.0_f64, |a, v| a.max(v.abs()));
        let ids: Vec<&Value> = list(&vtu["cell_data"]["element"])
            .iter()
            .flat_map(list)
            .collect();
        assert_eq!(ids.len(), strain.len(), "{name}");
        for (id, row) in ids.iter().zip(strain) {
            let at = model
                .shells
                .iter()
                .position(|s| Some(u64::from(s.id)) == id.as_u64());
            for (c, v) in list(row).iter().enumerate() {
                let expected = case.shells.centre[at.unwrap()][1][c];
                assert_near("strain", v.as_f64().unwrap(), expected, largest);
            }
        }
    }
    let points = list(&read["vtu"]["points"]);
    assert_eq!(points.len(), model.grids.len());
    assert_eq!(read["vtu"]["cells"]["quad"], 6);
    assert_eq!(read["vtu"]["cells"]["triangle"], 4);
}
