//! `recover` for a job with a given S: sums of loads, corrected channels, records with a dead channel, and impossible
//! input.
//!
//! There are two loads A and B and four gauges. The tests compute strain from S, so every expected load is known.

mod calibrated;
mod compared;
mod conditioned;
#[path = "../drawn/mod.rs"]
mod drawn;
mod dynamic;
mod end_to_end;
mod files;
mod in_fleet;
mod kinds;
mod misled;
mod mistakes;
mod noise;
mod other_results;
mod payload;
mod readings;
mod supported;
mod tables;
mod validation;
mod wrong_inputs;

use serde_json::Value;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;

/// S in microstrain per N, by gauge.
const S: [[f64; 2]; 4] = [[1.0, 0.2], [-0.3, 1.1], [0.8, -0.5], [0.4, 0.9]];

fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("recovering")
        .join(name);
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

/// Returns the readings of the four gauges at these loads, microstrain.
fn strain(a: f64, b: f64) -> [f64; 4] {
    S.map(|row| row[0] * a + row[1] * b)
}

/// Returns the loads of row `i`: hundreds of N that change from row to row.
fn loads(i: usize) -> [f64; 2] {
    let t = i as f64 * 0.37;
    [300.0 + 100.0 * t.sin(), 200.0 * (0.7 * t).cos()]
}

/// Returns a table of `rows` rows with `key` as its first column. `change` formats a reading.
fn table(key: &str, rows: usize, change: impl Fn(usize, usize, f64) -> String) -> String {
    let mut text = format!("{key},G1,G2,G3,G4\n");
    for i in 0..rows {
        let [a, b] = loads(i);
        // A record at 100 Hz, or runs with names.
        let _ = match key {
            "time" => write!(text, "{}", i as f64 * 0.01),
            _ => write!(text, "R{i}"),
        };
        for (g, v) in strain(a, b).into_iter().enumerate() {
            // The noise repeats every seven rows and is half a microstrain at most.
            let noise = ((i * 5 + g * 3) % 7) as f64 / 7.0 - 0.43;
            let _ = write!(text, ",{}", change(i, g, v + noise));
        }
        text.push('\n');
    }
    text
}

fn as_is(_: usize, _: usize, v: f64) -> String {
    v.to_string()
}

/// Runs `recover` on this table, with further lines in the job. Returns exit code, standard error, `result.json` and
/// folder.
fn recover(name: &str, strain: &str, more: &str) -> (i32, String, Value, PathBuf) {
    let dir = folder(name);
    let mut s = "gauge,A,B\n".to_owned();
    for (g, row) in S.iter().enumerate() {
        let _ = writeln!(s, "G{},{},{}", g + 1, row[0], row[1]);
    }
    std::fs::write(dir.join("S.csv"), s).unwrap();
    std::fs::write(dir.join("strain.csv"), strain).unwrap();
    let job = format!(
        "units = \"m-kg-s\"\n[sensitivity]\nfile = \"S.csv\"\nper = {{ force = \"N\" }}\n\
         [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.3\n{more}"
    );
    std::fs::write(dir.join("job.toml"), job).unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["recover", &dir.join("job.toml").display().to_string()])
        .output()
        .unwrap();
    let result = std::fs::read(dir.join("job.out/result.json"))
        .ok()
        .and_then(|b| serde_json::from_slice(&b).ok())
        .unwrap_or(Value::Null);
    (
        out.status.code().unwrap_or(-1),
        String::from_utf8_lossy(&out.stderr).into_owned(),
        result,
        dir,
    )
}

/// Returns value and sigma of a load in a run.
fn load(result: &Value, run: &str, name: &str) -> [f64; 2] {
    let list = result["loads"].as_array().unwrap();
    let row = list
        .iter()
        .find(|l| l["run"] == run && l["name"] == name)
        .unwrap_or_else(|| panic!("{run} {name}"));
    [&row["value"], &row["sigma"]].map(|v| v.as_f64().unwrap())
}

fn codes(result: &Value) -> Vec<String> {
    let list = result["findings"].as_array().unwrap();
    list.iter()
        .map(|f| f["code"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn a_sum_of_loads_has_the_interval_of_their_covariance() {
    let more = "[[load]]\nname = \"A\"\n[[load]]\nname = \"B\"\n\
                [[combination]]\nname = \"total\"\nterms = { A = 1, B = 1 }\n\
                [[combination]]\nname = \"difference\"\nterms = { A = 1, B = -1 }\n";
    let (code, errors, result, dir) = recover("sum", &table("run", 12, as_is), more);
    assert_eq!(code, 0, "{errors}");
    let [a, b, sum, difference] = ["A", "B", "total", "difference"].map(|n| load(&result, "R3", n));
    assert!((sum[0] - a[0] - b[0]).abs() < 1e-9 * sum[0].abs());
    assert!((difference[0] - a[0] + b[0]).abs() < 1e-9 * a[0].abs());
    // var(A + B) + var(A - B) = 2 var A + 2 var B for any covariance. Here the covariance is not zero.
    let square = |v: [f64; 2]| v[1] * v[1];
    let both = 2.0 * (square(a) + square(b));
    assert!((square(sum) + square(difference) - both).abs() < 1e-9 * both);
    assert!((square(sum) - square(difference)).abs() > 1e-3 * both);
    let csv = std::fs::read_to_string(dir.join("job.out/loads.csv")).unwrap();
    assert!(
        csv.starts_with("run,A,A.low,A.high,B,B.low,B.high,total,total.low"),
        "{csv}"
    );
    // The same rows as a record give the same sums and intervals, within the digits of the table.
    let (code, errors, _, dir) = recover("sum_record", &table("time", 12, as_is), more);
    assert_eq!(code, 0, "{errors}");
    let record = std::fs::read_to_string(dir.join("job.out/loads.csv")).unwrap();
    let numbers = |text: &str, row: usize| -> Vec<f64> {
        let line = text.lines().nth(row + 1).unwrap();
        line.split(',')
            .skip(1)
            .map(|v| v.parse().unwrap())
            .collect()
    };
    let [runs, samples] = [numbers(&csv, 3), numbers(&record, 3)];
    assert!(!runs.is_empty() && runs.len() == samples.len());
    for (x, y) in runs.iter().zip(&samples) {
        assert!((x - y).abs() < 1e-5 * x.abs().max(1.0), "{x} {y}");
    }
}

#[test]
fn channels_are_put_right_in_runs_and_in_records() {
    // G1 has reversed polarity, G2 and G3 are exchanged, and G4 has the factor 0.7 and an offset of 20 microstrain.
    let wrong = |_: usize, g: usize, v: f64| match g {
        0 => (-v).to_string(),
        3 => (0.7 * v + 20.0).to_string(),
        _ => v.to_string(),
    };
    let more = "[[correction]]\ngauge = \"G1\"\nsign = -1\n\
                [[correction]]\ngauge = \"G2\"\nexchanged_with = \"G3\"\n\
                [[correction]]\ngauge = \"G4\"\ngain = 0.7\noffset_microstrain = 20\n";
    for key in ["run", "time"] {
        let right = recover("right", &table(key, 30, as_is), "").3;
        let exchanged = table(key, 30, wrong).replacen("G1,G2,G3,G4", "G1,G3,G2,G4", 1);
        let (code, errors, _, dir) = recover("put_right", &exchanged, more);
        assert_eq!(code, 0, "{errors}");
        let read = |dir: &PathBuf| std::fs::read_to_string(dir.join("job.out/loads.csv")).unwrap();
        let numbers = |text: &str| -> Vec<f64> {
            let fields = text.lines().skip(1).flat_map(|l| l.split(',').skip(1));
            fields.map(|v| v.parse().unwrap()).collect()
        };
        let [right, put_right] = [&right, &dir].map(|d| numbers(&read(d)));
        assert!(!right.is_empty() && right.len() == put_right.len());
        for (x, y) in right.iter().zip(&put_right) {
            assert!((x - y).abs() < 1e-4 * x.abs().max(1.0), "{key}: {x} {y}");
        }
    }
}

#[test]
fn a_gauge_that_is_ignored_or_gives_nothing_leaves_the_others_at_work() {
    let blank = |_: usize, g: usize, v: f64| match g {
        2 => String::new(),
        _ => v.to_string(),
    };
    for key in ["run", "time"] {
        let (code, errors, dead, _) = recover("dead", &table(key, 300, blank), "");
        assert_eq!(code, 0, "{errors}");
        let ignored = "[[correction]]\ngauge = \"G3\"\nignore = true\n";
        let (code, errors, left_out, _) = recover("ignored", &table(key, 300, as_is), ignored);
        assert_eq!(code, 0, "{errors}");
        let (_, _, whole, _) = recover("whole", &table(key, 300, as_is), "");
        let run = if key == "run" { "R7" } else { "strain.csv" };
        for name in ["A", "B"] {
            let [value, sigma] = load(&dead, run, name);
            assert!((value - load(&left_out, run, name)[0]).abs() < 1e-6 * value.abs().max(1.0));
            assert!(sigma.is_finite() && value.is_finite());
            assert!(load(&left_out, run, name)[1] > load(&whole, run, name)[1]);
        }
    }
}

#[test]
fn every_result_of_a_record_states_rate_duration_and_gaps() {
    let gap = |i: usize, g: usize, v: f64| match (i, g) {
        (40..=59, 1) => String::new(),
        _ => v.to_string(),
    };
    let (code, errors, result, dir) = recover("rate", &table("time", 501, gap), "");
    assert_eq!(code, 0, "{errors}");
    let number = |key: &str| result[key].as_f64().unwrap();
    assert!((number("sample_rate_hz") - 100.0).abs() < 1e-6);
    assert!((number("duration_s") - 5.0).abs() < 1e-9);
    assert_eq!((number("samples"), number("gaps")), (501.0, 20.0));
    // Three gauges remain for two loads, so no sample is blank.
    let csv = std::fs::read_to_string(dir.join("job.out/loads.csv")).unwrap();
    assert!(!csv.contains(",,"), "blank loads");
}

#[test]
fn readings_and_times_in_another_unit_are_asked_for() {
    let strain = |_: usize, _: usize, v: f64| format!("{:e}", v * 1e-6);
    for key in ["run", "time"] {
        let (code, _, result, _) = recover("unit", &table(key, 300, strain), "");
        assert_eq!(code, 1);
        assert!(
            codes(&result).contains(&"readings-below-noise".to_owned()),
            "{result}"
        );
    }
    // 1 kHz in milliseconds. The loads change within a second.
    let mut text = "time,G1,G2,G3,G4\n".to_owned();
    for i in 0..2000 {
        let t = f64::from(i) * 1e-3;
        let v = self::strain(300.0 * t.sin(), 200.0 * (1.3 * t).cos());
        let _ = writeln!(text, "{i},{},{},{},{}", v[0], v[1], v[2], v[3]);
    }
    let (code, errors, result, _) = recover("ms", &text, "");
    assert_eq!(code, 1, "{errors}");
    assert!(codes(&result).contains(&"time-unit-doubtful".to_owned()));
    let (_, _, result, _) = recover("ms_stated", &text, "time_unit = \"ms\"\n");
    assert!(!codes(&result).contains(&"time-unit-doubtful".to_owned()));
    let rate = result["sample_rate_hz"].as_f64().unwrap();
    assert!((rate - 1000.0).abs() < 1e-6, "{rate}");
}

#[test]
fn a_reading_of_1e308_is_no_reading_and_a_header_alone_is_a_fault() {
    let huge = |i: usize, g: usize, v: f64| match (i, g) {
        (5, 1) => "1e308".to_owned(),
        _ => v.to_string(),
    };
    for key in ["run", "time"] {
        let (code, _, result, _) = recover("huge", &table(key, 30, huge), "");
        assert_eq!(code, 1);
        assert!(
            codes(&result).contains(&"reading-impossible".to_owned()),
            "{result}"
        );
        let (code, errors, _, _) = recover("no_rows", &table(key, 0, as_is), "");
        assert_eq!(code, 2, "{errors}");
    }
}

#[test]
fn a_load_at_a_grid_that_the_deck_lacks_is_a_fault_with_results_too() {
    let dir = folder("missing_grid");
    // A free strip of ten plates, each 20 mm long.
    let mut deck = "SOL 101\nCEND\nBEGIN BULK\n".to_owned();
    for i in 0..11 {
        for j in 0..2 {
            let _ = writeln!(deck, "GRID,{},,{}.,{}.,0.", 1 + i + 100 * j, 20 * i, 20 * j);
        }
    }
    for i in 1..11 {
        let _ = writeln!(deck, "CQUAD4,{i},1,{i},{},{},{}", i + 1, i + 101, i + 100);
    }
    deck += "PSHELL,1,1,2.,1,,1\nMAT1,1,210000.,,.3,7.85-9\nENDDATA\n";
    std::fs::write(dir.join("strip.bdf"), deck).unwrap();
    std::fs::write(dir.join("strain.csv"), "run,a,b\nR1,1,2\n").unwrap();
    let job = |name: &str, grid: u32, results: &str| {
        let mut text = format!(
            "units = \"mm-t-s\"\n[model]\ndeck = \"strip.bdf\"\nmesh_error = false\n{results}\n"
        );
        for (load, grid) in [("left", 1), ("middle", grid)] {
            let _ = writeln!(
                text,
                "[[load]]\nname = \"{load}\"\ngrid = {grid}\ncomponent = \"FZ\"\nexpected = 10.0"
            );
        }
        for (gauge, element) in [("a", 3), ("b", 7)] {
            let _ = writeln!(
                text,
                "[[gauge]]\nname = \"{gauge}\"\nelement = {element}\nsurface = \"top\"\ndirection = [1, 0, 0]"
            );
        }
        text += "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\n";
        std::fs::write(dir.join(name), text).unwrap();
        dir.join(name).display().to_string()
    };
    let run = |command: &str, job: &str| {
        let out = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .args([command, job])
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&out.stderr).into_owned();
        (out.status.code().unwrap_or(-1), errors)
    };
    let (code, errors) = run("solve", &job("solved.toml", 6, ""));
    assert_eq!(code, 0, "{errors}");
    let results = "results = [\"solved.out/results.op2\"]";
    let (code, errors) = run("recover", &job("there.toml", 6, results));
    assert!(code != 2, "{errors}");
    // Line 11 of the job is the second [[load]].
    for (name, results) in [("with.toml", results), ("without.toml", "")] {
        let lacking = job(name, 999, results);
        for command in ["recover", "sensitivity", "place", "respond"] {
            let (code, errors) = run(command, &lacking);
            assert_eq!(code, 2, "{command}: {errors}");
            assert!(
                errors.contains(&format!(
                    "{name}:11: load.grid: load `middle`: the deck has no grid 999"
                )) && errors.contains("correct the id, or name another deck"),
                "{command}: {errors}"
            );
        }
        assert!(!dir.join(name).with_extension("out").exists());
    }
}

/// Rows without load.
const EMPTY: [usize; 4] = [0, 4, 9, 13];

/// Returns strain of runs, some of them without load. The zeros of the gauges move by up to 6 microstrain from row to
/// row.
fn drifting_strain_table() -> String {
    table("run", 14, |i, g, v| {
        let [a, b] = loads(i);
        let acts = if EMPTY.contains(&i) {
            0.0
        } else {
            strain(a, b)[g]
        };
        // Only the noise that `table` adds remains.
        let noise = v - strain(a, b)[g];
        let zero = 40.0 - 6.0 * (g as f64 - 1.0) * i as f64;
        (acts + noise + zero).to_string()
    })
}

#[test]
fn a_zero_that_drifts_is_followed_through_runs_without_load() {
    let names = EMPTY.map(|i| format!("\"R{i}\"")).join(", ");
    let more = format!("zero_runs = [{names}]\n");
    let (code, printed, result, _) = recover("zero-runs", &drifting_strain_table(), &more);
    assert_eq!(code, 0, "{printed}");
    let of = |run: usize, name: &str| {
        let all = result["loads"].as_array().unwrap();
        let found = all
            .iter()
            .find(|l| l["run"] == format!("R{run}") && l["name"] == name)
            .unwrap();
        let at = |key: &str| found[key].as_f64().unwrap();
        (at("value"), at("sigma"))
    };
    // Errors are half a microstrain of noise in each reading and in the zero, with about one microstrain per N. The
    // drift itself would give 100 N.
    for run in 0..14 {
        let [a, b] = if EMPTY.contains(&run) {
            [0.0, 0.0]
        } else {
            loads(run)
        };
        for (name, truth) in [("A", a), ("B", b)] {
            let (value, sigma) = of(run, name);
            // The first and the last run without load have a neighbour on one side only. That neighbour differs by one
            // step of the drift.
            let near = (value - truth).abs() < 2.0 || [0, 13].contains(&run);
            assert!(near, "R{run} {name}: {value}, truth {truth}");
            assert!(
                (value - truth).abs() < 4.0 * sigma,
                "R{run} {name}: {value} +- {sigma}"
            );
        }
    }
    let codes = result["findings"].as_array().unwrap();
    assert!(codes.iter().any(|f| f["code"] == "zero-interpolated"));
    let (code, printed, _, _) = recover(
        "zero-runs-none",
        &drifting_strain_table(),
        "zero_runs = [\"R99\"]\n",
    );
    assert_eq!(code, 2);
    assert!(
        printed.contains("measured.zero_runs: `strain.csv` has no run `R99`"),
        "{printed}"
    );
    let record = table("time", 200, as_is);
    let (code, printed, _, _) = recover("zero-runs-record", &record, "zero_runs = [\"R0\"]\n");
    assert_eq!(code, 2);
    assert!(printed.contains("is a record and has no runs"), "{printed}");
}

/// Compares the results of `reconcile` for equal runs, with and without 300 microstrain at every gauge that the zero
/// file removes.
#[test]
fn a_zero_file_counts_in_reconcile_as_in_recover() {
    let mut runs = "run,A,B\n".to_owned();
    for i in 0..12 {
        let [a, b] = loads(i);
        let _ = writeln!(runs, "R{i},{a},{b}");
    }
    let more = "hold_out = [\"R9\", \"R10\", \"R11\"]\n[runs]\nfile = \"runs.csv\"\nunits = { force = \"N\" }\nnoise = { force = 0.5 }\n";
    let answer = |name: &str, offset: f64, zero: &str| {
        let shifted = table("run", 12, |_, g, v| {
            (v + offset * (1.0 + g as f64)).to_string()
        });
        let (_, _, _, dir) = recover(name, &shifted, &format!("{zero}{more}"));
        std::fs::write(dir.join("runs.csv"), &runs).unwrap();
        std::fs::write(
            dir.join("zero.csv"),
            "run,G1,G2,G3,G4\nZ,300,600,900,1200\n",
        )
        .unwrap();
        let out = dir.join("reconciled");
        let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .arg("reconcile")
            .arg(dir.join("job.toml"))
            .arg("--out")
            .arg(&out)
            .output()
            .unwrap();
        let printed = String::from_utf8_lossy(&done.stderr).into_owned();
        let text = std::fs::read(out.join("result.json")).unwrap_or_else(|_| panic!("{printed}"));
        serde_json::from_slice::<Value>(&text).unwrap()
    };
    let plain = answer("zero-plain", 0.0, "");
    let taken = answer("zero-taken", 300.0, "zero = \"zero.csv\"\n");
    assert_eq!(plain["verdict"], "none");
    assert_eq!(taken["verdict"], "none");
    let gap = |r: &Value| r["gap"]["before"].as_f64().unwrap();
    assert!((gap(&plain) / gap(&taken) - 1.0).abs() < 1e-9);
}
