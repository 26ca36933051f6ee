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

/// Makes a copy of a folder of `examples/` under a name of its own.
fn copied(name: &str, folder: &str) -> PathBuf {
    let to = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("wrong_units")
        .join(name);
    let _ = std::fs::remove_dir_all(&to);
    std::fs::create_dir_all(&to).unwrap();
    let from = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(folder);
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
        }
    }
    to
}

/// Changes a file of a folder.
fn edit(folder: &Path, file: &str, change: impl Fn(&str) -> String) {
    let path = folder.join(file);
    let text = std::fs::read_to_string(&path).unwrap();
    let changed = change(&text);
    assert_ne!(text, changed, "{file}");
    std::fs::write(path, changed).unwrap();
}

/// A table with the numbers of a column, or of all but the first, times a factor.
fn scaled(text: &str, column: Option<&str>, factor: f64) -> String {
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut out = header.join(",") + "\n";
    for line in lines {
        let fields = line.split(',').zip(&header).enumerate();
        let fields = fields.map(|(i, (field, name))| match field.parse::<f64>() {
            Ok(v) if i > 0 && column.is_none_or(|c| c == *name) => (v * factor).to_string(),
            _ => field.to_owned(),
        });
        out += &(fields.collect::<Vec<_>>().join(",") + "\n");
    }
    out
}

/// The same with one number of a line put in place of that of a column.
fn with_number(text: &str, line: usize, column: &str, number: &str) -> String {
    let mut header = text.lines().next().unwrap().split(',');
    let at = header.position(|c| c == column).unwrap();
    let lines = text.lines().enumerate().map(|(i, l)| {
        let mut fields: Vec<&str> = l.split(',').collect();
        if i + 1 == line {
            fields[at] = number;
        }
        fields.join(",") + "\n"
    });
    lines.collect()
}

/// Runs a command in a folder: exit code, codes of its findings with their severity and subject, standard error.
fn judged(folder: &Path, arguments: &[&str]) -> (i32, Vec<String>, String) {
    let out = folder.join("judged.out");
    let _ = std::fs::remove_dir_all(&out);
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .arg("--out")
        .arg(&out)
        .env("STRAINBRIDGE_CACHE", folder.join("kept"))
        .current_dir(folder)
        .output()
        .unwrap();
    let text = std::fs::read(out.join("result.json")).unwrap_or_default();
    let result: Value = serde_json::from_slice(&text).unwrap_or(Value::Null);
    let findings = result["findings"].as_array().cloned().unwrap_or_default();
    let word = |f: &Value, key: &str| f[key].as_str().unwrap_or_default().to_owned();
    let codes = findings
        .iter()
        .map(|f| [word(f, "severity"), word(f, "code"), word(f, "subject")].join(" "))
        .collect();
    let errors = String::from_utf8_lossy(&done.stderr).into_owned();
    (done.status.code().unwrap_or(-1), codes, errors)
}

/// Asserts an exit code of 1 with an error of this code.
fn asks(folder: &Path, arguments: &[&str], code: &str) {
    let (exit, codes, errors) = judged(folder, arguments);
    assert_eq!(exit, 1, "{arguments:?}\n{errors}");
    let head = format!("error {code} ");
    assert!(
        codes.iter().any(|c| c.starts_with(&head)),
        "{arguments:?} {codes:?}"
    );
}

/// Asserts a fault at this place, and nothing written.
fn refuses(folder: &Path, arguments: &[&str], place: &str) {
    let (exit, _, errors) = judged(folder, arguments);
    assert_eq!(exit, 2, "{arguments:?}\n{errors}");
    assert!(errors.contains(place), "{arguments:?}\n{errors}");
    assert!(!folder.join("judged.out").exists(), "{arguments:?}");
}

#[test]
fn every_command_that_reads_strain_asks_for_its_unit() {
    for (folder, command, job, strain) in [
        ("frame", "reconcile", "reconcile.toml", "strain_wired.csv"),
        ("frame", "recover", "recover.toml", "strain.csv"),
        ("frame", "respond", "respond.toml", "strain.csv"),
        ("bridge", "calibrate", "calibrate.toml", "strain.csv"),
    ] {
        // The bridge reads 34 microstrain at most: a thousand times that is still strain.
        let large = if folder == "bridge" { 1e4 } else { 1e3 };
        for (factor, code) in [
            (1e-6, "readings-below-noise"),
            (large, "reading-beyond-gauges"),
        ] {
            let to = copied("strain", folder);
            edit(&to, strain, |t| scaled(t, None, factor));
            asks(&to, &[command, job], code);
        }
    }
    for (folder, command, job, strain) in [
        ("frame", "reconcile", "reconcile.toml", "strain_wired.csv"),
        ("bridge", "calibrate", "calibrate.toml", "strain.csv"),
    ] {
        let to = copied("no_strain", folder);
        edit(&to, strain, |t| scaled(t, None, 1e9));
        refuses(&to, &[command, job], strain);
    }
    let to = copied("fleet", "fleet");
    let records = [
        "A_2026-05-01.csv",
        "A_2026-05-02.csv",
        "B_2026-05-01.csv",
        "B_2026-05-02.csv",
    ];
    for record in records {
        edit(&to, record, |t| scaled(t, None, 1e3));
    }
    let (exit, codes, errors) = judged(
        &to,
        &[["fleet", "fleet.toml"].as_slice(), &records].concat(),
    );
    assert_eq!(exit, 1, "{codes:?}\n{errors}");
}

#[test]
fn a_load_or_a_payload_that_nothing_weighs_is_a_fault_of_its_line() {
    for (folder, job, file, column) in [
        ("frame", "reconcile.toml", "runs.csv", "N.FZ"),
        ("frame", "reconcile.toml", "runs.csv", "payload_mass"),
        ("frame", "reconcile.toml", "runs.csv", "payload_x"),
        ("frame", "payload.toml", "runs.csv", "N.FZ"),
        ("frame", "payload.toml", "runs.csv", "payload_x"),
        ("frame", "ballast.toml", "empty.csv", "N.FZ"),
        ("bridge", "calibrate.toml", "runs.csv", "west"),
    ] {
        for number in ["1e308", "-1e200"] {
            let line = if file == "empty.csv" { 2 } else { 3 };
            let to = copied("runs", folder);
            edit(&to, file, |t| with_number(t, line, column, number));
            let command = job.strip_suffix(".toml").unwrap();
            refuses(&to, &[command, job], &format!("{file}:{line}: {column}: "));
        }
    }
    let to = copied("factor", "bridge");
    edit(&to, "calibrate.toml", |t| {
        t.replace("terms = { west = 1,", "terms = { west = 1e308,")
    });
    refuses(&to, &["calibrate", "calibrate.toml"], "combination.terms");
    let to = copied("noise_of_job", "bridge");
    edit(&to, "calibrate.toml", |t| {
        t.replace("noise_microstrain = 0.05", "noise_microstrain = 1e300")
    });
    let (exit, _, errors) = judged(&to, &["calibrate", "calibrate.toml"]);
    assert!(exit == 2 && errors.contains("1e300"), "{errors}");
    assert!(!errors.contains("0000000"), "{errors}");
}

#[test]
fn wheel_forces_in_another_unit_are_asked_for() {
    let to = copied("ballast", "frame");
    edit(&to, "empty.csv", |t| scaled(t, None, 1e3));
    asks(&to, &["ballast", "ballast.toml"], "ballast-beyond-model");
    let reconcile = ["reconcile", "reconcile.toml"];
    edit(&to, "runs.csv", |t| {
        ["N.FZ", "L.FZ", "R.FZ"]
            .iter()
            .fold(t.to_owned(), |t, c| scaled(&t, Some(c), 1e3))
    });
    asks(&to, &reconcile, "model-far-above-readings");
}

#[test]
fn loads_of_another_unit_give_no_stress_without_an_error() {
    let to = copied("respond", "frame");
    let (exit, _, errors) = judged(&to, &["recover", "recover.toml"]);
    assert_eq!(exit, 0, "{errors}");
    std::fs::copy(to.join("judged.out/loads.csv"), to.join("loads.csv")).unwrap();
    edit(&to, "respond.toml", |t| {
        t.replace("[respond]", "[respond]\nloads = \"loads.csv\"")
    });
    let respond = ["respond", "respond.toml"];
    let (exit, _, errors) = judged(&to, &respond);
    assert_eq!(exit, 0, "{errors}");
    let table = std::fs::read_to_string(to.join("loads.csv")).unwrap();
    edit(&to, "loads.csv", |t| with_number(t, 3, "L.FZ", "1e308"));
    refuses(&to, &respond, "loads.csv:3: L.FZ: ");
    std::fs::write(to.join("loads.csv"), scaled(&table, None, 1e3)).unwrap();
    asks(&to, &respond, "load-beyond-expected");
    std::fs::write(to.join("loads.csv"), &table).unwrap();
    edit(&to, "respond.toml", |t| {
        let kilo = "force = \"kN\", moment = \"kN m\"";
        t.replace(kilo, "force = \"N\", moment = \"N m\"")
    });
    asks(&to, &respond, "prediction-poor");
}

#[test]
fn channels_that_read_less_than_their_noise_tell_nothing_of_a_vehicle() {
    let quarter = "quarter_truck";
    let identify = ["identify", "identify.toml"];
    for column in [Some("f_wheel"), None] {
        let factor = if column.is_some() { 1e-3 } else { 1e-6 };
        let to = copied("channels", quarter);
        for file in ["data.csv", "holdout.csv"] {
            edit(&to, file, |t| scaled(t, column, factor));
        }
        asks(&to, &identify, "readings-below-noise");
    }
    let to = copied("noise", quarter);
    let stated = "noise = { acc = 0.02, force = 60.0 }";
    edit(&to, "identify.toml", |t| {
        t.replace(stated, "noise = { acc = 2000.0, force = 6e7 }")
    });
    asks(&to, &identify, "readings-below-noise");
    let to = copied("known", quarter);
    edit(&to, "identify.toml", |t| {
        t.replace(stated, &format!("{stated}\nknown = {{ m_b = 1e308 }}"))
    });
    refuses(&to, &identify, "vehicle.known.m_b");
    let to = copied("huge_sample", quarter);
    edit(&to, "data.csv", |t| with_number(t, 9, "a_wheel", "1e308"));
    refuses(&to, &identify, "a_wheel");
    let to = copied("compared", quarter);
    for file in ["data_worn.csv", "holdout_worn.csv"] {
        edit(&to, file, |t| scaled(t, Some("f_wheel"), 1e-3));
    }
    asks(
        &to,
        &["reconcile", "reconcile.toml"],
        "readings-below-noise",
    );
}

#[test]
fn every_command_that_reads_a_job_s_deck_judges_its_modulus() {
    let to = copied("modulus", "frame");
    edit(&to, "frame.bdf", |t| {
        t.replace("MAT1,1,2.1+5", "MAT1,1,1.+30")
    });
    for (command, job) in [
        ("modes", "place.toml"),
        ("solve", "place.toml"),
        ("cases", "place.toml"),
        ("ballast", "ballast.toml"),
        ("payload", "payload.toml"),
        ("sensitivity", "place.toml"),
    ] {
        asks(&to, &[command, job], "units-modulus");
    }
}
