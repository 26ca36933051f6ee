//! Tests all cases of `../shared/nastran`: shell strain in the element frame and in the basic frame, and displacements
//! in the basic frame.
//!
//! The reference is `expected.json`, read by pyNastran and rotated with the verified bisector frame. A new case needs
//! no code.

#[path = "../nastran/tests/support/mod.rs"]
mod support;

use nastran::bdf::{IncludeRequest, LoadedFile, Loader, read_deck};
use nastran::results::ResultsFile;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use strainbridge::fe::from_results::{ReadOptions, solution_from_results};
use strainbridge::fe::shell_frame::{ShellPlace, shell_axes};
use strainbridge::fe::strain_rows::components;
use strainbridge::fe::strain_tensor::basic_tensor;
use strainbridge::fe::{CaseResult, PlaneStrain, Solution};
use strainbridge::model::{GridIx, Model, Shell, ShellIx, Vec3};

/// Returns the fibre distances at a grid of a shell, or at its centre if the grid is not one of its corners.
fn fibres_at(model: &Model, shell: &Shell, grid: u32) -> [f64; 2] {
    let fibres = model.fibres(shell);
    let is = |g: &GridIx| model.grids.get(g.us()).is_some_and(|g| g.id == grid);
    match shell.grids.iter().take(4).position(is) {
        Some(corner) => fibres.corners[corner],
        None => fibres.centre,
    }
}

/// Returns the tolerance relative to the largest value of the column.
fn tolerance(word_bytes: u64) -> f64 {
    if word_bytes == 8 { 1e-12 } else { 1e-6 }
}

/// Returns the cases of the set: folder, case.json, expected.json.
fn cases() -> Vec<(PathBuf, Value, Value)> {
    let Some(folder) = support::find_shared_path("nastran") else {
        return Vec::new();
    };
    let entries = std::fs::read_dir(folder).unwrap();
    let json = |path: PathBuf| serde_json::from_slice(&std::fs::read(path).ok()?).ok();
    let mut all: Vec<_> = entries
        .flatten()
        .map(|e| e.path())
        .filter_map(|p| {
            Some((
                p.clone(),
                json(p.join("case.json"))?,
                json(p.join("expected.json"))?,
            ))
        })
        .collect();
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

/// Loader of included files from disk.
struct Disk;
impl Loader for Disk {
    fn load(&mut self, request: &IncludeRequest) -> Result<LoadedFile, String> {
        let paths = request
            .candidates(|_| None)
            .map_err(|s| format!("no value for {s}"))?;
        let found = paths.into_iter().find_map(|path| {
            Some(LoadedFile {
                bytes: std::fs::read(&path).ok()?,
                path,
                differing_path: None,
            })
        });
        found.ok_or_else(|| "no such file".to_string())
    }
}

/// Returns the model of the deck of a case.
fn model(folder: &Path, case: &Value) -> Option<Model> {
    let path = folder.join(case["bdf"].as_str()?);
    let deck = read_deck(
        &path.display().to_string(),
        std::fs::read(&path).unwrap(),
        &mut Disk,
    );
    Some(Model::from_cards(&deck.cards).0)
}

/// Values by column: from this reader and from the oracle.
#[derive(Default)]
struct Columns(BTreeMap<String, Vec<(f64, f64)>>);

impl Columns {
    fn push(&mut self, column: &str, ours: f64, theirs: &Value) {
        self.0
            .entry(column.to_string())
            .or_default()
            .push((ours, theirs.as_f64().unwrap()));
    }

    /// Returns the largest difference in any column, relative to the largest value of that column, with the column
    /// name.
    fn largest_difference(&self) -> (f64, String) {
        let mut worst = (0.0, String::new());
        for (name, pairs) in &self.0 {
            let largest = pairs.iter().fold(0.0_f64, |m, p| m.max(p.1.abs()));
            for (ours, theirs) in pairs {
                let d = (ours - theirs).abs();
                // A column of zeros must be zero within the rounding of a rotated tensor of order one thousandth.
                let relative = if largest > 1e-20 {
                    d / largest
                } else {
                    d * 1e3
                };
                if relative > worst.0 || relative.is_nan() {
                    worst = (relative, name.clone());
                }
            }
        }
        worst
    }
}

fn case_of(solution: &Solution, subcase: u64) -> &CaseResult {
    solution
        .cases
        .iter()
        .find(|c| u64::from(c.subcase) == subcase)
        .unwrap_or_else(|| panic!("no subcase {subcase}"))
}

/// Returns the strain at the surfaces of a shell, at the centre or at a corner grid.
fn shell_strain_at(model: &Model, case: &CaseResult, element: u32, grid: u32) -> [PlaneStrain; 2] {
    let ix = model.shell_ix(element).unwrap();
    let i = case.shells.elements.binary_search(&ix).unwrap();
    if grid == 0 {
        return case.shells.centre[i];
    }
    let shell = &model.shells[ix.us()];
    let corner = (0..shell.shape.n_corners())
        .find(|&c| model.grids[shell.grids[c].us()].id == grid)
        .unwrap();
    case.shells.corners[i][corner]
}

/// Returns the values of a row of the file, from strain at the surfaces: strain at the fibre, or mid-plane strain and
/// minus its derivative. Strain is linear through the thickness.
fn as_row(strain: [PlaneStrain; 2], z: [f64; 2], row: usize, is_fibre: bool) -> PlaneStrain {
    let w = -z[0] / (z[1] - z[0]);
    match (is_fibre, row) {
        (true, r) => strain[r - 1],
        (false, 1) => std::array::from_fn(|k| strain[0][k] * (1.0 - w) + strain[1][k] * w),
        (false, _) => std::array::from_fn(|k| -(strain[1][k] - strain[0][k]) / (z[1] - z[0])),
    }
}

/// Returns the solution of the OP2 of a case, if the case has both deck and OP2.
fn solve(folder: &Path, case: &Value) -> Option<(Model, Solution)> {
    let model = model(folder, case)?;
    let bytes = std::fs::read(folder.join(case["op2"].as_str()?)).unwrap();
    let file = ResultsFile::read(&bytes, "op2").unwrap();
    let solution = solution_from_results(&model, &[("op2", &file)], &ReadOptions::default());
    Some((model, solution))
}

#[test]
fn shell_strain_of_every_case_agrees_in_the_element_frame() {
    let mut n_tables = 0;
    for (folder, case, expected) in cases() {
        let tables = expected["op2"]["results"]
            .as_array()
            .cloned()
            .unwrap_or_default();
        let shell = |t: &&Value| {
            let name = t["result"].as_str().unwrap();
            let known = ["cquad4", "ctria3", "cquad8", "ctria6", "cquadr", "ctriar"]
                .iter()
                .any(|e| name == format!("strain.{e}_strain"));
            known
                && t["analysis_code"] == 1
                && t["id_columns"] == serde_json::json!(["element", "node"])
        };
        let tables: Vec<&Value> = tables.iter().filter(shell).collect();
        if tables.is_empty() {
            continue;
        }
        let Some((model, solution)) = solve(&folder, &case) else {
            continue;
        };
        for table in tables {
            let result = case_of(&solution, table["isubcase"].as_u64().unwrap());
            let is_fibre = table["is_fiber_distance"].as_bool().unwrap();
            let mut columns = Columns::default();
            for row in table["rows"].as_array().unwrap() {
                let (i, element) = (row[1].as_u64().unwrap(), row[2].as_u64().unwrap() as u32);
                let grid = row[3].as_u64().unwrap() as u32;
                let ix = model.shell_ix(element).unwrap();
                let strain = shell_strain_at(&model, result, element, grid);
                let z = fibres_at(&model, &model.shells[ix.us()], grid);
                let ours = as_row(strain, z, 1 + (i % 2) as usize, is_fibre);
                for k in 0..3 {
                    let name = format!("{} row {}", ["exx", "eyy", "gxy"][k], i % 2 + 1);
                    columns.push(&name, ours[k], &row[5 + k]);
                }
            }
            let (worst, column) = columns.largest_difference();
            let limit = tolerance(expected["op2"]["word_bytes"].as_u64().unwrap());
            assert!(
                worst <= limit,
                "{} {} {column}: {worst:.2e}",
                folder.display(),
                table["result"]
            );
            n_tables += 1;
        }
    }
    assert!(n_tables > 0 || cases().is_empty());
}

#[test]
fn strain_of_quads_in_the_basic_frame_agrees_in_every_case() {
    let mut n_cases = 0;
    for (folder, case, expected) in cases() {
        let Some(rows) = expected["cquad4_global"]
            .as_array()
            .filter(|r| !r.is_empty())
        else {
            continue;
        };
        let Some((model, solution)) = solve(&folder, &case) else {
            continue;
        };
        let mut columns = Columns::default();
        for row in rows {
            let subcase = row["subcase_key"].as_str().unwrap().parse().unwrap();
            let result = case_of(&solution, subcase);
            let element = row["eid"].as_u64().unwrap() as u32;
            let shell = &model.shells[model.shell_ix(element).unwrap().us()];
            // Curvature rows state the fibre distances 0 and -1. No shell has its surfaces there.
            let which = row["row"].as_u64().unwrap() as usize;
            let fibre = row["fiber"].as_f64().unwrap();
            let z = model.fibres(shell).centre;
            let is_fibre = (fibre - z[which - 1]).abs() <= 1e-4 * (z[1] - z[0]);
            let strain = as_row(
                shell_strain_at(&model, result, element, 0),
                z,
                which,
                is_fibre,
            );
            let axes = shell_axes(&model, shell, ShellPlace::Centre).unwrap();
            // The oracle omits the normal strain.
            let ours = components(&basic_tensor(strain, 0.0, &axes));
            for (k, name) in ["xx", "yy", "zz", "xy", "yz", "zx"].iter().enumerate() {
                columns.push(
                    &format!("{name} row {which}"),
                    ours[k],
                    &row["xx_yy_zz_xy_yz_zx"][k],
                );
            }
        }
        let (worst, column) = columns.largest_difference();
        let limit = tolerance(expected["op2"]["word_bytes"].as_u64().unwrap());
        assert!(worst <= limit, "{} {column}: {worst:.2e}", folder.display());
        n_cases += 1;
    }
    assert!(n_cases > 0 || cases().is_empty());
}

#[test]
fn strain_hidden_in_a_stress_table_is_found_by_its_code() {
    let mut n = 0;
    for (folder, case, expected) in cases() {
        let Some(tables) = expected["raw_shell_strain"].as_array() else {
            continue;
        };
        let Some((model, solution)) = solve(&folder, &case) else {
            continue;
        };
        for table in tables {
            let result = case_of(&solution, table["subcase"].as_u64().unwrap());
            assert!(!result.shells.from_stress);
            let (mut local, mut basic) = (Columns::default(), Columns::default());
            for row in table["rows"].as_array().unwrap() {
                let strain = shell_strain_at(&model, result, row[0].as_u64().unwrap() as u32, 0);
                for surface in 0..2 {
                    for (k, ours) in strain[surface].iter().enumerate() {
                        local.push(&format!("{k} {surface}"), *ours, &row[2 + 8 * surface + k]);
                    }
                }
            }
            for row in table["global_xx_yy_zz_xy_yz_zx"]
                .as_array()
                .into_iter()
                .flatten()
            {
                let element = row[0].as_u64().unwrap() as u32;
                let surface = row[1].as_u64().unwrap() as usize - 1;
                let shell = &model.shells[model.shell_ix(element).unwrap().us()];
                let axes = shell_axes(&model, shell, ShellPlace::Centre).unwrap();
                let ours = components(&basic_tensor(
                    shell_strain_at(&model, result, element, 0)[surface],
                    0.0,
                    &axes,
                ));
                (0..6).for_each(|k| basic.push(&format!("{k} {surface}"), ours[k], &row[2 + k]));
            }
            let limit = tolerance(expected["op2"]["word_bytes"].as_u64().unwrap());
            for (worst, column) in [local.largest_difference(), basic.largest_difference()] {
                assert!(worst <= limit, "{} {column}: {worst:.2e}", folder.display());
            }
            n += 1;
        }
    }
    assert!(n > 0 || cases().is_empty());
}

#[test]
fn displacements_of_every_case_turned_back_to_their_frames_are_those_of_the_file() {
    let mut n_tables = 0;
    for (folder, case, expected) in cases() {
        let tables = expected["op2"]["results"]
            .as_array()
            .cloned()
            .unwrap_or_default();
        let tables: Vec<_> = tables
            .iter()
            .filter(|t| t["result"] == "displacements" && t["analysis_code"] == 1)
            .collect();
        if tables.is_empty() {
            continue;
        }
        let Some((model, solution)) = solve(&folder, &case) else {
            continue;
        };
        for table in tables {
            let result = case_of(&solution, table["isubcase"].as_u64().unwrap());
            let mut columns = Columns::default();
            for row in table["rows"].as_array().unwrap() {
                let Some(GridIx(ix)) = model.grid_ix(row[2].as_u64().unwrap() as u32) else {
                    continue;
                };
                let u = result.displacement[ix as usize];
                let axes = model.cd_axes(GridIx(ix));
                let t = axes * Vec3::new(u[0], u[1], u[2]);
                let r = axes * Vec3::new(u[3], u[4], u[5]);
                for (k, ours) in t.iter().chain(r.iter()).enumerate() {
                    columns.push(&k.to_string(), *ours, &row[4 + k]);
                }
            }
            // pyNastran stores nodal tables in single precision, even if the file has double precision.
            let (worst, column) = columns.largest_difference();
            assert!(
                worst <= 1e-6,
                "{} subcase {} {column}: {worst:.2e}",
                folder.display(),
                table["isubcase"]
            );
            n_tables += 1;
        }
    }
    assert!(n_tables > 0 || cases().is_empty());
}

#[test]
fn the_same_run_read_from_hdf5_gives_the_same_bar_strain_in_double_precision() {
    let Some(folder) = support::find_shared_path("nastran/msc_svanberg_beam") else {
        return;
    };
    let h5 = std::fs::read(folder.join("static.h5")).unwrap();
    let op2 = std::fs::read(folder.join("static.op2")).unwrap();
    let model = model(&folder, &serde_json::json!({"bdf": "static.dat"})).unwrap();
    let (h5, op2) = (
        ResultsFile::read(&h5, "static.h5").unwrap(),
        ResultsFile::read(&op2, "static.op2").unwrap(),
    );
    let read = |f: &ResultsFile| {
        solution_from_results(&model, &[("run", f)], &ReadOptions::default())
            .cases
            .remove(0)
    };
    let (a, b) = (read(&h5), read(&op2));
    assert_eq!(a.beams.elements, b.beams.elements);
    assert_eq!(a.beams.elements.len(), 5);
    for (x, y) in a
        .beams
        .stations
        .iter()
        .flatten()
        .zip(b.beams.stations.iter().flatten())
    {
        assert_eq!(x.0, y.0);
        x.1.iter()
            .zip(&y.1)
            .for_each(|(p, q)| assert!((p - q).abs() <= 1e-7 * 1.5e-4));
    }
    assert!(a.shells.elements.iter().all(|ShellIx(i)| *i < 1));
}
