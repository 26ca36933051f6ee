//! From an export with unit loads to recovered loads, in the steps of a new user: `check`, `init`, `place`, `recover`,
//! and a few edited lines.
//!
//! The readings do not come from the unit loads. They come from decks that apply all loads of a run together, through
//! the tensors of `strains`.

use crate::command::{csv, find_shared_path, run, scratch};
use std::fmt::Write;
use std::path::Path;

/// Subcase of a deck with one load: LABEL, load set, and the size of the load.
struct Unit {
    label: &'static str,
    set: u32,
    applied: f64,
    /// Values in the runs, in units of the deck.
    runs: [f64; 3],
}

const fn unit(label: &'static str, set: u32, applied: f64, runs: [f64; 3]) -> Unit {
    Unit {
        label,
        set,
        applied,
        runs,
    }
}

/// Returns the deck with one subcase for each run. The subcase applies all loads together.
fn with_runs(deck: &str, units: &[Unit]) -> String {
    let (control, bulk) = deck.split_once("BEGIN BULK\n").unwrap();
    let head = control.split("SUBCASE").next().unwrap();
    let (mut cases, mut cards) = (String::new(), String::new());
    for r in 0..3 {
        let _ = writeln!(cases, "SUBCASE {}\n  LOAD = {}", r + 1, 901 + r);
        let pairs = units
            .iter()
            .map(|u| format!("{:e},{}", u.runs[r] / u.applied, u.set));
        let pairs: Vec<String> = pairs.collect();
        let (first, others) = pairs.split_at(pairs.len().min(3));
        let _ = writeln!(cards, "LOAD,{},1.0,{}", 901 + r, first.join(","));
        for four in others.chunks(4) {
            let _ = writeln!(cards, ",{}", four.join(","));
        }
    }
    format!("{head}{cases}BEGIN BULK\n{cards}{bulk}")
}

/// Number of repetitions of each run, each with other errors of the readings.
const REPEATS: usize = 40;

/// Returns readings of `gauges.csv` in the runs, microstrain, from the tensors of `strains.csv`. Each repetition of a
/// run has a uniform error with a standard deviation of 1 microstrain.
fn readings(gauges: &Path, strains: &Path) -> String {
    let (head, rows) = csv(strains);
    let at = |name: &str| head.iter().position(|h| h == name).unwrap();
    let names = ["Exx", "Eyy", "Ezz", "Exy", "Eyz", "Ezx"].map(at);
    let (gauge_head, gauges) = csv(gauges);
    let of = |name: &str| gauge_head.iter().position(|h| h == name).unwrap();
    let name = of("name");
    let list: Vec<&str> = gauges.iter().map(|g| g[name].as_str()).collect();
    let mut text = format!("run,{}\n", list.join(","));
    let mut seed = 7_u64;
    for repeat in 0..3 * REPEATS {
        let r = 1 + repeat / REPEATS;
        let _ = write!(text, "R{r}.{}", repeat % REPEATS);
        for g in &gauges {
            let d = ["dir_x", "dir_y", "dir_z"].map(|n| g[of(n)].parse::<f64>().unwrap());
            let row = rows.iter().find(|row| {
                row[at("subcase")] == r.to_string()
                    && row[at("element")] == g[of("element")]
                    && row[at("surface")] == g[of("surface")]
                    && row[at("location")] == "centre"
            });
            let e = names.map(|i| row.unwrap()[i].parse::<f64>().unwrap());
            let direct: f64 = (0..3).map(|i| d[i] * d[i] * e[i]).sum();
            let shear = e[3] * d[0] * d[1] + e[4] * d[1] * d[2] + e[5] * d[2] * d[0];
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let uniform = (seed >> 11) as f64 / (1_u64 << 53) as f64;
            let error = (2.0 * uniform - 1.0) * 3_f64.sqrt();
            let _ = write!(text, ",{:.3}", direct + 2.0 * shear + error);
        }
        text.push('\n');
    }
    text
}

/// Runs the steps from deck to loads, and compares the loads with the applied loads.
fn walk(name: &str, deck: &str, units: &[Unit], expected: &[&str]) {
    let folder = scratch(name);
    std::fs::write(folder.join("export.bdf"), deck).unwrap();
    std::fs::write(folder.join("runs.bdf"), with_runs(deck, units)).unwrap();
    let path = |f: &str| folder.join(f).display().to_string();
    let go = |arguments: &[&str], out: &str| {
        let got = run(arguments, &folder.join(out));
        assert_eq!(got.code, 0, "{name} {arguments:?}: {}", got.stderr);
        got
    };
    go(&["solve", &path("export.bdf"), "--modes", "0"], "solved");
    go(&["solve", &path("runs.bdf"), "--modes", "0"], "together");
    let (op2, together) = (path("solved/results.op2"), path("together/results.op2"));
    go(&["strains", &path("runs.bdf"), &together], "strains");

    go(&["check", &path("export.bdf"), &op2], "checked");
    let proposed = go(&["init", &path("export.bdf"), &op2], "work");
    let labels: Vec<&str> = units.iter().map(|u| u.label).collect();
    assert_eq!(
        proposed.result["loads"],
        serde_json::json!(labels),
        "{name}"
    );
    assert_eq!(proposed.result["left_out"], serde_json::json!([]), "{name}");
    assert_eq!(
        proposed.result["placeable"], true,
        "{name}: {}",
        proposed.stderr
    );
    let mut job = std::fs::read_to_string(folder.join("work/job.toml")).unwrap();
    let applied: Vec<f64> = (job.lines().filter_map(|l| l.strip_prefix("applied = ")))
        .map(|l| l.split('#').next().unwrap().trim().parse().unwrap())
        .collect();
    assert_eq!(applied, units.iter().map(|u| u.applied).collect::<Vec<_>>());
    for line in expected {
        let is_stated = |l: &str| l.starts_with(line) && l.contains("# check");
        assert!(job.lines().any(is_stated), "{name}: no line {line}: {job}");
    }
    let job_file = path("work/job.toml");
    go(&["place", &job_file], "work/job.out");

    let readings = readings(
        &folder.join("work/job.out/gauges.csv"),
        &folder.join("strains/strains.csv"),
    );
    std::fs::write(folder.join("work/strain.csv"), readings).unwrap();
    let mut edited = 0;
    for line in [
        "[gauges]",
        "file = \"job.out/gauges.csv\"",
        "[measured]",
        "strain = ",
    ] {
        assert!(job.contains(&format!("\n# {line}")), "{name}: {line}");
        job = job.replacen(&format!("\n# {line}"), &format!("\n{line}"), 1);
        edited += 1;
    }
    assert!(edited <= 6);
    std::fs::write(&job_file, job).unwrap();
    let recovered = go(&["recover", &job_file], "recovered");
    let (head, rows) = csv(&folder.join("recovered/loads.csv"));
    let kilo = |unit: &str| match unit {
        "kN" => 1e3,
        // The deck is in millimetres.
        "kN m" => 1e6,
        other => panic!("{other}"),
    };
    let loads = recovered.result["loads"].as_array().unwrap();
    let mut missed = Vec::new();
    assert_eq!(rows.len(), 3 * REPEATS);
    for u in units {
        let unit = loads.iter().find(|l| l["name"] == u.label).unwrap()["unit"]
            .as_str()
            .unwrap();
        let at = |end: &str| {
            head.iter()
                .position(|h| *h == format!("{}.{end}", u.label))
                .unwrap()
        };
        for (row, truth) in rows.iter().zip(u.runs.iter().flat_map(|f| [*f; REPEATS])) {
            let value = |i: usize| row[i].parse::<f64>().unwrap() * kilo(unit);
            if !(value(at("low"))..=value(at("high"))).contains(&truth) {
                missed.push((u.label, truth, value(at("low")), value(at("high"))));
            }
        }
    }
    // Nineteen of twenty intervals contain the true load. The loads of one run share the errors of its readings. In the
    // worst case, a run counts as one interval, and the standard deviation of the share is sqrt(0.95 * 0.05 / 120) = 2
    // %.
    let held = 1.0 - missed.len() as f64 / (3 * REPEATS * units.len()) as f64;
    assert!((held - 0.95).abs() < 0.04, "{name}: {held}: {missed:?}");
}

/// Adds a square tube along x from `x0` with `n` cells of 250 and side 200 at `y`. A station has a ring of eight grids,
/// with ids from `first`.
fn tube(t: &mut String, first: u32, property: u32, y: f64, n: u32) {
    const RING: [[f64; 2]; 8] = [
        [-1.0, -1.0],
        [0.0, -1.0],
        [1.0, -1.0],
        [1.0, 0.0],
        [1.0, 1.0],
        [0.0, 1.0],
        [-1.0, 1.0],
        [-1.0, 0.0],
    ];
    for i in 0..=n {
        for (j, [v, w]) in RING.iter().enumerate() {
            let id = first + 8 * i + j as u32;
            let (x, y, z) = (250.0 * f64::from(i), y + 100.0 * v, 100.0 * w);
            let _ = writeln!(t, "GRID,{id},,{x:.1},{y:.1},{z:.1}");
        }
    }
    for i in 0..n {
        for j in 0..8 {
            let (a, b) = (first + 8 * i + j, first + 8 * i + (j + 1) % 8);
            let _ = writeln!(
                t,
                "CQUAD4,{},{property},{a},{},{},{b}",
                first + 8 * i + j,
                a + 8,
                b + 8
            );
        }
    }
}

/// Adds a rigid ring at a station of a tube. A grid in its middle is the independent grid.
fn hub(t: &mut String, grid: u32, x: f64, y: f64, ring: u32) {
    let _ = writeln!(t, "GRID,{grid},,{x:.1},{y:.1},0.0");
    let ids: Vec<String> = (ring..ring + 8).map(|i| i.to_string()).collect();
    let _ = writeln!(t, "RBE2,{grid},{grid},123456,{}", ids[..5].join(","));
    let _ = writeln!(t, ",{}", ids[5..].join(","));
}

fn control(spc: &str, units: &[Unit]) -> String {
    let mut t = format!("SOL 101\nCEND\n{spc}STRAIN(FIBER,CENTER,PLOT) = ALL\nDISP = ALL\n");
    for (i, u) in units.iter().enumerate() {
        let _ = writeln!(
            t,
            "SUBCASE {}\n  LABEL = {}\n  LOAD = {}",
            i + 1,
            u.label,
            u.set
        );
    }
    t + "BEGIN BULK\nMAT1,1,210000.,,0.3,7.85-9\n"
}

fn boom_units() -> [Unit; 4] {
    [
        unit("hook.FZ", 1, -1.0, [-18_000.0, -9_000.0, 4_000.0]),
        unit("hook.FY", 2, 1.0, [2_500.0, -3_000.0, 800.0]),
        unit("hook.MX", 3, 1.0, [1.1e6, -2.3e6, 3.0e6]),
        unit("winch.FZ", 4, 1.0, [6_000.0, 12_000.0, -5_000.0]),
    ]
}

/// Returns a boom of 5 m fixed at its root, with a hook at its end and a winch at its middle.
fn boom() -> String {
    let mut t = control("SPC = 1\n", &boom_units());
    t.push_str("PSHELL,1,1,6.0,1,,1\nSPC1,1,123456,1,THRU,8\n");
    tube(&mut t, 1, 1, 0.0, 20);
    hub(&mut t, 1001, 5000.0, 0.0, 161);
    hub(&mut t, 1002, 2500.0, 0.0, 81);
    t.push_str("FORCE,1,1001,,1.0,0.0,0.0,-1.0\nFORCE,2,1001,,1.0,0.0,1.0,0.0\n");
    t.push_str("MOMENT,3,1001,,1.0,1.0,0.0,0.0\nFORCE,4,1002,,1.0,0.0,0.0,1.0\nENDDATA\n");
    t
}

#[test]
fn fewer_gauges_than_loads_are_a_layout_where_the_other_loads_are_nuisance_of_known_size() {
    let folder = scratch("first_hour_nuisance");
    std::fs::write(folder.join("boom.bdf"), boom()).unwrap();
    let deck = folder.join("boom.bdf").display().to_string();
    let proposed = run(&["init", &deck], &folder);
    assert_eq!(proposed.code, 0, "{}", proposed.stderr);
    let path = folder.join("job.toml");
    let job = std::fs::read_to_string(&path).unwrap();
    let nuisance = ["hook.FY", "hook.MX"].iter().fold(job, |job, name| {
        let named = format!("name = \"{name}\"\n");
        assert!(job.contains(&named));
        job.replace(&named, &format!("{named}role = \"nuisance\"\n"))
    });
    // Three gauges for four loads, of which two are wanted.
    let few = nuisance.replace("gauges = 8 ", "gauges = 3 ");
    assert_ne!(few, nuisance);
    std::fs::write(&path, few).unwrap();
    let placed = run(&["place", path.to_str().unwrap()], &folder.join("out"));
    assert_eq!(
        placed.codes("error"),
        Vec::<String>::new(),
        "{}",
        placed.stderr
    );
    assert_eq!(placed.code, 0);
}

#[test]
fn a_free_trailer_frame_gives_its_loads_within_their_intervals() {
    let units = [
        unit("AL.FZ", 11, 1.0, [14_000.0, 9_000.0, 17_000.0]),
        unit("AR.FZ", 12, 1.0, [13_000.0, 12_000.0, 6_000.0]),
        unit("BL.FZ", 13, 1.0, [8_000.0, 15_000.0, -4_000.0]),
        unit("BR.FZ", 14, 1.0, [9_000.0, 7_000.0, 11_000.0]),
        unit("pin.FZ", 15, 1.0, [-12_000.0, 6_000.0, 9_000.0]),
    ];
    let mut t = control("", &units);
    t.push_str(
        "PARAM,INREL,-2\nPSHELL,1,1,5.0,1,,1\nPSHELL,2,1,5.0,1,,1\nPBAR,3,1,2000.,6.+6,6.+6,9.+6\n",
    );
    for (side, (first, y)) in [(1, -500.0), (501, 500.0)].into_iter().enumerate() {
        let side = side as u32;
        tube(&mut t, first, side + 1, y, 24);
        for (station, at) in [(0, 1), (12, 2), (17, 3), (24, 4)] {
            let x = 250.0 * f64::from(station);
            hub(&mut t, 2000 + 10 * at + side, x, y, first + 8 * station);
        }
    }
    t.push_str("GRID,3001,,0.0,0.0,0.0\nCBAR,3001,3,2010,3001,0.0,0.0,1.0\nCBAR,3002,3,3001,2011,0.0,0.0,1.0\n");
    for at in [2, 3, 4] {
        let a = 2000 + 10 * at;
        let _ = writeln!(t, "CBAR,{},3,{a},{},0.0,0.0,1.0", 3000 + a, a + 1);
    }
    for (u, grid) in units.iter().zip([2020, 2021, 2030, 2031, 3001]) {
        let _ = writeln!(t, "FORCE,{},{grid},,1.0,0.0,0.0,1.0", u.set);
    }
    t.push_str("ENDDATA\n");
    walk("first_hour_trailer", &t, &units, &["expected = 10000.0"]);
}

#[test]
fn an_export_with_eight_unit_loads_gives_its_loads_within_their_intervals() {
    let Some(case) = find_shared_path("cases/first_hour") else {
        return;
    };
    let deck = std::fs::read_to_string(case.join("frame.bdf")).unwrap();
    let units = [
        unit("FL.FZ", 1, 1.0, [9_000.0, 14_000.0, 6_000.0]),
        unit("FR.FZ", 2, 1.0, [11_000.0, 8_000.0, 12_000.0]),
        unit("RL.FZ", 3, 1.0, [15_000.0, 9_000.0, 4_000.0]),
        unit("RR.FZ", 4, 1.0, [7_000.0, 16_000.0, 13_000.0]),
        unit("FL.FY", 5, 1.0, [1_000.0, -3_000.0, 2_000.0]),
        unit("RL.FY", 6, 1.0, [-2_000.0, 1_500.0, 3_000.0]),
        unit("FL.FX", 7, 1.0, [4_000.0, -2_000.0, 500.0]),
        unit("body.MX", 8, 1.0, [1.5e6, -1.0e6, 2.0e6]),
    ];
    walk(
        "first_hour_frame",
        &deck,
        &units,
        &["expected = 10000.0", "expected = 2000000.0"],
    );
}

#[test]
fn a_deck_without_loads_proposes_its_six_hubs_and_lists_the_other_points() {
    let folder = scratch("first_hour_hubs");
    let deck = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/truck-shell/truck.bdf");
    let got = run(&["init", deck.to_str().unwrap()], &folder);
    assert_eq!(got.code, 0, "{}", got.stderr);
    let hubs = ["LF", "RF", "LM", "RM", "LR", "RR"].map(|w| format!("{w}.FZ"));
    assert_eq!(
        got.result["loads"],
        serde_json::json!(hubs),
        "{}",
        got.stderr
    );
    assert!(!got.result["left_out"].as_array().unwrap().is_empty());
    let job = std::fs::read_to_string(folder.join("job.toml")).unwrap();
    for grid in 900_001..=900_006 {
        assert!(job.contains(&format!("\ngrid = {grid}\n")), "{grid}");
    }
}
