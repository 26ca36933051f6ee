//! Plans by pointing at a report.
//!
//! The tests use real mouse and touch events in Chromium. They compare the lines that the page writes, and the layout
//! from these lines.

use crate::exchange::strainbridge;
use crate::python::read_by;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Squares along x and y of the plate, and their edge in mm.
const NX: u32 = 20;
const NY: u32 = 10;
const EDGE: f64 = 10.0;

pub fn folder(name: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("pointing")
        .join(name);
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).unwrap();
    dir
}

/// Returns a flat plate. Element `1 + 20 j + i` is the square from (10 i, 10 j). Property 1 is left of x = 100,
/// property 2 right of it.
fn flat_plate_deck() -> String {
    let mut deck = String::from(
        "SOL 101\nCEND\nBEGIN BULK\nPARAM,INREL,-2\nMAT1,1,210000.,,.3,7.85-9\nPSHELL,1,1,2.0,1,,1\nPSHELL,2,1,2.0,1,,1\n",
    );
    for (j, i) in (0..=NY).flat_map(|j| (0..=NX).map(move |i| (j, i))) {
        let _ = writeln!(
            deck,
            "GRID,{},,{}.,{}.,0.",
            1 + (NX + 1) * j + i,
            10 * i,
            10 * j
        );
    }
    for (j, i) in (0..NY).flat_map(|j| (0..NX).map(move |i| (j, i))) {
        let (a, property) = (1 + (NX + 1) * j + i, if i < NX / 2 { 1 } else { 2 });
        let corners = [a, a + 1, a + NX + 2, a + NX + 1].map(|g| g.to_string());
        let _ = writeln!(
            deck,
            "CQUAD4,{},{property},{}",
            1 + NX * j + i,
            corners.join(",")
        );
    }
    deck.push_str("ENDDATA\n");
    deck
}

/// Returns a square tube with squares of 10 mm and rings of 200 squares from x = 0.
///
/// The walls are 1 (z = 0), 2 (y = 500), 3 (z = 500) and 4 (y = 0). Element ids are `1 + 200 i + 50 (wall - 1) + k`.
fn tube(rings: u32) -> String {
    let mut deck = String::from("SOL 101\nCEND\nBEGIN BULK\nMAT1,1,210000.,,.3,7.85-9\n");
    for wall in 1..=4 {
        let _ = writeln!(deck, "PSHELL,{wall},1,2.0,1,,1");
    }
    for (i, k) in (0..=rings).flat_map(|i| (0..200).map(move |k| (i, k))) {
        let (side, t) = (k / 50, k % 50);
        let [y, z] = [[t, 0], [50, t], [50 - t, 50], [0, 50 - t]][side as usize];
        let _ = writeln!(
            deck,
            "GRID,{},,{}.,{}.,{}.",
            1 + 200 * i + k,
            10 * i,
            10 * y,
            10 * z
        );
    }
    for (i, k) in (0..rings).flat_map(|i| (0..200).map(move |k| (i, k))) {
        let (a, b) = (1 + 200 * i + k, 1 + 200 * i + (k + 1) % 200);
        let _ = writeln!(
            deck,
            "CQUAD4,{a},{},{a},{},{},{b}",
            1 + k / 50,
            a + 200,
            b + 200
        );
    }
    deck.push_str("ENDDATA\n");
    deck
}

const JOB: &str = r#"title = "Plate"
units = "mm-t-s"
[model]
deck = "plate.bdf"
mesh_error = false
[[load]]
name = "A.FZ"
grid = 1
component = "FZ"
expected = 10.0
[[load]]
name = "B.FZ"
grid = 21
component = "FZ"
expected = 10.0
[[load]]
name = "C.FX"
grid = 231
component = "FX"
expected = 100.0
"#;
const PLACEMENT: &str = "[placement]\ngauges = 6\nspacing = 8.0\n";

/// Returns the output of the page after these steps, or `None` without Chromium.
pub fn run_page_steps(report: &Path, width: u32, steps: &Value) -> Option<Value> {
    let plan = report.with_file_name(format!("steps-{width}.json"));
    let text = json!({ "width": width, "touch": width < 600, "steps": steps }).to_string();
    std::fs::write(&plan, text).unwrap();
    let paths = [report, &plan].map(|p| p.to_str().unwrap());
    let printed = read_by("point_report.py", &paths)?;
    assert_eq!(printed["errors"], json!([]));
    assert_eq!(printed["requests"], json!([]));
    Some(printed)
}

/// Returns the ids of a list in the lines of the page, by key.
fn ids(lines: &str, key: &str) -> BTreeSet<u32> {
    let table: toml::Table = lines.parse().unwrap();
    let word = |w: &str| w.trim().parse::<u32>().unwrap();
    match table["candidates"].get(key) {
        None => BTreeSet::new(),
        Some(toml::Value::Array(list)) => {
            let ids = list.iter().map(|v| v.as_integer().unwrap() as u32);
            ids.collect()
        }
        Some(text) => {
            let ranges = text.as_str().unwrap().split(',');
            let of = |range: &str| match range.split_once("THRU") {
                Some((a, b)) => word(a)..=word(b),
                None => word(range)..=word(range),
            };
            ranges.flat_map(of).collect()
        }
    }
}

fn lines(printed: &Value, k: usize) -> &str {
    printed["lines"][k][0].as_str().unwrap()
}

/// Steps on the page of `place` or `check`.
///
/// They allow property 1 and remove six elements of its row at y = 55 with the brush. A box requests two elements at
/// its corner. A stroke that is undone has no effect.
fn steps() -> Value {
    json!([
        ["view", "z"],
        ["state", "allowed"],
        ["property", 1],
        ["lines"],
        ["state", "forbidden"],
        ["tool", "brush"],
        ["radius", 3],
        ["drag", [25, 55, 0], [75, 55, 0]],
        ["lines"],
        ["drag", [25, 35, 0], [75, 35, 0]],
        ["undo"],
        ["lines"],
        ["state", "wanted"],
        ["tool", "box"],
        ["drag", [81, 81, 0], [99, 89, 0]],
        ["lines"],
        ["save"],
        ["tool", "turn"],
        ["two fingers"],
    ])
}

/// Returns the layout of the job with the additional lines `more`, as (element, place).
fn layout(dir: &Path, name: &str, more: &str) -> Vec<(u32, [f64; 3])> {
    let job = dir.join(format!("{name}.toml"));
    std::fs::write(&job, format!("{JOB}{PLACEMENT}{more}")).unwrap();
    let placed = strainbridge(&["place", job.to_str().unwrap()]);
    let number = |v: &Value| v.as_f64().unwrap();
    let gauges = placed["gauges"].as_array().unwrap().iter();
    gauges
        .map(|g| {
            let at = [0, 1, 2].map(|k| number(&g["position"][k]));
            (number(&g["element"]) as u32, at)
        })
        .collect()
}

#[test]
fn lines_written_by_pointing_with_mouse_and_finger_give_the_layout_that_was_pointed_at() {
    let dir = folder("plate");
    let deck = dir.join("plate.bdf");
    std::fs::write(&deck, flat_plate_deck()).unwrap();
    let free = layout(&dir, "free", "");
    let checked = dir.join("check.out");
    strainbridge(&[
        "check",
        deck.to_str().unwrap(),
        "--out",
        checked.to_str().unwrap(),
    ]);
    let row = |from: u32, to: u32, j: u32| (from..to).map(move |i| 1 + NX * j + i);
    let left: BTreeSet<u32> = (0..NY).flat_map(|j| row(0, NX / 2, j)).collect();
    let brushed: BTreeSet<u32> = row(2, 8, 5).collect();
    let wanted: BTreeSet<u32> = row(8, 10, 8).collect();
    // Without any rule, the layout is different, so the following comparison is significant.
    assert!(free.iter().any(|g| !left.contains(&g.0)));
    for (report, width) in [
        (dir.join("free.out/report.html"), 1280),
        (dir.join("free.out/report.html"), 390),
        (checked.join("report.html"), 1280),
    ] {
        let Some(printed) = run_page_steps(&report, width, &steps()) else {
            return;
        };
        assert_eq!(lines(&printed, 0), "[candidates]\nproperties = [1]\n");
        assert_eq!(ids(lines(&printed, 1), "exclude_elements"), brushed);
        assert_eq!(lines(&printed, 1), lines(&printed, 2));
        let last = lines(&printed, 3);
        assert_eq!(ids(last, "wanted_elements"), wanted);
        let allowed: BTreeSet<u32> = left.difference(&brushed).copied().collect();
        assert_eq!(ids(last, "elements"), allowed);
        // The saved file contains the same lines. The job names the file or contains the lines.
        assert_eq!(printed["saved"]["name"], "picked.toml");
        assert_eq!(printed["saved"]["text"], last);
        std::fs::write(dir.join("picked.toml"), last).unwrap();
        let named = layout(&dir, "named", "[candidates]\nfile = \"picked.toml\"\n");
        assert_eq!(named, layout(&dir, "inline", last));
        let elements: Vec<u32> = named.iter().map(|g| g.0).collect();
        assert!(elements.iter().all(|e| allowed.contains(e)), "{elements:?}");
        assert!(
            elements.iter().all(|e| !brushed.contains(e)),
            "{elements:?}"
        );
        for e in &wanted {
            let on = elements.iter().filter(|g| *g == e).count();
            assert!(on >= 1, "{e} of {elements:?}");
        }
        // Two fingers, or the wheel of a mouse, zoom in and do not rotate.
        let [before, after] = [0, 1].map(|k| printed["camera"][k].clone());
        assert!(after[0].as_f64() < before[0].as_f64());
        assert_eq!(before[1], after[1]);
    }
}

/// Returns S of the single gauge of the job, microstrain by load.
fn sensitivity(dir: &Path, gauges: &str) -> Vec<f64> {
    let job = dir.join("moved.toml");
    std::fs::write(&job, format!("{JOB}{gauges}")).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["sensitivity", job.to_str().unwrap()])
        .output()
        .unwrap();
    // One gauge does not determine three loads, so there is a finding, and S.
    assert_eq!(done.status.code(), Some(1));
    let table = std::fs::read_to_string(dir.join("moved.out/sensitivity.csv")).unwrap();
    let row = table.lines().nth(1).unwrap();
    row.split(',').skip(1).map(|v| v.parse().unwrap()).collect()
}

#[test]
fn a_gauge_that_is_dragged_is_written_with_the_place_on_the_surface_where_it_was_let_go() {
    let dir = folder("gauges");
    std::fs::write(dir.join("plate.bdf"), flat_plate_deck()).unwrap();
    let before = layout(&dir, "free", "");
    let report = dir.join("free.out/report.html");
    let [x, y] = [143.0, 64.0];
    for width in [1280, 390] {
        let from = before[0].1;
        let steps = json!([
            ["view", "z"],
            ["tool", "gauge"],
            ["gauges"],
            ["drag", from, [120.0, 30.0, 0.0], [x, y, 0.0]],
            ["gauges"],
            ["lines"],
        ]);
        let Some(printed) = run_page_steps(&report, width, &steps) else {
            return;
        };
        let written = printed["lines"][0][1].as_str().unwrap();
        let (head, row) = written.trim().split_once('\n').unwrap();
        let cells: Vec<&str> = row.split(',').collect();
        let of = |name: &str| cells[head.split(',').position(|h| h == name).unwrap()];
        let number = |name: &str| of(name).parse::<f64>().unwrap();
        assert_eq!(of("name"), "P01");
        // The gauge is dropped within two pixels of the place, on the middle surface of the shell (z = 0). The points
        // of the picture have steps of 2e-4 mm.
        let pixel = printed["gauges"][0][0]["pixel"].as_f64().unwrap();
        let away = (number("x") - x).hypot(number("y") - y);
        assert!(away < 2.0 * pixel, "{away} of {pixel}");
        assert!(number("z").abs() < 1e-3, "{row}");
        // In the view from above, the gauge is on the top. Its axis is in the plate.
        assert_eq!(of("surface"), "top");
        let length = number("dir_x").hypot(number("dir_y"));
        assert!(
            (length - 1.0).abs() < 1e-5 && number("dir_z").abs() < 1e-6,
            "{row}"
        );
        // As table of gauges of the job, the lines give the same place. Two pixels are a millimetre, over which S
        // changes by less than 2 % here.
        let axis = ["dir_x", "dir_y", "dir_z"].map(of).join(", ");
        let stated = format!(
            "[[gauge]]\nname = \"P01\"\nposition = [{x}, {y}, 0.0]\nsurface = \"top\"\ndirection = [{axis}]\n"
        );
        std::fs::write(dir.join("gauges.csv"), written).unwrap();
        let moved = sensitivity(&dir, "[gauges]\nfile = \"gauges.csv\"\n");
        let there = sensitivity(&dir, &stated);
        let most = there.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
        assert!(most > 0.0 && moved.len() == there.len());
        for (a, b) in moved.iter().zip(&there) {
            assert!((a - b).abs() < 0.02 * most, "{moved:?} {there:?}");
        }
        // The other gauges do not move.
        let all = printed["gauges"].as_array().unwrap();
        for (a, b) in all[0]
            .as_array()
            .unwrap()
            .iter()
            .zip(all[1].as_array().unwrap())
            .skip(1)
        {
            assert_eq!(a, b);
        }
    }
}

#[test]
fn on_fifty_thousand_elements_brush_and_box_take_what_is_seen_and_a_box_what_is_hidden_where_asked()
{
    picked_on_a_tube(250, 1_000_000);
}

#[test]
fn on_eighty_thousand_elements_that_are_drawn_coarser_brush_and_box_take_the_same() {
    picked_on_a_tube(400, 2_000_000);
}

/// Selects elements by a stroke, a box and a box through all layers on a tube with this number of rings. The page has
/// at most `bytes` bytes.
fn picked_on_a_tube(rings: u32, bytes: u64) {
    let dir = folder(&format!("tube-{rings}"));
    let deck = dir.join("tube.bdf");
    std::fs::write(&deck, tube(rings)).unwrap();
    let out = dir.join("tube.out");
    let found = strainbridge(&[
        "check",
        deck.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(found["decks"][0]["elements"], 200 * rings);
    let report = out.join("report.html");
    assert!(std::fs::metadata(&report).unwrap().len() < bytes);
    let length = EDGE * f64::from(rings);
    // From above, only wall 3 is visible. The steps are a stroke along its middle, a box around everything, and a box
    // through all layers.
    let all = json!(["drag", [-20, -100, 500], [length + 20.0, 600, 500]]);
    let steps = json!([
        ["view", "z"],
        ["state", "forbidden"],
        ["tool", "brush"],
        ["radius", 2],
        ["drag", [505, 255, 500], [1995, 255, 500]],
        ["lines"],
        ["clear"],
        ["state", "allowed"],
        ["tool", "box"],
        all,
        ["lines"],
        ["clear"],
        ["through", true],
        all,
        ["lines"],
    ]);
    for width in [1280, 390] {
        let Some(printed) = run_page_steps(&report, width, &steps) else {
            return;
        };
        let brushed = ids(lines(&printed, 0), "exclude_elements");
        // The stroke passes over the middles of these squares: the 25th of wall 3 from y = 500, rings 50 to 199.
        let under: Vec<u32> = (50..200).map(|i| 1 + 200 * i + 100 + 24).collect();
        assert!(under.iter().all(|e| brushed.contains(e)), "{brushed:?}");
        // Only wall 3, and nothing beyond the brush and one pixel: 3 pixels of 1.2 times the length in 1140 or 350
        // pixels.
        let reach = 3.0 * 1.2 * length / if width == 1280 { 1140.0 } else { 350.0 } + EDGE;
        for e in &brushed {
            let (ring, k) = ((e - 1) / 200, (e - 1) % 200);
            assert!((100..150).contains(&k), "{e}");
            let middle = [
                EDGE * (f64::from(ring) + 0.5),
                500.0 - EDGE * (f64::from(k - 100) + 0.5),
            ];
            assert!((middle[1] - 255.0).abs() <= reach, "{e} at {middle:?}");
            assert!(
                middle[0] >= 505.0 - reach && middle[0] <= 1995.0 + reach,
                "{e} at {middle:?}"
            );
        }
        assert_eq!(lines(&printed, 1), "[candidates]\nproperties = [3]\n");
        assert_eq!(
            lines(&printed, 2),
            "[candidates]\nproperties = [1, 2, 3, 4]\n"
        );
    }
}
