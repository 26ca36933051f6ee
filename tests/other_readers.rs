//! What `solve` writes, read by other programs: pyNastran (OP2) and meshio (VTU).
//!
//! Needs Python with `pyNastran` and `meshio`: the interpreter named by STRAINBRIDGE_PYTHON, else `python3`. Skipped, with a message,
//! where they are absent.

#![allow(clippy::print_stderr, reason = "says why it is skipped")]

use nastran::bdf::{IncludeRequest, Loaded, Loader, read_deck};
use serde_json::Value;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;
use strainbridge::fe::{CaseResult, SolveOptions, UnitLoad, solve_unit_loads};
use strainbridge::model::{Model, Vec3};

struct NoFiles;

impl Loader for NoFiles {
    fn load(&mut self, _: &IncludeRequest) -> Result<Loaded, String> {
        Err("no include here".to_owned())
    }
}

/// Quadrilaterals with a fold, two triangles, a force at two grids, one a subcase.
fn deck() -> String {
    let mut deck = String::from(
        "SOL 101\nCEND\nSUBCASE 1\n  LOAD = 1\nSUBCASE 2\n  LOAD = 2\nBEGIN BULK\nPARAM,INREL,-2\n\
         MAT1,1,210000.,,.3,7.85-9\nPSHELL,1,1,2.0,1,,1\nFORCE,1,3,0,100.,0.,0.2,1.\nFORCE,2,11,0,50.,1.,0.,0.3\n",
    );
    for i in 0..5 {
        for j in 0..3 {
            let z = if j == 2 { 12.0 } else { f64::from(i) };
            let _ = writeln!(
                deck,
                "GRID,{},,{}.,{}.,{z:?}",
                3 * i + j + 1,
                20 * i,
                20 * j
            );
        }
    }
    for i in 0..4 {
        for j in 0..2 {
            let (a, id) = (3 * i + j + 1, 2 * i + j + 1);
            if i == 3 {
                let _ = writeln!(deck, "CTRIA3,{id},1,{a},{},{}", a + 3, a + 1);
                let _ = writeln!(deck, "CTRIA3,{},1,{},{},{}", id + 10, a + 1, a + 3, a + 4);
            } else {
                let _ = writeln!(deck, "CQUAD4,{id},1,{a},{},{},{}", a + 3, a + 4, a + 1);
            }
        }
    }
    deck.push_str("ENDDATA\n");
    deck
}

fn near(what: &str, got: f64, expected: f64, largest: f64) {
    assert!(
        (got - expected).abs() <= 2e-7 * largest,
        "{what}: {got:e} for {expected:e}"
    );
}

fn list(v: &Value) -> &[Value] {
    v.as_array().map_or(&[], Vec::as_slice)
}

/// Rows [element, grid, fibre, exx, eyy, gxy] of one subcase against our strain.
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
        near("fibre", row[2], [-1.0, 1.0][surface], 1.0);
        for c in 0..3 {
            near("strain", row[3 + c], ours[c], 4.0 * largest);
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
    let python = std::env::var("STRAINBRIDGE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/python/read_results.py");
    let Ok(read) = Command::new(python)
        .arg(script)
        .arg(dir.join("model.out"))
        .output()
    else {
        eprintln!("skipped: no Python here");
        return;
    };
    if read.status.code() == Some(77) {
        eprintln!("skipped: {}", String::from_utf8_lossy(&read.stdout));
        return;
    }
    let text = String::from_utf8_lossy(&read.stdout);
    let Some(json) = text.lines().rfind(|l| l.starts_with('{')) else {
        panic!("{text}\n{}", String::from_utf8_lossy(&read.stderr));
    };
    let read: Value = serde_json::from_str(json).unwrap();

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
            (0..6).for_each(|c| near("displacement", row[1 + c], u[c], largest));
        }
        let vtu = &read["vtu"];
        let name = format!("strain top {}", case.subcase);
        // Quadrilaterals and triangles alternate in no other order than the model's.
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
        for (id, row) in ids.iter().zip(strain) {
            let at = model
                .shells
                .iter()
                .position(|s| Some(u64::from(s.id)) == id.as_u64());
            for (c, v) in list(row).iter().enumerate() {
                let expected = case.shells.centre[at.unwrap()][1][c];
                near("strain", v.as_f64().unwrap(), expected, largest);
            }
        }
    }
    let points = list(&read["vtu"]["points"]);
    assert_eq!(points.len(), model.grids.len());
    assert_eq!(read["vtu"]["cells"]["quad"], 6);
    assert_eq!(read["vtu"]["cells"]["triangle"], 4);
}
