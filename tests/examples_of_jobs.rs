//! Runs the jobs in `examples/` and compares the results with the true values of their data (`examples/make_data.py`).

mod console;

use console::{assert_fits, assert_states_summary};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs a command on files of a folder of `examples/`, with exit code 0, and returns `result.json`.
fn run(command: &str, folder: &str, files: &[&str]) -> Value {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let out: PathBuf = Path::new(env!("CARGO_TARGET_TMPDIR")).join("examples");
    let out = out.join(format!("{command}-{}", files[0].replace('.', "-")));
    let _ = std::fs::remove_dir_all(&out);
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .arg(command)
        .args(files)
        .arg("--out")
        .arg(&out)
        .current_dir(examples.join(folder))
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(0), "{command} {files:?}\n{error}");
    assert_fits(&done, command);
    assert_states_summary(&done, &out, command);
    serde_json::from_str(&std::fs::read_to_string(out.join("result.json")).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Returns the entries of a list whose `key` has the value `name`.
fn find_entries<'a>(list: &'a Value, key: &str, name: &str) -> Vec<&'a Value> {
    let all = list.as_array().unwrap().iter();
    all.filter(|e| e[key] == name).collect()
}

/// True mass (kg) and place (m) of the payload in each run.
const PAYLOADS: [(f64, f64, f64); 9] = [
    (300.0, 2.0, 0.0),
    (600.0, 2.0, 0.1),
    (900.0, 2.1, -0.1),
    (1200.0, 1.9, 0.0),
    (500.0, 2.3, 0.15),
    (800.0, 1.7, -0.15),
    (1000.0, 2.0, 0.05),
    (700.0, 2.2, 0.0),
    (1100.0, 1.8, 0.1),
];

#[test]
fn the_carrier_s_unit_loads_are_in_balance_and_its_gauges_distinguished() {
    let solved = run("solve", "frame", &["place.toml"]);
    assert!(!solved["balance"].as_array().unwrap().is_empty());
    for case in solved["balance"].as_array().unwrap() {
        assert!(number(&case["residual"]) < 1e-9, "{case}");
    }
    // Steel of 7.85e-9 t/mm3: plates of 6 mm (rails, 2 x 4 m of 200 and twice 60 mm) and of 8 mm (five of 800 by 200
    // mm).
    let mass = 7.85e-9 * (2.0 * 4000.0 * 320.0 * 6.0 + 5.0 * 800.0 * 200.0 * 8.0);
    assert!((number(&solved["mass"]["mass"]) / mass - 1.0).abs() < 1e-9);
    assert_eq!(
        run("cases", "frame", &["place.toml"])["subcases"]
            .as_array()
            .unwrap()
            .len(),
        6
    );
    let placed = run("place", "frame", &["place.toml"]);
    assert_eq!(placed["gauges"].as_array().unwrap().len(), 12);
    assert_eq!(run("sensitivity", "frame", &["recover.toml"])["rank"], 6);
    assert!(number(&run("modes", "frame", &["place.toml"])["modes"][0]["hz"]) > 0.0);
}

#[test]
fn recovered_wheel_forces_hold_those_of_statics() {
    let recovered = run("recover", "frame", &["recover.toml"]);
    let (mut held, mut of) = (0, 0);
    for (i, (mass, x, y)) in PAYLOADS.iter().enumerate() {
        let w = mass * 9.80665 / 1000.0;
        // Three wheels at (0, 0), (3.5, -.4) and (3.5, .4), by the lever rule.
        let rear = w * x / 3.5;
        let truth = [
            ("N.FZ", w - rear),
            ("L.FZ", rear / 2.0 - w * y / 0.8),
            ("R.FZ", rear / 2.0 + w * y / 0.8),
        ];
        for (name, force) in truth {
            let run = format!("R{:02}", i + 1);
            let load = find_entries(&recovered["loads"], "run", &run)
                .into_iter()
                .find(|l| l["name"] == name)
                .unwrap();
            of += 1;
            held += i32::from((number(&load["low"])..=number(&load["high"])).contains(&force));
        }
    }
    assert!(held * 10 >= of * 8, "{held} of {of}");
}

#[test]
fn the_payload_is_weighed_and_found() {
    let weighed = run("payload", "frame", &["payload.toml"]);
    assert_eq!(weighed["payload"].as_array().unwrap().len(), PAYLOADS.len());
    for (answer, (mass, x, y)) in weighed["payload"].as_array().unwrap().iter().zip(PAYLOADS) {
        // Four standard deviations for 27 answers.
        let off = (number(&answer["mass"]) - mass) / number(&answer["mass_sigma"]);
        assert!(off.abs() < 4.0, "{answer}");
        for (k, at) in [x, y].into_iter().enumerate() {
            let off = (number(&answer["position"][k]) - at) / number(&answer["position_sigma"][k]);
            assert!(off.abs() < 4.0, "{answer}");
        }
    }
}

#[test]
fn the_gearbox_that_the_model_lacks_is_found() {
    let found = run("ballast", "frame", &["ballast.toml"]);
    let mass = &found["masses"][0];
    assert!((number(&mass["mass"]) - 250.0).abs() < 0.5, "{mass}");
    for (k, at) in [(0, 3.0), (1, 0.1)] {
        assert!((number(&mass["position"][k]) - at).abs() < 0.005, "{mass}");
    }
}

#[test]
fn stress_and_study_answer_for_the_same_runs() {
    let hot = run("respond", "frame", &["respond.toml"]);
    assert_eq!(hot["states"], 9);
    // The prediction of the strain of the gauges is accurate within their noise.
    assert!(!hot["gauges"].as_array().unwrap().is_empty());
    for g in hot["gauges"].as_array().unwrap() {
        assert!(number(&g["residual_rms_microstrain"]) < 1.5, "{g}");
    }
    let study = run("study", "frame", &["study.toml"]);
    let noise = find_entries(&study["study"], "error", "absolute-normal 1");
    // More gauges of the same layout never increase the error.
    assert_eq!(noise.len(), 2);
    assert!(number(&noise[1]["mean_relative_rms"]) <= number(&noise[0]["mean_relative_rms"]));
}

#[test]
fn reconcile_names_what_was_hidden_on_all_three_paths() {
    for job in ["reconcile.toml", "reconcile_matrix.toml"] {
        let found = run("reconcile", "frame", &[job]);
        assert_eq!(
            found["named"],
            serde_json::json!(["sign_flip:P05"]),
            "{job}"
        );
        assert!(number(&found["gap"]["after"]) < 0.1 * number(&found["gap"]["before"]));
    }
    let found = run("reconcile", "quarter_truck", &["reconcile.toml"]);
    assert_eq!(
        found["named"].as_array().unwrap().len(),
        1,
        "{}",
        found["named"]
    );
    assert!(
        found["named"][0]
            .as_str()
            .unwrap()
            .starts_with("cubic_stiffness")
    );
    // The true value is 2e8 N/m3.
    assert!((number(&found["effects"][0]["size"]) / 2.0e8 - 1.0).abs() < 0.02);
}

#[test]
fn the_quarter_truck_is_identified() {
    let found = run("identify", "quarter_truck", &["identify.toml"]);
    for (name, truth) in [
        ("m_b", 3000.0),
        ("m_f", 600.0),
        ("k_s", 4.0e5),
        ("c_s", 1.1e4),
    ] {
        let p = find_entries(&found["parameters"], "name", name)[0];
        let off = (number(&p["value"]) - truth) / number(&p["sigma"]);
        assert!(off.abs() < 3.5, "{p}");
    }
}

#[test]
fn a_fifth_more_load_is_a_fifth_more_to_the_power_of_the_slope() {
    let files = [
        "fleet.toml",
        "A_2026-05-01.csv",
        "A_2026-05-02.csv",
        "B_2026-05-01.csv",
        "B_2026-05-02.csv",
    ];
    let found = run("fleet", "fleet", &files);
    let damage = |vehicle: &str, load: &str| {
        let v = find_entries(&found["vehicles"], "name", vehicle)[0];
        number(&find_entries(&v["loads"], "load", load)[0]["damage"])
    };
    // N.FZ oscillates between -2 and 2 kN, or with a fifth more. Noise of .05 microstrain changes a range by less than
    // 1 % and damage by less than 5 %.
    let ratio = damage("B", "N.FZ") / damage("A", "N.FZ");
    assert!((ratio / 1.2_f64.powi(5) - 1.0).abs() < 0.05, "{ratio}");
}

#[test]
fn calibrations_hold_the_runs_left_out() {
    for folder in ["bridge", "onboard"] {
        let found = run("calibrate", folder, &["calibrate.toml"]);
        let coverage = &found["calibration"]["coverage"];
        assert!(
            number(&coverage["held"]) >= 0.8 * number(&coverage["of"]),
            "{coverage}"
        );
    }
}

#[test]
fn masses_springs_and_dampers_of_the_oscillator_and_the_rig_lie_in_their_intervals() {
    let oscillator = [("m_b", 2.0), ("k_s", 8000.0), ("c_s", 15.0)];
    let rig = [
        ("m_1", 60.0),
        ("m_2", 400.0),
        ("k_1", 9.0e4),
        ("c_1", 700.0),
        ("k_2", 6.0e5),
        ("c_2", 4000.0),
    ];
    for (job, truth) in [("oscillator.toml", &oscillator[..]), ("rig.toml", &rig[..])] {
        let found = run("identify", "rig", &[job]);
        for (name, value) in truth {
            let p = find_entries(&found["parameters"], "name", name)[0];
            // 95 % intervals of nine parameters. One may miss the true value by chance, but none by twice its width.
            let away = (number(&p["value"]) - value).abs();
            assert!(away < 2.0 * 1.96 * number(&p["sigma"]), "{job}: {p}");
            assert!(number(&p["sigma"]) < 1e-3 * value, "{job}: {p}");
        }
    }
}

/// Returns the names of the loads of a large job.
fn many_loads() -> Vec<String> {
    (1..40).map(|l| format!("W{l:02}.FZ")).collect()
}

/// Writes a job with 40 gauges, 39 loads and a number of runs. Strain comes from known loads with a noise of half a
/// microstrain.
fn write_large_job(folder: &Path, runs: usize) {
    let _ = std::fs::remove_dir_all(folder);
    std::fs::create_dir_all(folder).unwrap();
    let loads = many_loads();
    let mut state = 7u64;
    let mut random = || {
        // Linear congruential generator of Numerical Recipes, -1 to 1.
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223) % (1 << 32);
        state as f64 / f64::from(1u32 << 31) - 1.0
    };
    // Each gauge reads mainly one load.
    let mut entry = |g: usize, l: usize| random() + if g == l { 20.0 } else { 0.0 };
    let s: Vec<Vec<f64>> = (0..40)
        .map(|g| (0..39).map(|l| entry(g, l)).collect())
        .collect();
    let cells = |row: &[f64]| {
        row.iter()
            .map(|v| format!("{v:.6}"))
            .collect::<Vec<_>>()
            .join(",")
    };
    let mut text = format!("gauge,{}\n", loads.join(","));
    for (g, row) in s.iter().enumerate() {
        text += &format!("G{g:02},{}\n", cells(row));
    }
    std::fs::write(folder.join("s.csv"), text).unwrap();
    let gauges: Vec<String> = (0..40).map(|g| format!("G{g:02}")).collect();
    let mut text = format!("run,{}\n", gauges.join(","));
    for r in 0..runs {
        let force = |l: usize| 20.0 + ((r * 7 + l * 3) % 11) as f64;
        let reading = |row: &Vec<f64>| {
            let strain = row.iter().enumerate().map(|(l, s)| s * force(l));
            strain.sum::<f64>() + 0.5 * random()
        };
        let row: Vec<f64> = s.iter().map(reading).collect();
        text += &format!("R{:02},{}\n", r + 1, cells(&row));
    }
    std::fs::write(folder.join("strain.csv"), text).unwrap();
    let mut job = String::from(
        "title = \"Many wheels\"\nunits = \"m-kg-s\"\nreport_units = { force = \"kN\", moment = \"kN m\" }\n\
         [sensitivity]\nfile = \"s.csv\"\nper = { force = \"kN\" }\n\
         [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\n\
         [study]\nlayouts = [\"given\"]\ngauges = [40]\nerrors = [{ kind = \"absolute-normal\", size = 1.0 }]\ntrials = 20\nseed = 1\n",
    );
    for l in &loads {
        job += &format!("[[load]]\nname = \"{l}\"\nexpected = 25000.0\n");
    }
    std::fs::write(folder.join("job.toml"), job).unwrap();
}

/// Runs a command on the large job in a locale.
fn on_large_job(command: &str, folder: &Path, locale: &str) -> std::process::Output {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args([command, "job.toml", "--out", command])
        .env("LC_ALL", locale)
        .current_dir(folder)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.code() < Some(2), "{command}\n{error}");
    done
}

#[test]
fn the_console_names_each_of_39_loads_with_its_interval_in_25_lines() {
    for (runs, plus_minus, locale) in [(1, "±", "C.UTF-8"), (60, "+-", "C")] {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("many-loads-{runs}"));
        write_large_job(&folder, runs);
        for command in ["check", "sensitivity", "recover", "study"] {
            let done = on_large_job(command, &folder, locale);
            assert_fits(&done, command);
            assert_states_summary(&done, &folder.join(command), command);
            let printed = String::from_utf8_lossy(&done.stdout);
            assert_eq!(
                printed.is_ascii(),
                locale == "C" || !printed.contains('±'),
                "{printed}"
            );
            if command == "check" {
                continue;
            }
            for load in many_loads() {
                let after = printed.split_once(&load).map(|s| s.1);
                let after = after.unwrap_or_else(|| panic!("{command} {load}\n{printed}"));
                // The text until the next load of the line.
                let own = after.lines().next().unwrap().split('W').next().unwrap();
                let has_interval = own.contains(plus_minus);
                assert!(
                    has_interval || command == "sensitivity",
                    "{load}: {own}\n{printed}"
                );
            }
        }
    }
}
