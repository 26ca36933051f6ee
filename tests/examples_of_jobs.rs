//! The jobs in `examples/`: each runs, and comes to what its data were made of (`examples/make_data.py`).

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs a command on files of a folder of `examples/`; exit code 0; `result.json`.
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
    serde_json::from_str(&std::fs::read_to_string(out.join("result.json")).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The entries of a list, by a key.
fn by<'a>(list: &'a Value, key: &str, name: &str) -> Vec<&'a Value> {
    let all = list.as_array().unwrap().iter();
    all.filter(|e| e[key] == name).collect()
}

/// Mass (kg) and place (m) of the payload of the runs, as they were made.
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
fn the_carrier_s_unit_loads_are_in_balance_and_its_gauges_told_apart() {
    let solved = run("solve", "frame", &["place.toml"]);
    for case in solved["balance"].as_array().unwrap() {
        assert!(number(&case["residual"]) < 1e-9, "{case}");
    }
    // Steel of 7.85e-9 t/mm3: plates of 6 mm (rails, 2 x 4 m of 200 and twice 60 mm) and 8 mm (five of 800 by 200 mm).
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
        // Three wheels, at (0, 0) and (3.5, -.4), (3.5, .4): the lever rule.
        let rear = w * x / 3.5;
        let truth = [
            ("N.FZ", w - rear),
            ("L.FZ", rear / 2.0 - w * y / 0.8),
            ("R.FZ", rear / 2.0 + w * y / 0.8),
        ];
        for (name, force) in truth {
            let run = format!("R{:02}", i + 1);
            let load = by(&recovered["loads"], "run", &run)
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
    for (answer, (mass, x, y)) in weighed["payload"].as_array().unwrap().iter().zip(PAYLOADS) {
        // Four standard deviations of 27 answers.
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
    // The gauges' own strain is predicted to the noise that was put on it.
    for g in hot["gauges"].as_array().unwrap() {
        assert!(number(&g["residual_rms_microstrain"]) < 1.5, "{g}");
    }
    let study = run("study", "frame", &["study.toml"]);
    let noise = by(&study["study"], "error", "absolute-normal 1");
    // More gauges of the same layout never do worse.
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
    // Made with 2e8 N/m3.
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
        let p = by(&found["parameters"], "name", name)[0];
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
        let v = by(&found["vehicles"], "name", vehicle)[0];
        number(&by(&v["loads"], "load", load)[0]["damage"])
    };
    // N.FZ swings between -2 and 2 kN, or a fifth more: noise of .05 microstrain moves a range by less than 1 %, damage by less than 5 %.
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
            let p = by(&found["parameters"], "name", name)[0];
            // 95 % intervals of nine parameters: one may be missed by chance, and none by twice its width.
            let away = (number(&p["value"]) - value).abs();
            assert!(away < 2.0 * 1.96 * number(&p["sigma"]), "{job}: {p}");
            assert!(number(&p["sigma"]) < 1e-3 * value, "{job}: {p}");
        }
    }
}

/// A copy of a folder of `examples/`.
fn copy_of(folder: &str, name: &str) -> PathBuf {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let to = Path::new(env!("CARGO_TARGET_TMPDIR")).join("copies");
    let (from, to) = (from.join(folder), to.join(name));
    let _ = std::fs::remove_dir_all(&to);
    std::fs::create_dir_all(&to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
        }
    }
    to
}

/// Exit code and standard error of a call in a folder.
fn call(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .arg("--no-cache")
        .current_dir(folder)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&done.stderr).into_owned();
    (done.status.code().unwrap_or(-1), error)
}

/// Puts one text for another in a file.
fn edit(file: &Path, from: &str, to: &str) {
    let text = std::fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "{from} in {text}");
    std::fs::write(file, text.replace(from, to)).unwrap();
}

#[test]
fn no_output_is_written_over_what_the_command_has_read() {
    let dir = copy_of("fleet", "own_inputs");
    let job = dir.join("fleet.toml");
    std::fs::rename(dir.join("s_wheels.csv"), dir.join("sensitivity.csv")).unwrap();
    std::fs::rename(dir.join("A_2026-05-01.csv"), dir.join("loads.csv")).unwrap();
    edit(&job, "s_wheels.csv", "sensitivity.csv");
    edit(&job, "A_2026-05-01.csv", "loads.csv");
    for (command, name) in [("sensitivity", "sensitivity.csv"), ("recover", "loads.csv")] {
        let before = std::fs::read(dir.join(name)).unwrap();
        let count = || std::fs::read_dir(&dir).unwrap().count();
        let files = count();
        for out in [".", "../own_inputs"] {
            let (code, said) = call(&dir, &[command, "fleet.toml", "--out", out]);
            assert_eq!(code, 2, "{said}");
            assert!(said.contains(name) && said.contains("--out"), "{said}");
        }
        assert_eq!(std::fs::read(dir.join(name)).unwrap(), before);
        assert_eq!(count(), files, "nothing is left behind");
        let (code, said) = call(&dir, &[command, "fleet.toml", "--out", "elsewhere"]);
        assert_eq!(code, 0, "{said}");
        std::fs::remove_dir_all(dir.join("elsewhere")).unwrap();
    }
}

#[test]
fn a_folder_of_two_commands_is_verified_by_the_files_of_the_last() {
    let dir = copy_of("frame", "two_commands");
    for command in ["sensitivity", "recover"] {
        let (code, said) = call(&dir, &[command, "recover.toml"]);
        assert_eq!(code, 0, "{said}");
    }
    let (code, said) = call(&dir, &["verify", "recover.out"]);
    assert_eq!(code, 0, "{said}");
    std::fs::remove_file(dir.join("recover.out/loads.csv")).unwrap();
    let (code, said) = call(&dir, &["verify", "recover.out"]);
    assert_eq!(code, 1, "{said}");
    // What it would replace is what it verifies.
    let (code, said) = call(&dir, &["verify", "recover.out", "--out", "recover.out"]);
    assert_eq!(code, 2, "{said}");
}

#[test]
fn a_table_whose_last_number_may_be_cut_is_said_and_a_record_is_read_without_it() {
    let dir = copy_of("fleet", "cut_record");
    let record = dir.join("A_2026-05-01.csv");
    let whole = std::fs::read(&record).unwrap();
    let samples = || -> u64 {
        let text = std::fs::read_to_string(dir.join("out/result.json")).unwrap();
        let result: Value = serde_json::from_str(&text).unwrap();
        result["samples"].as_u64().unwrap()
    };
    let recover = ["recover", "fleet.toml", "--out", "out"];
    let (code, said) = call(&dir, &recover);
    assert_eq!(code, 0, "{said}");
    assert!(!said.contains("table-may-be-cut"), "{said}");
    let all = samples();
    for less in [2, 3, 6] {
        std::fs::write(&record, &whole[..whole.len() - less]).unwrap();
        let (_, said) = call(&dir, &recover);
        assert!(said.contains("table-may-be-cut"), "{less}: {said}");
        assert_eq!(samples(), all - 1, "{less}");
        let (_, said) = call(
            &dir,
            &["fleet", "fleet.toml", "A_2026-05-01.csv", "--out", "f"],
        );
        assert!(said.contains("table-may-be-cut"), "{less}: {said}");
    }
    // The end of the line alone: its numbers are whole.
    std::fs::write(&record, &whole[..whole.len() - 1]).unwrap();
    let (_, said) = call(&dir, &recover);
    assert!(!said.contains("table-may-be-cut"), "{said}");
    assert_eq!(samples(), all);
    let dir = copy_of("frame", "cut_runs");
    let strain = std::fs::read(dir.join("strain.csv")).unwrap();
    std::fs::write(dir.join("strain.csv"), &strain[..strain.len() - 2]).unwrap();
    let (code, said) = call(&dir, &["recover", "recover.toml"]);
    assert!(code < 2 && said.contains("table-may-be-cut"), "{said}");
}

#[test]
fn steps_of_angles_below_a_tenth_of_a_degree_are_refused_at_their_line() {
    let dir = copy_of("frame", "angles");
    for step in ["1e-9", "0.05"] {
        let job = dir.join("place.toml");
        let text = std::fs::read_to_string(&job).unwrap();
        let line = 1 + text
            .lines()
            .position(|l| l.starts_with("angle_step_deg"))
            .unwrap();
        let from = text.lines().nth(line - 1).unwrap();
        edit(&job, from, &format!("angle_step_deg = {step}"));
        let (code, said) = call(&dir, &["place", "place.toml"]);
        assert_eq!(code, 2, "{said}");
        assert!(
            said.contains(&format!("place.toml:{line}: candidates.angle_step_deg")),
            "{said}"
        );
    }
}

#[test]
fn fewer_gauges_than_loads_are_not_told_that_they_stand_too_close() {
    let dir = copy_of("frame", "few_gauges");
    let job = dir.join("place.toml");
    edit(&job, "gauges = 12", "gauges = 5");
    edit(&job, "spacing = 100.0", "spacing = 0.001");
    let (code, said) = call(&dir, &["place", "place.toml"]);
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("loads-not-separable"), "{said}");
    assert!(!said.contains("do not fit"), "{said}");
}

#[test]
fn a_table_of_a_header_alone_is_refused_by_every_command_that_reads_it() {
    let dir = copy_of("frame", "no_rows");
    let cut = |name: &str| {
        let text = std::fs::read_to_string(dir.join(name)).unwrap();
        let header = text.lines().next().unwrap().to_owned();
        std::fs::write(dir.join(name), header + "\n").unwrap();
    };
    let refused = |command: &str, job: &str, name: &str| {
        let (code, said) = call(&dir, &[command, job, "--out", "out"]);
        assert_eq!(code, 2, "{command} {job}: {said}");
        assert!(
            said.contains(name) && said.contains("a header and no rows"),
            "{command} {job}: {said}"
        );
    };
    cut("runs.csv");
    for (command, job) in [
        ("payload", "payload.toml"),
        ("study", "study.toml"),
        ("check", "payload.toml"),
    ] {
        refused(command, job, "runs.csv");
    }
    cut("gauges.csv");
    for command in ["check", "solve", "cases", "sensitivity", "modes", "recover"] {
        refused(command, "recover.toml", "gauges.csv");
    }
}

#[test]
fn results_that_a_job_names_are_opened_by_those_that_have_no_use_for_them() {
    let dir = copy_of("frame", "named_results");
    let (code, said) = call(&dir, &["solve", "place.toml", "--out", "solved"]);
    assert_eq!(code, 0, "{said}");
    let whole = std::fs::read(dir.join("solved/results.op2")).unwrap();
    std::fs::write(dir.join("cut.op2"), &whole[..whole.len() * 3 / 5]).unwrap();
    for name in ["cut.op2", "nope.op2"] {
        for job in ["place.toml", "ballast.toml"] {
            std::fs::copy(
                Path::new(env!("CARGO_MANIFEST_DIR"))
                    .join("examples/frame")
                    .join(job),
                dir.join(job),
            )
            .unwrap();
            let deck = "deck = \"frame.bdf\"\n";
            edit(
                &dir.join(job),
                deck,
                &format!("{deck}results = [\"{name}\"]\n"),
            );
        }
        for (command, job) in [
            ("solve", "place.toml"),
            ("modes", "place.toml"),
            ("cases", "place.toml"),
            ("ballast", "ballast.toml"),
        ] {
            let (code, said) = call(&dir, &[command, job, "--out", "out"]);
            // The run that writes the results of `cases` is still to come.
            let expected = if (command, name) == ("cases", "nope.op2") {
                0
            } else {
                2
            };
            assert_eq!(code, expected, "{command} {name}: {said}");
            assert!(expected == 0 || said.contains(name), "{command}: {said}");
        }
    }
}
