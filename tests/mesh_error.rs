//! The mesh error that `[model] mesh_error = true` predicts and subtracts, compared with a mesh three times as fine. In
//! the open rails, 40 mm are coarse.

mod drawn;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Width of the coarse elements.
const WIDTH: f64 = 40.0;
/// Coarse cells along a rail, between the rails, and over height and width of a rail. Then stations and heights of the
/// cross members.
const RAIL: usize = 40;
const SPAN: usize = 20;
const HEIGHT: usize = 6;
const FLANGE: usize = 2;
const CROSS: [usize; 2] = [10, 30];
const WEB: [usize; 2] = [1, 5];
/// Loads at the tips of the rails.
const LOADS: [(&str, usize); 6] = [
    ("FX", 0),
    ("FY", 0),
    ("FZ", 0),
    ("FX", 1),
    ("FY", 1),
    ("FZ", 1),
];
/// Expected size of the loads, N.
const EXPECTED: f64 = 1.0e4;

/// Half a ladder frame with `k` elements per 40 mm.
///
/// It has two C rails (240 x 80 x 8 mm) fixed at x = 0 and two cross members. RBE3 elements below the tips apply the
/// loads.
struct Frame {
    k: usize,
    grids: BTreeMap<[usize; 3], usize>,
    quads: Vec<[usize; 4]>,
    /// Coarse cell of each quad (patch, along, across).
    cells: Vec<[usize; 3]>,
}

impl Frame {
    fn new(k: usize) -> Self {
        let mut frame = Self {
            k,
            grids: BTreeMap::new(),
            quads: Vec::new(),
            cells: Vec::new(),
        };
        let [rail, height, flange, span] = [RAIL, HEIGHT, FLANGE, SPAN].map(|n| n * k);
        for side in 0..2 {
            let y = move |j: usize| if side == 0 { j } else { span - j };
            frame.patch([rail, height], |i, j| [i, y(0), j]);
            frame.patch([rail, flange], |i, j| [i, y(j), 0]);
            frame.patch([rail, flange], |i, j| [i, y(j), height]);
        }
        let [low, high] = WEB.map(|n| n * k);
        for x in CROSS.map(|n| n * k) {
            frame.patch([span, high - low], |i, j| [x, i, low + j]);
            frame.patch([span, flange], |i, j| [x + j, i, low]);
            frame.patch([span, flange], |i, j| [x + j, i, high]);
        }
        frame
    }

    fn patch(&mut self, size: [usize; 2], at: impl Fn(usize, usize) -> [usize; 3]) {
        let number = self.cells.last().map_or(0, |c| c[0] + 1);
        for i in 0..size[0] {
            for j in 0..size[1] {
                let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let quad = corners.map(|c| self.grid(c));
                self.quads.push(quad);
                self.cells.push([number, i / self.k, j / self.k]);
            }
        }
    }

    fn grid(&mut self, at: [usize; 3]) -> usize {
        let next = self.grids.len() + 1;
        *self.grids.entry(at).or_insert(next)
    }

    fn deck(&self) -> String {
        let mut deck = String::from(
            "SOL 101\nCEND\nSPC = 1\nBEGIN BULK\nMAT1,1,210000.,,.3,7.85-9\nPSHELL,1,1,8.,1,,1\n",
        );
        let step = WIDTH / self.k as f64;
        for (at, id) in &self.grids {
            let [x, y, z] = at.map(|c| c as f64 * step);
            let _ = writeln!(deck, "GRID,{id},,{x:.4},{y:.4},{z:.4}");
            if at[0] == 0 {
                let _ = writeln!(deck, "SPC1,1,123456,{id}");
            }
        }
        for (id, q) in (1..).zip(&self.quads) {
            let _ = writeln!(deck, "CQUAD4,{id},1,{},{},{},{}", q[0], q[1], q[2], q[3]);
        }
        // A patch of the web, 240 x 120 mm, on grids of both meshes.
        for (side, web) in [0, SPAN * self.k].into_iter().enumerate() {
            let patch = |at: &&[usize; 3]| {
                at.iter().all(|c| c.is_multiple_of(self.k))
                    && at[0] >= (RAIL - 6) * self.k
                    && at[1] == web
                    && at[2] <= 3 * self.k
            };
            let arms = self
                .grids
                .keys()
                .filter(patch)
                .map(|at| self.grids[at].to_string());
            let id = 900_001 + side;
            let y = [-60.0, 40.0 * SPAN as f64 + 60.0][side];
            let _ = writeln!(
                deck,
                "GRID,{id},,{:.1},{y:.1},-200.",
                WIDTH * (RAIL - 3) as f64
            );
            let mut fields: Vec<String> = [
                &(910_001 + side).to_string(),
                "",
                &id.to_string(),
                "123456",
                "1.",
                "123",
            ]
            .map(str::to_owned)
            .to_vec();
            fields.extend(arms);
            let lines: Vec<String> = fields.chunks(8).map(|c| c.join(",")).collect();
            let _ = writeln!(deck, "RBE3,{}", lines.join("\n,"));
        }
        deck.push_str("ENDDATA\n");
        deck
    }

    /// Returns gauges on every quad of the `cells`, named by cell number and element.
    fn gauges(&self, cells: &[[usize; 3]]) -> String {
        let mut out = String::new();
        for (id, cell) in (1..).zip(&self.cells) {
            let Some(number) = cells.iter().position(|c| c == cell) else {
                continue;
            };
            for angle in [0, 45, 90] {
                for surface in ["top", "bottom"] {
                    let _ = writeln!(
                        out,
                        "[[gauge]]\nname = \"{number}_{angle}_{surface}_{id}\"\nelement = {id}\nsurface = \"{surface}\"\nangle_deg = {angle}"
                    );
                }
            }
        }
        out
    }
}

fn job(deck: &str, mesh_error: bool) -> String {
    let mut job =
        format!("units = \"mm-t-s\"\n[model]\ndeck = \"{deck}\"\nmesh_error = {mesh_error}\n");
    for (component, side) in LOADS {
        let _ = writeln!(
            job,
            "[[load]]\nname = \"{component}{side}\"\ngrid = {}\ncomponent = \"{component}\"\nexpected = {EXPECTED:.1}",
            900_001 + side
        );
    }
    job
}

fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("mesh_error")
        .join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn run(folder: &Path, command: &str, job: &str) -> serde_json::Value {
    let output = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args([command, job, "--out", &format!("{job}.out"), "--json"])
        .current_dir(folder)
        .env("STRAINBRIDGE_CACHE", folder.join("kept"))
        .output()
        .unwrap();
    // S of the coarse mesh does not explain the readings of the fine one, and the output reports it.
    let code = i32::from(job == "recover_coarse.toml");
    let printed = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{printed}");
    assert_eq!(
        printed.contains("[strain-not-explained]"),
        code == 1,
        "{printed}"
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Returns the rows of `sensitivity.csv` by name without the element number. Rows with equal names are averaged.
fn rows(folder: &Path, job: &str) -> BTreeMap<String, Vec<f64>> {
    let text = std::fs::read_to_string(folder.join(format!("{job}.out/sensitivity.csv"))).unwrap();
    let mut sums: BTreeMap<String, (Vec<f64>, f64)> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let mut fields = line.split(',');
        let name = fields.next().unwrap();
        let name = name.rsplit_once('_').unwrap().0.to_owned();
        let values: Vec<f64> = fields.map(|v| v.parse().unwrap()).collect();
        let (sum, n) = sums.entry(name).or_insert((vec![0.0; values.len()], 0.0));
        sum.iter_mut().zip(&values).for_each(|(a, b)| *a += b);
        *n += 1.0;
    }
    let mean = |(sum, n): (Vec<f64>, f64)| sum.iter().map(|v| v / n).collect();
    sums.into_iter().map(|(name, s)| (name, mean(s))).collect()
}

/// Returns the cells of the first rail that are at least 200 mm away from the support and from the load.
fn middle_cells() -> Vec<[usize; 3]> {
    let mut cells = Vec::new();
    for i in (6..29).step_by(3) {
        for (patch, across) in [(0, HEIGHT), (1, FLANGE), (2, FLANGE)] {
            cells.extend((0..across).map(|j| [patch, i, j]));
        }
    }
    cells
}

/// Writes the folder of the job with both meshes. Readings of gauges are means over the elements of a coarse cell.
fn meshes(name: &str, cells: &[[usize; 3]]) -> PathBuf {
    let folder = folder(name);
    let write = |name: &str, text: String| std::fs::write(folder.join(name), text).unwrap();
    for (k, deck) in [(1, "coarse.bdf"), (3, "fine.bdf")] {
        let frame = Frame::new(k);
        write(deck, frame.deck());
        let gauges = frame.gauges(cells);
        if k == 1 {
            write("with.toml", job(deck, true) + &gauges);
        }
        let stem = deck.trim_end_matches(".bdf");
        write(&format!("{stem}.toml"), job(deck, false) + &gauges);
    }
    folder
}

/// Least strain of a gauge under a load, as a share of the largest strain of the gauge under any load.
const STRAINS: f64 = 0.3;

/// Returns the entries of S above this limit, times expected loads: coarse mesh, limit of the command, fine mesh,
/// predicted relative error.
fn entries(folder: &Path) -> Vec<[f64; 4]> {
    let with = run(folder, "sensitivity", "with.toml");
    run(folder, "sensitivity", "coarse.toml");
    run(folder, "sensitivity", "fine.toml");
    let [coarse, limit, fine] = ["coarse.toml", "with.toml", "fine.toml"].map(|j| rows(folder, j));
    let mut out = Vec::new();
    assert!(!with["mesh_error"].as_array().unwrap().is_empty());
    for gauge in with["mesh_error"].as_array().unwrap() {
        let name = gauge["name"].as_str().unwrap().rsplit_once('_').unwrap().0;
        let scaled = |rows: &BTreeMap<String, Vec<f64>>| -> Vec<f64> {
            rows[name].iter().map(|v| v * EXPECTED).collect()
        };
        let (coarse, limit, fine) = (scaled(&coarse), scaled(&limit), scaled(&fine));
        let largest = fine.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        for (l, by_load) in gauge["by_load"].as_array().unwrap().iter().enumerate() {
            if fine[l].abs() > STRAINS * largest {
                let predicted = by_load["mesh_error_rel"].as_f64().unwrap();
                out.push([coarse[l], limit[l], fine[l], predicted]);
            }
        }
    }
    out
}

/// Nine in ten errors above 1 % are predicted within a factor of 1.5 and with the right sign. For a smaller error, the
/// prediction is small. S of the command is much closer to the fine mesh than S of the deck.
#[test]
fn the_mesh_error_of_open_rails_is_that_against_a_mesh_a_third_as_wide() {
    let folder = meshes("frame", &middle_cells());
    let entries = entries(&folder);
    assert!(entries.len() > 300, "{}", entries.len());
    let (mut large, mut near, mut small, mut quiet) = (0, 0, 0, 0);
    let (mut before, mut after) = (0.0, 0.0);
    for [coarse, limit, fine, predicted] in &entries {
        let error = (coarse - fine) / fine;
        before += (coarse - fine).powi(2);
        after += (limit - fine).powi(2);
        if error.abs() > 0.01 {
            large += 1;
            near += usize::from((1.0 / 1.5..1.5).contains(&(predicted / error)));
        } else {
            small += 1;
            quiet += usize::from(predicted.abs() < 0.015);
        }
    }
    println!(
        "{near} of {large} near, {quiet} of {small} quiet, rms error {:.3}",
        (after / before).sqrt()
    );
    assert!(large > 50, "{large}");
    assert!(near * 10 >= large * 9, "{near} of {large}");
    assert!(quiet * 10 >= small * 9, "{quiet} of {small}");
    // The fine mesh has an error too: an eighth of the difference between the coarse and the fine mesh.
    assert!(after < before / 9.0, "{}", (after / before).sqrt());
}

/// Without the key, S is corrected for loads through an RBE3. For a load at a grid of a shell, S is that of the deck's mesh.
/// The strain under a point load does not converge.
#[test]
fn without_the_key_the_error_is_subtracted_unless_a_load_acts_directly_on_a_shell() {
    let cells = &middle_cells()[..2];
    let folder = meshes("default", cells);
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    let with = std::fs::read_to_string(folder.join("with.toml")).unwrap();
    let silent = with.replace("mesh_error = true\n", "");
    write("default.toml", &silent);
    let at_shell = format!("grid = {}\n", Frame::new(1).grids[&[RAIL, 0, HEIGHT / 2]]);
    let direct = |text: &str| text.replacen("grid = 900001\n", &at_shell, 1);
    write("direct.toml", &direct(&silent));
    let declined = with.replace("mesh_error = true", "mesh_error = false");
    write("direct_declined.toml", &direct(&declined));
    let [with, default, direct, declined] = ["with", "default", "direct", "direct_declined"]
        .map(|name| format!("{name}.toml"))
        .map(|job| (run(&folder, "sensitivity", &job), rows(&folder, &job)));
    assert_eq!(default.1, with.1);
    assert_eq!(default.0["mesh_error"], with.0["mesh_error"]);
    assert_ne!(direct.1, default.1);
    assert_eq!(direct.1, declined.1);
    // Nothing is reported either, as if the key declines the correction.
    assert_eq!(direct.0["mesh_error"], declined.0["mesh_error"]);
    assert_ne!(direct.0["mesh_error"], with.0["mesh_error"]);
}

/// Recovers loads with the coarse deck from readings of the fine mesh with noise.
///
/// All 100 runs have the same mesh error. The coverage of their intervals therefore varies more than that of
/// independent runs.
#[test]
fn loads_are_recovered_better_without_the_mesh_error_and_intervals_hold_them() {
    let all = middle_cells();
    let cells: Vec<_> = all.iter().copied().step_by(14).collect();
    let folder = meshes("recover", &cells);
    run(&folder, "sensitivity", "fine.toml");
    run(&folder, "sensitivity", "coarse.toml");
    let fine = rows(&folder, "fine.toml");
    let header = std::fs::read_to_string(folder.join("coarse.toml.out/sensitivity.csv")).unwrap();
    let names: Vec<&str> = header
        .lines()
        .skip(1)
        .map(|l| l.split(',').next().unwrap())
        .collect();
    let mut random = drawn::Numbers(7);
    let (mut strain, mut truth) = (format!("run,{}\n", names.join(",")), Vec::new());
    for run in 0..100 {
        let loads = LOADS.map(|_| EXPECTED * random.draw_normal());
        let _ = write!(strain, "r{run}");
        for name in &names {
            let row = &fine[name.rsplit_once('_').unwrap().0];
            let reading: f64 = row.iter().zip(loads).map(|(s, f)| s * f).sum();
            let _ = write!(strain, ",{:.4}", reading + random.draw_normal());
        }
        strain.push('\n');
        truth.push(loads);
    }
    std::fs::write(folder.join("strain.csv"), strain).unwrap();
    let measured =
        "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\nreference = \"none\"\n";
    let mut rms = Vec::new();
    for job in ["coarse.toml", "with.toml"] {
        let text = std::fs::read_to_string(folder.join(job)).unwrap() + measured;
        let name = format!("recover_{job}");
        std::fs::write(folder.join(&name), text).unwrap();
        let answer = run(&folder, "recover", &name);
        let (mut sum, mut held, mut n) = (0.0, 0, 0);
        assert!(!answer["loads"].as_array().unwrap().is_empty());
        for (load, row) in answer["loads"].as_array().unwrap().iter().enumerate() {
            let (run, l) = (load / LOADS.len(), load % LOADS.len());
            let (component, side) = LOADS[l];
            assert_eq!(row["name"], format!("{component}{side}"));
            assert_eq!(row["unit"], "N");
            let value = |key: &str| row[key].as_f64().unwrap();
            let true_one = truth[run][l];
            sum += ((value("value") - true_one) / EXPECTED).powi(2);
            held += usize::from((value("low")..=value("high")).contains(&true_one));
            n += 1;
        }
        assert_eq!(n, 600);
        println!(
            "{job}: rms error {:.4}, held {:.3}",
            (sum / f64::from(n)).sqrt(),
            held as f64 / f64::from(n)
        );
        rms.push(((sum / f64::from(n)).sqrt(), held as f64 / f64::from(n)));
    }
    assert!(rms[1].0 < 0.2 * rms[0].0, "{rms:?}");
    // The coverage must be 95 +- 3 %. All runs have the same mesh error.
    assert!((0.92..=0.98).contains(&rms[1].1), "{rms:?}");
}

/// A strip of 4 x 2 elements with rods along its long sides and its loaded end, of a material without lateral
/// contraction.
///
/// The strain is uniform, `F / (E (A + 2 A_rod))`, on any mesh. The divided mesh is tied to rods along shells.
#[test]
fn uniform_strain_next_to_rods_has_no_mesh_error() {
    let folder = folder("rods");
    let mut deck = String::from(
        "SOL 101\nCEND\nSPC = 1\nBEGIN BULK\nMAT1,1,210000.,,0.\nPSHELL,1,1,2.,1,,1\nPROD,2,1,50.\n\
         GRID,900,,80.,20.,0.\nRBE2,901,900,123456,13,14,15\nSPC1,1,123456,1,2,3\n",
    );
    for i in 0..5 {
        for j in 0..3 {
            let _ = writeln!(deck, "GRID,{},,{}.,{}.,0.", 3 * i + j + 1, 20 * i, 20 * j);
        }
    }
    for i in 0..4 {
        for j in 0..2 {
            let a = 3 * i + j + 1;
            let id = 2 * i + j + 1;
            let _ = writeln!(deck, "CQUAD4,{id},1,{a},{},{},{}", a + 3, a + 4, a + 1);
        }
        let a = 3 * i + 1;
        let _ = writeln!(deck, "CROD,{},2,{a},{}", 101 + i, a + 3);
        let _ = writeln!(deck, "CROD,{},2,{},{}", 111 + i, a + 2, a + 5);
    }
    deck.push_str("CROD,121,2,13,14\nCROD,122,2,14,15\nENDDATA\n");
    std::fs::write(folder.join("strip.bdf"), deck).unwrap();
    let mut job = String::from(
        "units = \"mm-t-s\"\n[model]\ndeck = \"strip.bdf\"\nmesh_error = true\n[[load]]\nname = \"F\"\ngrid = 900\ncomponent = \"FX\"\n",
    );
    for id in 1..=8 {
        let _ = writeln!(
            job,
            "[[gauge]]\nname = \"g_{id}\"\nelement = {id}\nsurface = \"top\"\nangle_deg = 0"
        );
    }
    std::fs::write(folder.join("strip.toml"), job).unwrap();
    let answer = run(&folder, "sensitivity", "strip.toml");
    let gauges = answer["mesh_error"].as_array().unwrap();
    assert_eq!(gauges.len(), 8);
    let error = |g: &serde_json::Value| g["mesh_error_rel"].as_f64().unwrap();
    assert!(gauges.iter().all(|g| error(g).abs() < 1e-9), "{gauges:?}");
    let expected = 1e6 / (210_000.0 * (2.0 * 40.0 + 2.0 * 50.0));
    for row in rows(&folder, "strip.toml").values() {
        assert!(
            (row[0] - expected).abs() < 1e-9 * expected,
            "{row:?} {expected}"
        );
    }
}

struct NoFiles;

impl nastran::bdf::Loader for NoFiles {
    fn load(
        &mut self,
        _: &nastran::bdf::IncludeRequest,
    ) -> Result<nastran::bdf::LoadedFile, String> {
        Err("no include here".to_owned())
    }
}

/// Large meshes are divided only around the gauges. The test compares the change at a gauge with the change on a mesh
/// that is divided everywhere.
#[test]
fn a_mesh_divided_round_a_gauge_agrees_with_one_divided_everywhere() {
    use strainbridge::fe::{SolveOptions, Support, UnitLoad, solve_unit_loads_on};
    use strainbridge::gauge::change_by_refining;
    use strainbridge::model::{Model, RefinedModel, ShellIx, Vec3};
    let frame = Frame::new(1);
    let deck = nastran::bdf::read_deck("frame.bdf", frame.deck().into_bytes(), &mut NoFiles);
    let (model, faults) = Model::from_deck(&deck);
    assert!(faults.is_empty(), "{faults:?}");
    let support = Support {
        spc: Some(1),
        relief: strainbridge::fe::Relief::None,
        by_springs: 0,
    };
    let loads: Vec<UnitLoad> = LOADS
        .into_iter()
        .map(|(component, side)| {
            let axis = ["FX", "FY", "FZ"]
                .iter()
                .position(|c| *c == component)
                .unwrap();
            let mut force = Vec3::zeros();
            force[axis] = EXPECTED;
            UnitLoad::AtGrid {
                grid: model.grid_ix(900_001 + side as u32).unwrap(),
                force,
                moment: Vec3::zeros(),
            }
        })
        .collect();
    let solve = |m: &Model| {
        solve_unit_loads_on(m, support, &loads, &SolveOptions::default())
            .unwrap()
            .0
    };
    let coarse = solve(&model);
    let change = |fine: &RefinedModel| {
        let refined = solve(&fine.model);
        let pairs: Vec<_> = coarse.cases.iter().zip(&refined.cases).collect();
        change_by_refining(&model, fine, &pairs)
    };
    let whole = change(&model.refine_shells().unwrap());
    let cells = middle_cells();
    let mut missed = Vec::new();
    for rows in [1, 2, 4, 6, 10] {
        let (mut off, mut all) = (0.0, 0.0);
        for cell in cells.iter().step_by(9) {
            let shell = frame.cells.iter().position(|c| c == cell).unwrap();
            let part = model.shells_near(&[ShellIx(shell as u32)], rows);
            let part = change(&model.refine_shells_at(&part).unwrap());
            for (part, whole) in part.iter().zip(&whole) {
                let strains = |c: &strainbridge::fe::CaseResult| c.shells.centre[shell];
                let pairs = strains(part)
                    .into_iter()
                    .flatten()
                    .zip(strains(whole).into_iter().flatten());
                for (p, w) in pairs {
                    off += (p - w) * (p - w);
                    all += w * w;
                }
            }
        }
        missed.push((off / all).sqrt());
    }
    println!("{missed:?}");
    assert!(missed.windows(2).all(|w| w[1] < w[0]), "{missed:?}");
    // With as many rows as the program takes, at least two thirds are included. The assumed remainder (half of the
    // visible change, for each entry and for the pattern) covers the rest.
    assert!(missed[4] < 0.4, "{missed:?}");
}
