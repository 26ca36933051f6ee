//! `calibrate` through the program, with the examples of the guide. The loads of their unknown runs are stated here.

#[path = "../nastran/tests/support/mod.rs"]
mod support;

use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Returns exit code, `result.json` and standard error of a command.
fn run(command: &str, job: &Path, out: &Path) -> (Option<i32>, Value, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args([
            command.as_ref(),
            job.as_os_str(),
            "--out".as_ref(),
            out.as_os_str(),
        ])
        .output()
        .unwrap();
    let text = std::fs::read(out.join("result.json")).unwrap_or_default();
    let result = serde_json::from_slice(&text).unwrap_or(Value::Null);
    (
        done.status.code(),
        result,
        String::from_utf8_lossy(&done.stderr).into_owned(),
    )
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name)
        .join("calibrate.toml")
}

/// Returns value and sigma of a load in a run, from the result of `recover`.
fn load(result: &Value, run: &str, name: &str) -> (f64, f64) {
    let loads = result["loads"].as_array().unwrap();
    let found = loads
        .iter()
        .find(|l| l["run"] == run && l["name"] == name)
        .unwrap();
    (
        found["value"].as_f64().unwrap(),
        found["sigma"].as_f64().unwrap(),
    )
}

#[test]
fn trucks_that_nobody_weighed_are_weighed_by_the_bridge_within_their_intervals() {
    let folder = scratch("calibrate-bridge");
    let (code, result, printed) = run("calibrate", &example("bridge"), &folder.join("cal"));
    assert_eq!(code, Some(0), "{printed}");
    let c = &result["calibration"];
    assert_eq!(c["runs"], 12);
    assert_eq!(c["prior"], "none");
    assert_eq!(c["coverage"]["of"], 12);
    // The data have a scatter of 3 % in size and of a twentieth of the gauge distance in place. The noise is a
    // hundredth of that.
    let scatter = c["repeat_scatter_rel"].as_f64().unwrap();
    assert!((0.015..0.1).contains(&scatter), "{scatter}");
    assert!(c["noise_rel"].as_f64().unwrap() < scatter / 3.0);
    let (code, result, printed) = run(
        "recover",
        &folder.join("cal/calibrated.toml"),
        &folder.join("loads"),
    );
    assert_eq!(code, Some(0), "{printed}");
    for (run, lane, truth) in [
        ("R13", "west", 310.0),
        ("R14", "middle", 150.0),
        ("R15", "east", 265.0),
    ] {
        let (value, sigma) = load(&result, run, lane);
        // Three sigma, which one value of a few hundred exceeds.
        assert!(
            (value - truth).abs() < 3.0 * sigma,
            "{run}: {value} +- {sigma}, truth {truth}"
        );
        assert!(
            sigma < 0.1 * truth && sigma > 0.01 * truth,
            "{run}: {sigma}"
        );
    }
}

/// A truck between two lanes strains the bridge by the mean of its strain in both. The answer is two loads of half its
/// weight, each with the narrow interval of its lane.
#[test]
fn a_truck_between_two_lanes_is_named_and_its_intervals_hold_one_lane_too() {
    let folder = scratch("calibrate-between");
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bridge");
    for file in ["calibrate.toml", "runs.csv"] {
        std::fs::copy(from.join(file), folder.join(file)).unwrap();
    }
    let mut strain = std::fs::read_to_string(from.join("strain.csv")).unwrap();
    let row = |run: &str| -> Vec<f64> {
        let line = strain.lines().find(|l| l.starts_with(run)).unwrap();
        let numbers = line.split(',').skip(1);
        numbers.map(|v| v.parse().unwrap()).collect()
    };
    let (west, middle) = (row("R01"), row("R05"));
    let mean: Vec<String> = (west.iter().zip(&middle))
        .map(|(a, b)| format!("{:.3}", 0.5 * (a + b)))
        .collect();
    let _ = writeln!(strain, "BETWEEN,{}", mean.join(","));
    std::fs::write(folder.join("strain.csv"), strain).unwrap();
    let job = folder.join("calibrate.toml");
    let (code, _, printed) = run("calibrate", &job, &folder.join("cal"));
    assert_eq!(code, Some(0), "{printed}");
    let calibrated = folder.join("cal/calibrated.toml");
    let (code, result, printed) = run("recover", &calibrated, &folder.join("loads"));
    assert_eq!(code, Some(0), "{printed}");
    let findings = result["findings"].as_array().unwrap();
    let named: Vec<&Value> = findings
        .iter()
        .filter(|f| f["code"] == "loads-unlike-calibration-runs")
        .collect();
    // The finding does not name the three trucks that are in one lane.
    assert_eq!(named.len(), 1, "{named:?}");
    assert_eq!(named[0]["subject"], "BETWEEN");
    assert_eq!(named[0]["severity"], "warning");
    for lane in ["west", "middle"] {
        let (value, sigma) = load(&result, "BETWEEN", lane);
        assert!((value - 110.0).abs() < 30.0, "{lane}: {value}");
        // The 95 % intervals (two sigma) contain 220 kN in one lane and zero in the other.
        assert!(2.0 * sigma > 110.0, "{lane}: {sigma}");
    }
}

/// Loads in kilograms, read as kilonewtons without a model. Nothing contradicts them, so the output states their size
/// for the user.
#[test]
fn the_largest_known_load_is_stated_where_no_model_checks_its_unit() {
    let folder = scratch("calibrate-unit");
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bridge");
    for file in ["calibrate.toml", "strain.csv"] {
        std::fs::copy(from.join(file), folder.join(file)).unwrap();
    }
    let runs = std::fs::read_to_string(from.join("runs.csv")).unwrap();
    std::fs::write(folder.join("runs.csv"), runs.replace("220", "22434")).unwrap();
    let job = folder.join("calibrate.toml");
    let (code, result, printed) = run("calibrate", &job, &folder.join("cal"));
    assert_eq!(code, Some(0), "{printed}");
    let findings = result["findings"].as_array().unwrap();
    let found = findings
        .iter()
        .find(|f| f["code"] == "known-loads-unit-untested");
    let message = found.expect("a finding")["message"].as_str().unwrap();
    assert!(message.contains("22434 kN"), "{message}");
}

#[test]
fn a_run_whose_name_differs_between_the_files_is_named() {
    let folder = scratch("calibrate-names");
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bridge");
    let text = |file: &str| std::fs::read_to_string(from.join(file)).unwrap();
    for (name, strain, expected) in [
        ("same", text("strain.csv"), None),
        (
            "other",
            text("strain.csv").replace("R02,", "R2,"),
            Some("R02"),
        ),
        (
            "case",
            text("strain.csv")
                .replace("R01,", "r01,")
                .replace("R02,", "r02,"),
            Some("R01, R02"),
        ),
    ] {
        let job = folder.join(name);
        std::fs::create_dir_all(&job).unwrap();
        std::fs::write(job.join("strain.csv"), strain).unwrap();
        for file in ["calibrate.toml", "runs.csv"] {
            std::fs::write(job.join(file), text(file)).unwrap();
        }
        let (_, result, printed) = run("calibrate", &job.join("calibrate.toml"), &job.join("out"));
        let findings = result["findings"]
            .as_array()
            .unwrap_or_else(|| panic!("{printed}"));
        let found = findings.iter().find(|f| f["code"] == "run-without-record");
        assert_eq!(
            found.and_then(|f| f["subject"].as_str()),
            expected,
            "{name}"
        );
    }
}

#[test]
fn a_payload_with_known_sum_alone_also_calibrates() {
    let folder = scratch("calibrate-onboard");
    let (code, result, printed) = run("calibrate", &example("onboard"), &folder.join("cal"));
    assert_eq!(code, Some(0), "{printed}");
    assert_eq!(
        result["calibration"]["runs"], 9,
        "eight weighed bay by bay, one by its sum"
    );
    let left_out = result["calibration"]["left_out"].as_array().unwrap();
    let of_sum = left_out.iter().find(|l| l["run"] == "W9").unwrap();
    let one = |name: &str| {
        let all = of_sum["loads"].as_array().unwrap();
        all.iter().find(|l| l["name"] == name).unwrap()
    };
    for bay in ["front", "rear"] {
        assert!(one(bay)["known"].is_null(), "{of_sum}");
    }
    let keys = ["known", "low", "value", "high", "sigma"];
    let [known, low, value, high, sigma] = keys.map(|key| one("payload")[key].as_f64().unwrap());
    // The loads are uncertain before, and then conditioned on their sum, which is known within .2 kN. A part of the sum
    // remains that no gauge measures.
    assert!((known - 60.0).abs() < 1e-3, "{of_sum}");
    assert!(low < value - sigma && value + sigma < high, "{of_sum}");
    // One held-out run in twenty is outside its interval. A difference of this size occurs once in a few hundred runs.
    assert!((known - value).abs() < 3.5 * sigma, "{of_sum}");
    let (code, result, printed) = run(
        "recover",
        &folder.join("cal/calibrated.toml"),
        &folder.join("loads"),
    );
    assert_eq!(code, Some(0), "{printed}");
    for (run, bay, truth) in [
        ("L1", "front", 12.0),
        ("L1", "rear", 31.0),
        ("L2", "front", 33.0),
        ("L2", "rear", 5.0),
    ] {
        let (value, sigma) = load(&result, run, bay);
        assert!(
            (value - truth).abs() < 3.5 * sigma,
            "{run} {bay}: {value} +- {sigma}, truth {truth}"
        );
    }
}

/// The sum of the payloads is in newtons, the loads are in kilonewtons, and the sd has no unit. The job names columns
/// without their units.
#[test]
fn an_sd_has_the_unit_of_its_load_and_other_columns_may_have_units_too() {
    let calibrated = |name: &str, example_of: &str, change: &dyn Fn(&str, String) -> String| {
        let folder = scratch(name);
        for file in ["strain.csv", "runs.csv", "calibrate.toml"] {
            let path = example(example_of).with_file_name(file);
            let text = std::fs::read_to_string(path).unwrap();
            std::fs::write(folder.join(file), change(file, text)).unwrap();
        }
        let (code, _, printed) = run(
            "calibrate",
            &folder.join("calibrate.toml"),
            &folder.join("cal"),
        );
        assert_eq!(code, Some(0), "{printed}");
        let text = std::fs::read_to_string(folder.join("cal/sensitivity.csv")).unwrap();
        let row =
            |l: &str| -> Vec<f64> { l.split(',').skip(1).map(|v| v.parse().unwrap()).collect() };
        text.lines().skip(1).flat_map(row).collect::<Vec<f64>>()
    };
    let newtons = |file: &str, text: String| match file {
        "runs.csv" => text
            .replace(",payload,payload_sd", ",payload [N],payload_sd")
            .replace(",60,0.2", ",60000,200"),
        "calibrate.toml" => text.replace("\nunits = { force = \"kN\" }", ""),
        _ => text,
    };
    let units = |file: &str, text: String| match file {
        "runs.csv" => text.replace("run,lane,speed,", "run,lane [-],speed [km/h],"),
        _ => text,
    };
    for (name, change) in [
        ("onboard", &newtons as &dyn Fn(&str, String) -> String),
        ("bridge", &units as &dyn Fn(&str, String) -> String),
    ] {
        let plain = calibrated(
            &format!("calibrate-plain-{name}"),
            name,
            &|_: &str, text: String| text,
        );
        let other = calibrated(&format!("calibrate-units-{name}"), name, change);
        assert!(!plain.is_empty() && plain.len() == other.len());
        for (a, b) in plain.iter().zip(&other) {
            // The conversion from newtons to kilonewtons changes the last written digits.
            assert!((a - b).abs() <= 1e-5 * a.abs().max(1e-3), "{name}: {a} {b}");
        }
    }
}

#[test]
fn runs_that_do_not_determine_s_are_reported_and_missing_known_loads_are_a_fault() {
    let folder = scratch("calibrate-undetermined");
    for file in ["strain.csv", "runs.csv", "calibrate.toml"] {
        std::fs::copy(example("bridge").with_file_name(file), folder.join(file)).unwrap();
    }
    let job = folder.join("calibrate.toml");
    let text = std::fs::read_to_string(&job).unwrap();
    let west = text.replace(
        "[calibration]",
        "[calibration]\nruns = [\"R01\", \"R02\", \"R03\", \"R04\"]",
    );
    std::fs::write(&job, &west).unwrap();
    let (code, result, _) = run("calibrate", &job, &folder.join("out"));
    assert_eq!(code, Some(1));
    let findings = result["findings"].as_array().unwrap();
    assert!(
        findings
            .iter()
            .any(|f| f["code"] == "calibration-not-determined"),
        "{findings:?}"
    );
    std::fs::write(
        &job,
        text.replace("[calibration]", "[calibration]\nruns = [\"R13\"]"),
    )
    .unwrap();
    let (code, _, printed) = run("calibrate", &job, &folder.join("out"));
    assert_eq!(code, Some(2));
    assert!(
        printed.contains("runs.csv:14: run: the loads of run `R13` are not known"),
        "{printed}"
    );
}

#[test]
fn of_lorries_that_a_scale_weighed_whole_the_whole_is_known_and_the_axles_are_not() {
    const ROWS: [[f64; 2]; 6] = [
        [3.0, 1.0],
        [2.0, -1.0],
        [-1.0, 2.0],
        [1.0, 3.0],
        [2.0, 1.0],
        [-2.0, 1.0],
    ];
    let folder = scratch("calibrate-sums-alone");
    let job = "units = \"m-kg-s\"\nreport_units = { force = \"kN\" }\n[[load]]\nname = \"front\"\n[[load]]\nname = \"rear\"\n\
               [[combination]]\nname = \"whole\"\nterms = { front = 1, rear = 1 }\n[measured]\nstrain = \"strain.csv\"\n\
               noise_microstrain = 0.1\n[runs]\nfile = \"runs.csv\"\nunits = { force = \"kN\" }\n";
    let loads = |i: u32| [f64::from(5 + 7 * i % 11), f64::from(4 + 5 * i % 13)];
    let (mut runs, mut strain) = (
        "run,front,rear,whole\n".to_owned(),
        "run,A,B,C,D,E,F\n".to_owned(),
    );
    for i in 0..17 {
        let [front, rear] = loads(i);
        if i < 14 {
            let _ = writeln!(runs, "R{i},,,{}", front + rear);
        }
        let _ = write!(strain, "R{i}");
        for (g, row) in (0_u32..).zip(ROWS) {
            // 0.1 microstrain, root mean square.
            let (r, g) = (f64::from(i), f64::from(g));
            let noise = 0.1 * 2_f64.sqrt() * (2.3 * r * r + 1.7 * g * g * r + g).sin();
            let _ = write!(strain, ",{:.6}", row[0] * front + row[1] * rear + noise);
        }
        let _ = writeln!(strain);
    }
    let job = write_job(&folder, job, &runs, &strain);
    let (code, result, printed) = run("calibrate", &job, &folder.join("cal"));
    assert_eq!(code, Some(1), "{printed}");
    let undetermined = result["calibration"]["undetermined"].as_array().unwrap();
    let [apart] = undetermined.as_slice() else {
        panic!("{undetermined:?}")
    };
    let share = |name: &str| apart[name].as_f64().unwrap();
    assert!(
        (share("front") + share("rear")).abs() < 1e-6,
        "what takes from one axle and gives to the other: {apart}"
    );
    let words: Vec<&str> = printed.split_whitespace().collect();
    assert!(
        words
            .join(" ")
            .contains("The runs determine these sums: front + rear."),
        "{printed}"
    );
    let calibrated = folder.join("cal/calibrated.toml");
    let (code, result, printed) = run("recover", &calibrated, &folder.join("loads"));
    assert_eq!(code, Some(1), "{printed}");
    assert!(printed.contains("loads-not-determined"), "{printed}");
    // With the true S: noise times the root of the sum of (S'S)^-1.
    let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
    for [x, y] in ROWS {
        (a, b, c) = (a + x * x, b + x * y, c + y * y);
    }
    let best = 0.1 * ((a + c - 2.0 * b) / (a * c - b * b)).sqrt();
    for i in 14..17 {
        let truth: f64 = loads(i).iter().sum();
        let run = format!("R{i}");
        let (value, sigma) = load(&result, &run, "whole");
        assert!(
            (value - truth).abs() < 3.0 * sigma,
            "{run}: {value} +- {sigma}"
        );
        assert!(
            sigma < 1.5 * best && sigma > 0.9 * best,
            "{run}: {sigma}, {best}"
        );
        for name in ["front", "rear"] {
            assert!(load(&result, &run, name).1 > truth, "{run} {name}");
        }
    }
}

/// Returns a strip of plates, 400 by 80 mm, clamped at x = 0, with a rigid end plate at x = 400.
fn strip() -> String {
    use std::fmt::Write;
    let (nx, ny, h) = (20_u32, 4_u32, 20.0);
    let mut deck = String::from(
        "SOL 101\nCEND\nSPC = 1\nSTRAIN(FIBER,CORNER) = ALL\nBEGIN BULK\nPSHELL,1,1,5.,1,,1\nMAT1,1,210000.,,.3,7.85-9\n",
    );
    let grid = |i: u32, j: u32| 1 + i + 100 * j;
    for j in 0..=ny {
        for i in 0..=nx {
            let (x, y) = (h * f64::from(i), h * f64::from(j) - 40.0);
            let _ = writeln!(deck, "GRID,{},,{x:.1},{y:.1},0.", grid(i, j));
        }
        let _ = writeln!(deck, "SPC1,1,123456,{}", grid(0, j));
    }
    for j in 0..ny {
        for i in 0..nx {
            let id = 1 + i + 100 * j;
            let [a, b] = [grid(i, j), grid(i, j + 1)];
            let _ = writeln!(deck, "CQUAD4,{id},1,{a},{},{},{b}", a + 1, b + 1);
        }
    }
    let end: Vec<String> = (0..=ny).map(|j| grid(nx, j).to_string()).collect();
    deck += "GRID,9001,,400.,0.,0.\n";
    let _ = writeln!(deck, "RBE2,900,9001,123456,{}", end.join(","));
    deck + "ENDDATA\n"
}

/// Nominal gauges of the strip: x, y, angle from x in degrees. All are on top.
const DRAWN: [[f64; 3]; 6] = [
    [90.0, 30.0, 0.0],
    [90.0, -30.0, 0.0],
    [150.0, 10.0, 45.0],
    [150.0, -10.0, -45.0],
    [250.0, 30.0, 30.0],
    [250.0, -30.0, 60.0],
];
/// Offsets of the installed gauges: along, across (mm), angle (degrees).
const GLUED: [[f64; 3]; 6] = [
    [5.0, -4.0, 3.0],
    [-6.0, 3.0, -2.0],
    [2.0, 6.0, 4.0],
    [-4.0, -5.0, -3.0],
    [7.0, 2.0, -4.0],
    [3.0, -6.0, 2.0],
];

/// Returns a job of the strip with gauges at `share` of the offsets [`GLUED`].
fn strip_job(share: f64) -> String {
    strip_job_with(&GLUED.map(|off| off.map(|v| share * v)))
}

/// Returns a job of the strip with the given gauge offsets.
fn strip_job_with(offsets: &[[f64; 3]; 6]) -> String {
    use std::fmt::Write;
    let mut job =
        String::from("units = \"mm-t-s\"\n[model]\ndeck = \"strip.bdf\"\nmesh_error = false\n");
    for (name, component) in [
        ("bend", "FZ"),
        ("side", "MZ"),
        ("pull", "FX"),
        ("twist", "MX"),
    ] {
        let _ = write!(
            job,
            "[[load]]\nname = \"{name}\"\ngrid = 9001\ncomponent = \"{component}\"\n"
        );
    }
    for (g, ([x, y, deg], off)) in DRAWN.iter().zip(offsets).enumerate() {
        let [along, across, turned] = off;
        let (s, c) = deg.to_radians().sin_cos();
        let (x, y) = (x + along * c - across * s, y + along * s + across * c);
        let _ = write!(
            job,
            "[[gauge]]\nname = \"G{g}\"\nposition = [{x}, {y}, 2.5]\nsurface = \"top\"\ndirection = [1, 0, 0]\nangle_deg = {}\n",
            deg + turned
        );
    }
    job
}

/// Returns S of a job, one row per gauge.
fn sensitivity(folder: &Path, job: &str, out: &str) -> Vec<Vec<f64>> {
    let path = folder.join(format!("{out}.toml"));
    std::fs::write(&path, job).unwrap();
    let (code, _, printed) = run("sensitivity", &path, &folder.join(out));
    assert_eq!(code, Some(0), "{printed}");
    let text = std::fs::read_to_string(folder.join(out).join("sensitivity.csv")).unwrap();
    let row = |l: &str| l.split(',').skip(1).map(|v| v.parse().unwrap()).collect();
    text.lines().skip(1).map(row).collect()
}

/// Numbers with standard deviation 1.
const NOISE: [f64; 9] = [0.7, -1.2, 0.3, 1.1, -0.5, -0.9, 1.4, 0.2, -1.0];

/// Writes strain and known loads of six pushes with the rows `truth`, and returns the sizes of the loads.
///
/// Each load gives about 300 microstrain at the gauge with the largest strain. The noise of 1 microstrain is fixed
/// here.
fn write_pushes(folder: &Path, truth: &[Vec<f64>]) -> [f64; 4] {
    let hot = |l: usize| truth.iter().map(|r| r[l].abs()).fold(0.0, f64::max);
    let sizes: [f64; 4] = std::array::from_fn(|l| 300.0 / hot(l));
    let pushes: [[f64; 4]; 6] = [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [1.0, -1.0, 0.0, 0.5],
        [-0.5, 0.5, 0.5, 1.0],
    ];
    let mut strain = "run,G0,G1,G2,G3,G4,G5\n".to_owned();
    let mut runs = "run,bend,side,pull,twist\n".to_owned();
    for (p, push) in pushes.iter().enumerate() {
        let f: Vec<f64> = push.iter().zip(sizes).map(|(p, s)| p * s).collect();
        let _ = writeln!(runs, "P{p},{},{},{},{}", f[0], f[1], f[2], f[3]);
        let _ = write!(strain, "P{p}");
        for (g, row) in truth.iter().enumerate() {
            let e: f64 = row.iter().zip(&f).map(|(s, f)| s * f).sum();
            let _ = write!(strain, ",{}", e + NOISE[(5 * p + 2 * g) % 9]);
        }
        strain += "\n";
    }
    std::fs::write(folder.join("strain.csv"), strain).unwrap();
    std::fs::write(folder.join("runs.csv"), runs).unwrap();
    sizes
}

/// Without a stated tolerance, rows are those of the nominal positions. One gauge of the strip is rotated, displaced,
/// has another gain, or has no fault.
#[test]
fn a_turned_gauge_is_distinguished_from_a_gain_if_s_has_a_model() {
    let folder = scratch("calibrate-turned");
    std::fs::write(folder.join("strip.bdf"), strip()).unwrap();
    let job = strip_job(0.0)
        + "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\n[runs]\nfile = \"runs.csv\"\nunits = { force = \"N\", moment = \"N mm\" }\n\
           [calibration]\nmodel_uncertainty_rel = 0.02\n";
    let path = folder.join("job.toml");
    for (name, gauge, off, gain, wanted) in [
        ("clean", 0, [0.0; 3], 1.0, "none"),
        ("turned", 0, [0.0, 0.0, 12.0], 1.0, "angle"),
        ("turned-45", 2, [0.0, 0.0, -15.0], 1.0, "angle"),
        ("moved", 1, [0.0, 20.0, 0.0], 1.0, "place"),
        ("gain", 0, [0.0; 3], 0.7, "gain"),
        ("gain-45", 3, [0.0; 3], 1.4, "gain"),
    ] {
        let mut offsets = [[0.0; 3]; 6];
        offsets[gauge] = off;
        let mut truth = sensitivity(&folder, &strip_job_with(&offsets), name);
        // Each entry also has an error of 2 %, as in a model.
        for (g, row) in truth.iter_mut().enumerate() {
            let own = if g == gauge { gain } else { 1.0 };
            for (l, s) in row.iter_mut().enumerate() {
                *s *= own * (1.0 + 0.02 * NOISE[(4 * g + 7 * l) % 9]);
            }
        }
        write_pushes(&folder, &truth);
        std::fs::write(&path, &job).unwrap();
        let (code, result, printed) = run("calibrate", &path, &folder.join("out"));
        assert_eq!(code, Some(0), "{printed}");
        for g in 0..6 {
            let word = &result["calibration"]["gauges"][g]["looks_like"];
            let wanted = if g == gauge { wanted } else { "none" };
            assert_eq!(word, wanted, "{name}, G{g}: {result}");
        }
        // Only a stated tolerance requests the estimate of the position.
        assert!(result["calibration"]["gauges"][gauge]["as_glued"].is_null());
    }
}

#[test]
fn gauges_are_found_where_they_were_glued_and_their_table_makes_the_true_s() {
    let folder = scratch("calibrate-as-glued");
    std::fs::write(folder.join("strip.bdf"), strip()).unwrap();
    let truth = sensitivity(&folder, &strip_job(1.0), "glued");
    let drawn = sensitivity(&folder, &strip_job(0.0), "drawn");
    let sizes = write_pushes(&folder, &truth);
    let job = strip_job(0.0)
        + "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\n[runs]\nfile = \"runs.csv\"\nunits = { force = \"N\", moment = \"N mm\" }\n\
           [calibration]\nmodel_uncertainty_rel = 0.001\nposition_tolerance = 5.0\nangle_tolerance_deg = 3.0\n";
    std::fs::write(folder.join("job.toml"), &job).unwrap();
    let (code, result, printed) = run("calibrate", &folder.join("job.toml"), &folder.join("cal"));
    assert_eq!(code, Some(0), "{printed}");
    let (mut told, mut off) = (0, 0);
    for (g, truth) in GLUED.iter().enumerate() {
        let found = &result["calibration"]["gauges"][g]["as_glued"];
        for (what, truth) in ["along", "across", "angle_deg"].iter().zip(truth) {
            let at = |key: &str| found[what][key].as_f64().unwrap();
            let distance = (at("value") - truth).abs() / at("sigma");
            assert!(distance < 3.5, "G{g} {what}: {found} for {truth}");
            off += usize::from(distance > 2.0);
            told += usize::from(found[what]["told"] == true);
        }
    }
    // Of 18 intervals, about one is outside two sigma. Three have a chance of one in a hundred.
    assert!(off < 4 && told > 9, "{off} off, {told} reported: {result}");
    // The written table replaces the gauges of the job.
    let (head, _) = strip_job(0.0)
        .split_once("[[gauge]]")
        .map(|(a, b)| (a.to_owned(), b.len()))
        .unwrap();
    let table = head + "[gauges]\nfile = \"cal/gauges_as_glued.csv\"\n";
    let glued = sensitivity(&folder, &table, "table");
    let rms = |s: &[Vec<f64>]| -> f64 {
        let apart = s
            .iter()
            .zip(&truth)
            .flat_map(|(a, b)| a.iter().zip(b).zip(sizes));
        apart
            .map(|((a, b), f)| ((a - b) * f).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    assert!(
        rms(&glued) < 0.3 * rms(&drawn),
        "{} {}",
        rms(&glued),
        rms(&drawn)
    );
}

/// Measured bridge.
struct Bridge {
    gauges: Vec<String>,
    runs: Vec<Run>,
}

/// Passage of the truck.
struct Run {
    name: String,
    lane: String,
    strain: Vec<f64>,
    /// Whether this is a calibration run.
    teaches: bool,
}

/// Returns passages of `folder` in a known lane with readings of all of the `most` gauges with the largest strain.
///
/// For weighing, it takes the suitable passages, and every other one is a calibration run. A planted case has a table
/// that states the role of each run.
fn bridge(folder: &str, most: usize) -> Option<Bridge> {
    let table = |name: &str| -> Option<Vec<Vec<String>>> {
        let row = |l: &str| l.split(',').map(str::to_owned).collect();
        let text = support::text(&format!("bridges/{folder}/{name}"))?;
        Some(text.lines().map(row).collect())
    };
    let (notes, peaks) = (table("runs.csv")?, table("peaks.csv")?);
    let column = |name: &str| notes[0].iter().position(|h| h == name);
    let (lane, fit, role) = (
        column("lane").unwrap(),
        column("fit_for_weighing"),
        column("role"),
    );
    let power = |g: &usize| -> f64 {
        let read = peaks[1..].iter().filter_map(|r| r[*g].parse::<f64>().ok());
        read.map(|v| v * v).sum()
    };
    let mut hottest: Vec<usize> = (1..peaks[0].len()).collect();
    hottest.sort_by(|a, b| power(b).total_cmp(&power(a)));
    hottest.truncate(most);
    hottest.sort_unstable();
    let mut runs: Vec<Run> = Vec::new();
    for row in &peaks[1..] {
        let Some(note) = notes.iter().find(|n| n[0] == row[0]) else {
            continue;
        };
        let strain: Option<Vec<f64>> = hottest.iter().map(|g| row[*g].parse().ok()).collect();
        let (Some(strain), true) = (strain, fit.is_none_or(|f| note[f] == "1")) else {
            continue;
        };
        runs.push(Run {
            name: row[0].clone(),
            lane: note[lane].clone(),
            strain,
            teaches: role.map_or(runs.len().is_multiple_of(2), |r| note[r] == "calibration"),
        });
    }
    runs.retain(|r| !r.lane.is_empty());
    Some(Bridge {
        gauges: hottest.iter().map(|g| peaks[0][*g].clone()).collect(),
        runs,
    })
}

/// Writes strain and runs files of the calibration runs or of the others. The channel `turned` has reversed polarity.
fn write_runs(folder: &Path, of: &Bridge, teach: bool, turned: Option<usize>) {
    let lanes = ["east", "middle", "west"];
    let mut strain = format!("run,{}\n", of.gauges.join(","));
    let mut runs = format!("run,lane,{}\n", lanes.join(","));
    for Run {
        name,
        lane,
        strain: values,
        ..
    } in of.runs.iter().filter(|r| r.teaches == teach)
    {
        strain += name;
        for (g, v) in values.iter().enumerate() {
            let sign = if turned == Some(g) { -1.0 } else { 1.0 };
            let _ = write!(strain, ",{}", sign * v);
        }
        strain.push('\n');
        let _ = write!(runs, "{name},{lane}");
        for l in lanes {
            let _ = write!(runs, ",{}", if l == lane { 219.386 } else { 0.0 });
        }
        runs.push('\n');
    }
    std::fs::write(folder.join("strain.csv"), strain).unwrap();
    std::fs::write(folder.join("runs.csv"), runs).unwrap();
}

const BRIDGE: &str = r#"
units = "m-kg-s"
[[load]]
name = "east"
[[load]]
name = "middle"
[[load]]
name = "west"
[measured]
strain = "strain.csv"
noise_microstrain = 0.05
[runs]
file = "runs.csv"
units = { force = "kN" }
[calibration]
repeats = ["lane"]
"#;

/// Returns the result of `reconcile` for the runs that were not used in the calibration, and the identified effects.
fn reconcile_other_runs(
    name: &str,
    bridge: &Bridge,
    turned: Option<usize>,
) -> (Value, Vec<String>) {
    let folder = scratch(name);
    std::fs::write(folder.join("job.toml"), BRIDGE).unwrap();
    write_runs(&folder, bridge, true, None);
    let (code, _, printed) = run("calibrate", &folder.join("job.toml"), &folder.join("cal"));
    assert_eq!(code, Some(0), "{printed}");
    write_runs(&folder, bridge, false, turned);
    let job = folder.join("cal/calibrated.toml");
    let (_, result, printed) = run("reconcile", &job, &folder.join("found"));
    let named = result["named"]
        .as_array()
        .unwrap_or_else(|| panic!("{printed}"));
    let words = named.iter().map(|n| n.as_str().unwrap().to_owned());
    (result.clone(), words.collect())
}

/// Calibrated with every other run, `reconcile` of the others finds nothing missing, and identifies the one channel
/// with reversed polarity.
///
/// With noise alone (.05 of 20 microstrain, while repeats scatter by a tenth), every other run would be a
/// contradiction.
#[test]
fn against_a_calibrated_s_reconcile_counts_what_repeats_scatter_by() {
    let Some(bridge) = bridge("ponca", usize::MAX) else {
        return;
    };
    assert!(bridge.runs.len() > 20, "{}", bridge.runs.len());
    let largest = |g: &usize| {
        let power = bridge.runs.iter().map(|r| r.strain[*g] * r.strain[*g]);
        power.sum::<f64>()
    };
    let hot = (0..bridge.gauges.len()).max_by(|a, b| largest(a).total_cmp(&largest(b)));
    let hot = hot.unwrap();
    for (name, turned) in [("control", None), ("turned", Some(hot))] {
        let (result, named) =
            reconcile_other_runs(&format!("calibrated-reconcile-{name}"), &bridge, turned);
        match turned {
            // The scatter may hide a gain of a few per cent. Both verdicts identify nothing.
            None => assert!(
                named.is_empty()
                    && (result["verdict"] == "none" || result["verdict"] == "below-detectability"),
                "{} {named:?}",
                result["verdict"]
            ),
            Some(g) => assert_eq!(named, [format!("sign_flip:{}", bridge.gauges[g])]),
        }
    }
}

/// Two calibration runs per lane give three degrees of freedom.
///
/// The scatter of gauges in patterns that no load causes is estimated from all runs together. Two exchanged channels
/// exceed it. They have the largest residuals and are identified. A bridge without a fault has no such residual.
#[test]
fn few_repeats_do_not_hide_channels_that_were_exchanged() {
    let exchanged = ["B5411", "B7059"];
    for (case, has_fault) in [("case01", false), ("case02", true)] {
        let Some(bridge) = bridge(&format!("planted/{case}"), 12) else {
            return;
        };
        assert_eq!(bridge.runs.iter().filter(|r| r.teaches).count(), 6);
        let (result, named) = reconcile_other_runs(&format!("calibrated-{case}"), &bridge, None);
        if !has_fault {
            assert!(named.is_empty() && result["verdict"] == "none", "{named:?}");
            continue;
        }
        let off = result["gauges_off_before"].as_array().unwrap();
        let mut worst: Vec<&str> = off
            .iter()
            .take(2)
            .filter_map(|g| g["name"].as_str())
            .collect();
        worst.sort_unstable();
        assert_eq!(worst, exchanged, "{result}");
        // The bridge is a measured one. Other changes of its gauges between the calibration runs and the later runs may
        // be identified as well.
        assert!(
            named.iter().any(|n| n == "gauge_swap:B7059+B5411"),
            "{} {named:?}",
            result["verdict"]
        );
    }
}

/// Writes a job without a model, its strain and its runs.
fn write_job(folder: &Path, job: &str, runs: &str, strain: &str) -> PathBuf {
    for (name, text) in [
        ("job.toml", job),
        ("runs.csv", runs),
        ("strain.csv", strain),
    ] {
        std::fs::write(folder.join(name), text).unwrap();
    }
    folder.join("job.toml")
}

#[test]
fn an_sd_that_is_none_is_a_fault_of_its_field_for_check_too() {
    const JOB: &str = "units = \"m-kg-s\"\nreport_units = { force = \"kN\" }\n[[load]]\nname = \"jack\"\n\
                       [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\n[runs]\nfile = \"runs.csv\"\n";
    const STRAIN: &str = "run,C1,C2\nA,10.1,20.2\nB,20.1,40.3\nC,30.2,60.1\n";
    for sd in ["-0.2", "1e300"] {
        let folder = scratch("calibrate-sd");
        let runs = format!("run,jack,jack_sd\nA,10,0.1\nB,20,{sd}\nC,30,0.1\n");
        let job = write_job(&folder, JOB, &runs, STRAIN);
        let (code, _, printed) = run("calibrate", &job, &folder.join("out"));
        assert_eq!(code, Some(2), "{printed}");
        assert!(
            printed.contains("runs.csv:3") && printed.contains("jack_sd"),
            "{printed}"
        );
        let (code, _, of_check) = run("check", &job, &folder.join("checked"));
        assert_eq!(code, Some(2), "{of_check}");
        assert!(of_check.contains("jack_sd"), "{of_check}");
    }
}

#[test]
fn legs_of_a_rosette_calibrate_without_a_model() {
    let folder = scratch("calibrate-rosette");
    let job = "units = \"m-kg-s\"\nreport_units = { force = \"kN\" }\n[[load]]\nname = \"jack\"\n\
               [[gauge]]\nname = \"C1\"\nelement = 1\n[[gauge]]\nname = \"R1\"\nelement = 2\nrosette = \"rectangular\"\n\
               [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\n[runs]\nfile = \"runs.csv\"\n";
    let strain = "run,C1,R1.a,R1.b,R1.c\nA,10.1,20.2,5.1,-4.2\nB,20.1,40.3,10.2,-8.1\nC,30.2,60.1,14.9,-12.1\n";
    let job = write_job(&folder, job, "run,jack\nA,10\nB,20\nC,30\n", strain);
    let (code, result, printed) = run("calibrate", &job, &folder.join("out"));
    assert_eq!(code, Some(0), "{printed}");
    let gauges = result["calibration"]["gauges"].as_array().unwrap();
    let names: Vec<&str> = gauges.iter().map(|g| g["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["C1", "R1.a", "R1.b", "R1.c"]);
}

/// Returns the findings with a code.
fn of_code<'a>(result: &'a Value, code: &str) -> Vec<&'a Value> {
    let findings = result["findings"].as_array().unwrap().iter();
    findings.filter(|f| f["code"] == code).collect()
}

#[test]
fn a_gauge_without_a_column_is_reported_and_is_not_dead() {
    let folder = scratch("calibrate-no-column");
    let job = "units = \"m-kg-s\"\nreport_units = { force = \"kN\" }\n[[load]]\nname = \"jack\"\n\
               [[gauge]]\nname = \"C1\"\nelement = 1\n[[gauge]]\nname = \"C2\"\nelement = 2\n[[gauge]]\nname = \"C3\"\nelement = 3\n\
               [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\n[runs]\nfile = \"runs.csv\"\n";
    let strain = "run,C1,C2\nA,10.1,20.2\nB,20.1,40.3\nC,30.2,60.1\n";
    let job = write_job(&folder, job, "run,jack\nA,10\nB,20\nC,30\n", strain);
    for command in ["calibrate", "check"] {
        let (code, result, printed) = run(command, &job, &folder.join(command));
        assert_eq!(code, Some(0), "{printed}");
        let missing = of_code(&result, "gauge-without-strain");
        assert_eq!(missing.len(), 1, "{command}: {printed}");
        assert_eq!(missing[0]["subject"], "C3");
        assert!(of_code(&result, "gauge-dead").is_empty(), "{printed}");
    }
    let (_, result, _) = run("calibrate", &job, &folder.join("calibrate"));
    let gauges = result["calibration"]["gauges"].as_array().unwrap();
    let names: Vec<&str> = gauges.iter().map(|g| g["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["C1", "C2"]);
}

/// A jack presses in two places. Its second force is recorded in N, but the program expects kN.
#[test]
fn loads_of_one_unit_that_make_a_thousand_times_less_strain_are_named() {
    let folder = scratch("calibrate-uneven");
    let job = "units = \"m-kg-s\"\nreport_units = { force = \"kN\" }\n[[load]]\nname = \"left\"\n[[load]]\nname = \"right\"\n\
               [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\n[runs]\nfile = \"runs.csv\"\n";
    let strain = "run,C1,C2\nA,10.1,2.1\nB,20.3,4.0\nC,2.2,9.8\nD,4.1,20.2\n";
    for (factor, named) in [(1000.0, 1), (1.0, 0)] {
        let [c, d] = [10.0 * factor, 20.0 * factor];
        let runs = format!("run,left,right\nA,10,0\nB,20,0\nC,0,{c}\nD,0,{d}\n");
        let job = write_job(&folder, job, &runs, strain);
        let (code, result, printed) = run("calibrate", &job, &folder.join("out"));
        assert_eq!(code, Some(0), "{printed}");
        let found = of_code(&result, "known-loads-unit-doubtful");
        assert_eq!(found.len(), named, "{printed}");
        assert!(found.iter().all(|f| f["subject"] == "right"), "{printed}");
    }
    // If a load causes no strain in the gauges, they read noise. Its unit is then not wrong.
    let strain = "run,C1,C2\nA,1010.1,210.3\nB,2019.8,420.1\nC,0.2,-0.3\nD,0.4,0.1\n";
    let runs = "run,left,right\nA,10,0\nB,20,0\nC,0,10\nD,0,20\n";
    let job = write_job(&folder, job, runs, strain);
    let (_, result, printed) = run("calibrate", &job, &folder.join("out"));
    assert!(
        of_code(&result, "known-loads-unit-doubtful").is_empty(),
        "{printed}"
    );
}

/// Returns the strain of a payload: microstrain per kN and per kN m about y, for four gauges.
fn lift(kg: f64, x: f64, wiggle: f64) -> String {
    const ROWS: [[f64; 2]; 4] = [[12.0, 3.0], [9.0, -4.0], [11.0, 1.5], [10.0, -2.5]];
    let weight = kg * 9.80665e-3;
    let one = |(i, [own, turn]): (usize, [f64; 2])| {
        let scatter = wiggle * (f64::from(u32::try_from(i).unwrap()) - 1.5);
        format!(",{:.4}", weight * (own + turn * x) + scatter)
    };
    ROWS.into_iter().enumerate().map(one).collect()
}

#[test]
fn payloads_of_known_mass_and_place_calibrate_and_then_every_lift_is_weighed() {
    let folder = scratch("calibrate-payload");
    let job = "units = \"m-kg-s\"\nreport_units = { force = \"kN\", moment = \"kN m\" }\n[[load]]\nname = \"payload\"\n\
               [[load]]\nname = \"payload.MY\"\nrole = \"wanted\"\n[payload]\nposition = \"free\"\nregion = [[-3.0, 3.0], [-1.0, 1.0]]\n\
               [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.2\n[runs]\nfile = \"runs.csv\"\n";
    let known = [
        (500.0, -1.0),
        (500.0, 1.0),
        (1000.0, 0.0),
        (1500.0, 0.5),
        (2000.0, -0.5),
        (800.0, 1.5),
    ];
    let unknown = [(1234.0, 0.3), (1800.0, -0.8)];
    let (mut runs, mut strain) = (
        "run,payload_mass,payload_x\n".to_owned(),
        "run,G1,G2,G3,G4\n".to_owned(),
    );
    for (i, (kg, x)) in known.iter().enumerate() {
        let _ = writeln!(runs, "W{i},{kg},{x}");
        let wiggle = if i % 2 == 0 { 0.1 } else { -0.1 };
        let _ = writeln!(strain, "W{i}{}", lift(*kg, *x, wiggle));
    }
    for (i, (kg, x)) in unknown.iter().enumerate() {
        let _ = writeln!(strain, "L{i}{}", lift(*kg, *x, 0.05));
    }
    let job = write_job(&folder, job, &runs, &strain);
    let (code, result, printed) = run("calibrate", &job, &folder.join("cal"));
    assert_eq!(code, Some(0), "{printed}");
    assert_eq!(result["calibration"]["runs"], 6);
    let calibrated = folder.join("cal/calibrated.toml");
    let (code, result, printed) = run("recover", &calibrated, &folder.join("loads"));
    assert_eq!(code, Some(0), "{printed}");
    for (i, (kg, x)) in unknown.iter().enumerate() {
        let weight = kg * 9.80665e-3;
        for (name, truth) in [("payload", weight), ("payload.MY", weight * x)] {
            let (value, sigma) = load(&result, &format!("L{i}"), name);
            assert!(
                (value - truth).abs() < 3.0 * sigma,
                "{name}: {value} +- {sigma}, {truth}"
            );
            assert!(sigma < 0.05 * weight, "{name}: {sigma}");
        }
    }
    let (code, result, printed) = run("payload", &calibrated, &folder.join("weighed"));
    assert_eq!(code, Some(0), "{printed}");
    for (i, (kg, _)) in unknown.iter().enumerate() {
        let all = result["payload"].as_array().unwrap();
        let one = all.iter().find(|p| p["run"] == format!("L{i}")).unwrap();
        let number = |key: &str| one[key].as_f64().unwrap();
        assert!(
            (number("mass") - kg).abs() < 4.0 * number("mass_sigma"),
            "{one}"
        );
        assert!(number("mass_sigma") < 0.05 * kg, "{one}");
    }
}

#[test]
fn weight_and_moment_of_a_payload_share_the_error_of_its_weight() {
    let folder = scratch("calibrate-payload-error");
    // The scale has an error of 5 % (1 sd) of 1000 kg, and the places are known. The place of the first run is wrong by
    // 0.2 m. If moments had independent errors of 60 kg m each, that would be three sd. The common error of the weight
    // cannot explain it.
    let job = "units = \"m-kg-s\"\nreport_units = { force = \"N\", moment = \"N m\" }\n[[load]]\nname = \"payload\"\n\
               [[load]]\nname = \"payload.MY\"\n[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.1\n[runs]\nfile = \"runs.csv\"\n";
    let (mut runs, mut strain) = (
        "run,payload_mass,payload_mass_sd,payload_x\n".to_owned(),
        "run,G1,G2,G3,G4\n".to_owned(),
    );
    for i in 0..17 {
        let x = if i % 2 == 0 { 1.0 } else { -1.0 };
        let stated = if i == 0 { 1.2 } else { x };
        let _ = writeln!(runs, "W{i},1000,50,{stated}");
        let wiggle = if i / 2 % 2 == 0 { 0.03 } else { -0.03 };
        let _ = writeln!(strain, "W{i}{}", lift(1000.0, x, wiggle));
    }
    let _ = writeln!(strain, "L0{}", lift(1000.0, 1.0, 0.0));
    let job = write_job(&folder, job, &runs, &strain);
    let (code, result, printed) = run("calibrate", &job, &folder.join("cal"));
    assert_eq!(code, Some(0), "{printed}");
    assert_eq!(
        result["calibration"]["refused"],
        serde_json::json!(["W0"]),
        "{printed}"
    );
    let calibrated = folder.join("cal/calibrated.toml");
    let (code, result, printed) = run("recover", &calibrated, &folder.join("loads"));
    assert_eq!(code, Some(0), "{printed}");
    // Eight runs are in the place of the payload. The error of both loads is 5 % over the root of eight.
    let shared = 1000.0 * 9.80665 * 0.05 / 8_f64.sqrt();
    for name in ["payload", "payload.MY"] {
        let (_, sigma) = load(&result, "L0", name);
        assert!((sigma / shared - 1.0).abs() < 0.1, "{name}: {sigma}");
    }
}

#[test]
fn a_combination_that_no_calibrated_job_could_recover_is_a_fault_of_calibrate_and_check_too() {
    let folder = scratch("calibrate-combination");
    let job = "units = \"m-kg-s\"\n[[load]]\nname = \"jack.FZ\"\n[[load]]\nname = \"jack.MY\"\n\
               [[combination]]\nname = \"both\"\nterms = { \"jack.FZ\" = 1, \"jack.MY\" = 1 }\n\
               [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\n[runs]\nfile = \"runs.csv\"\n";
    let runs = "run,jack.FZ,jack.MY\nA,10,0\nB,0,20\nC,30,10\n";
    let strain = "run,C1,C2\nA,10.1,20.2\nB,20.1,-40.3\nC,40.2,40.1\n";
    let job = write_job(&folder, job, runs, strain);
    for command in ["calibrate", "check"] {
        let (code, _, printed) = run(command, &job, &folder.join(command));
        assert_eq!(code, Some(2), "{command}: {printed}");
        assert!(
            printed.contains("combination.terms: `both` adds forces and moments"),
            "{command}: {printed}"
        );
    }
}

#[test]
fn a_payload_that_no_load_of_the_job_is_can_t_be_taken_for_the_others() {
    let folder = scratch("calibrate-payload-unnamed");
    let job = "units = \"m-kg-s\"\nreport_units = { force = \"kN\" }\n[[load]]\nname = \"jack\"\n\
               [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\n[runs]\nfile = \"runs.csv\"\n";
    let runs = "run,jack,payload_mass\nA,10,0\nB,20,500\nC,30,0\n";
    let strain = "run,C1,C2\nA,10.1,20.2\nB,20.1,40.3\nC,30.2,60.1\n";
    let job = write_job(&folder, job, runs, strain);
    let (code, _, printed) = run("calibrate", &job, &folder.join("out"));
    assert_eq!(code, Some(2), "{printed}");
    assert!(
        printed.contains("runs.csv:3") && printed.contains("payload_mass"),
        "{printed}"
    );
}

#[test]
fn a_sum_that_its_loads_do_not_make_is_a_fault_of_its_line_and_one_that_was_rounded_is_none() {
    const JOB: &str = "units = \"m-kg-s\"\nreport_units = { force = \"kN\" }\n[[load]]\nname = \"front\"\n[[load]]\nname = \"rear\"\n\
                       [[combination]]\nname = \"total\"\nterms = { front = 1, rear = 1 }\n\
                       [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\n\
                       [runs]\nfile = \"runs.csv\"\nunits = { force = \"kN\" }\n";
    const STRAIN: &str = "run,C1,C2\nA,10.1,20.2\nB,20.1,-40.3\nC,40.2,40.1\n";
    // Run B: the axle load is in another unit than the scale, then a slip, then values within their sd, then values
    // rounded to three digits.
    for (rows, wrong) in [
        ("A,10,0,,\nB,0,4.4966,20,\nC,20,10,,\n", Some("runs.csv:3")),
        ("A,10,0,,\nB,0,20,,\nC,20,10,3,\n", Some("runs.csv:4")),
        ("A,10,0,,\nB,0,20,21,0.5\nC,20,10,,\n", None),
        ("A,10,0,,\nB,0,20,20.1,\nC,20,10,30,\n", None),
    ] {
        let folder = scratch("calibrate-contradicting-sum");
        let runs = format!("run,front,rear,total,total_sd\n{rows}");
        let job = write_job(&folder, JOB, &runs, STRAIN);
        for command in ["calibrate", "check"] {
            let (code, _, printed) = run(command, &job, &folder.join(command));
            match wrong {
                Some(place) => {
                    assert_eq!(code, Some(2), "{command}: {printed}");
                    assert!(
                        printed.contains(place) && printed.contains("`total` is"),
                        "{printed}"
                    );
                }
                None => assert_ne!(code, Some(2), "{command}: {printed}"),
            }
        }
    }
}
