//! Jobs of `examples/` whose numbers are in other units than stated: nothing is answered without an error.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

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
        let both = [
            (1e-6, "readings-below-noise"),
            (1e3, "reading-beyond-gauges"),
        ];
        // What S is learnt from alone may be any signal that stands out of its noise.
        let asked = if folder == "bridge" { 1 } else { 2 };
        for (factor, code) in &both[..asked] {
            let factor = *factor;
            let to = copied("strain", folder);
            edit(&to, strain, |t| scaled(t, None, factor));
            asks(&to, &[command, job], code);
        }
    }
    let to = copied("no_strain", "frame");
    edit(&to, "strain_wired.csv", |t| scaled(t, None, 1e9));
    refuses(&to, &["reconcile", "reconcile.toml"], "strain_wired.csv");
    for factor in [1e4, 1e9] {
        let to = copied("any_signal", "bridge");
        edit(&to, "strain.csv", |t| scaled(t, None, factor));
        for command in ["calibrate", "check"] {
            let (exit, codes, errors) = judged(&to, &[command, "calibrate.toml"]);
            assert_eq!(exit, 0, "{command}: {codes:?}\n{errors}");
        }
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
