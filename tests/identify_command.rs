//! `identify` from the job to result.json.

#[path = "../nastran/tests/support/mod.rs"]
mod support;

#[path = "identify/simulate.rs"]
mod simulate;

#[path = "identify/thesis.rs"]
mod thesis;

#[path = "identify/formats.rs"]
mod formats;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn run(job: &Path, out: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .arg("identify")
        .arg(job)
        .arg("--out")
        .arg(out)
        .arg("--json")
        .output()
        .unwrap()
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn the_control_job_gives_the_contracts_keys_and_a_closed_mass_balance() {
    let Some(case) = support::find_shared_path("hidden_effects/dynamics/dev-d1/job.toml") else {
        return;
    };
    let out = folder("identify_control");
    let output = run(&case, &out);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in [
        "command",
        "version",
        "units",
        "inputs",
        "findings",
        "seconds",
        "parameters",
        "unidentifiable",
        "fit",
        "mass_closure",
    ] {
        assert!(!result[key].is_null(), "{key} is missing");
    }
    let parameter = |name: &str| {
        result["parameters"]
            .as_array()
            .unwrap()
            .iter()
            .find(|p| p["name"] == name)
            .unwrap()
            .clone()
    };
    for name in ["m_b", "m_f", "k_s", "c_s"] {
        let p = parameter(name);
        assert!(
            p["identifiable"] == true
                && p["value"].as_f64().unwrap() > p["sigma"].as_f64().unwrap(),
            "{p}"
        );
    }
    assert_eq!(parameter("k_s")["unit"], "N/m");
    assert!((result["mass_closure"].as_f64().unwrap() - 1.0).abs() < 0.01);
    let wheel = result["fit"]
        .as_array()
        .unwrap()
        .iter()
        .find(|f| f["channel"] == "f_wheel")
        .unwrap()
        .clone();
    assert!(wheel["relative_rms"].as_f64().unwrap() < 0.01, "{wheel}");
    assert!(
        result["findings"].as_array().unwrap().is_empty(),
        "{}",
        result["findings"]
    );
    let loads = std::fs::read_to_string(out.join("loads.csv")).unwrap();
    assert!(loads.starts_with("time,f_wheel,f_wheel.low,f_wheel.high"));
}

#[test]
fn bad_records_end_with_code_2_and_name_file_line_and_remedy() {
    let here = folder("identify_bad");
    let job = here.join("job.toml");
    let write = |name: &str, text: &str| std::fs::write(here.join(name), text).unwrap();
    let text = "units = \"m-kg-s\"\n[vehicle]\nmodel = \"front2\"\ndata = \"data.csv\"\nsample_rate = 500\nband_hz = [0.7, 20.0]\n";
    write("job.toml", text);
    let fails = |expected: &str| {
        let output = run(&job, &here.join("out"));
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected), "{expected}: {message}");
    };
    write(
        "data.csv",
        "t,a_body,a_wheel,f_wheel\n0,9.8,9.8,100\n0.002,9.8,9.8\n",
    );
    fails("data.csv:3");
    write(
        "data.csv",
        "t,a_body,a_wheel,f_wheel\n0,9.8,9.8,100\n0.004,9.8,9.8,100\n0.008,9.8,9.8,100\n",
    );
    fails("sample_rate");
    write(
        "data.csv",
        "t,a_body,a_wheel,f_wheel\n0,9.8,9.8,100\n0.002,9.8,9.8,100\n0.004,9.8,9.8,100\n",
    );
    fails("are needed");
    write(
        "job.toml",
        &text.replace("band_hz", "terms = [\"k_q\"]\nband_hz"),
    );
    fails("k_q");
}

/// By Newton's laws, the force on the chassis is the wheel force minus the inertia force of the wheel. Hanger and
/// shackle share it by the lever rule.
#[test]
fn mass_and_springs_give_the_chassis_force_also_at_the_seats_of_the_leaf() {
    let Some(case) = support::find_shared_path("hidden_effects/dynamics/dev-d1") else {
        return;
    };
    let out = folder("identify_chassis");
    std::fs::create_dir_all(&out).unwrap();
    let mut text = std::fs::read_to_string(case.join("job.toml")).unwrap();
    for file in ["data.csv", "holdout.csv"] {
        std::fs::copy(case.join(file), out.join(file)).unwrap();
    }
    let leaf =
        "leaf = { s = { hanger_to_axle = 0.6, axle_to_shackle = 0.9, shackle_angle_deg = 10 } }";
    text = text.replace("[vehicle]", &format!("[vehicle]\n{leaf}"));
    std::fs::write(out.join("job.toml"), &text).unwrap();
    let output = run(&out.join("job.toml"), &out.join("out"));
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let chassis = &result["chassis_forces"][0];
    let [mass, springs, difference] =
        ["rms_by_mass", "rms_by_springs", "rms_difference"].map(|k| chassis[k].as_f64().unwrap());
    // Sensor noise is below one per cent of the accelerations.
    assert!(difference < 0.02 * mass.min(springs), "{chassis}");
    let table = std::fs::read_to_string(out.join("out/chassis_forces.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(
        lines.next(),
        Some(
            "time,b.by_mass,b.by_springs,s,s.hanger,s.shackle,s.horizontal,b.low,b.high,s.low,s.high"
        )
    );
    let mut squares = [0.0; 2];
    for line in lines.take(2000) {
        let v: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let near = |a: f64, b: f64| assert!((a - b).abs() <= 2e-6 * v[3].abs() + 1e-6, "{line}");
        near(v[4] + v[5], v[3]);
        near(v[4] * 0.6, v[5] * 0.9);
        near(v[6], v[5] * 10f64.to_radians().tan());
        squares[0] += (v[1] - v[3]).powi(2);
        squares[1] += v[1] * v[1];
    }
    assert!(squares[0] < 0.02f64.powi(2) * squares[1]);
    std::fs::write(out.join("job.toml"), text.replace("{ s = {", "{ q = {")).unwrap();
    let output = run(&out.join("job.toml"), &out.join("out"));
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(
        error.contains("no link `q`") && error.contains("`s`"),
        "{error}"
    );
}

/// Spring 2 connects the rig to the ground, so the weight of its masses is not a load of the shaker. Page and tables
/// use the units of the job.
#[test]
fn a_rig_has_no_static_load_and_its_tables_and_page_are_in_the_units_of_the_job() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/rig");
    let here = folder("identify_rig");
    for file in ["rig.csv", "rig_holdout.csv"] {
        std::fs::copy(example.join(file), here.join(file)).unwrap();
    }
    let job = std::fs::read_to_string(example.join("rig.toml")).unwrap();
    for (system, force, length) in [("m-kg-s", "N", "m"), ("in-lbf-s", "lbf", "in")] {
        std::fs::write(here.join("rig.toml"), job.replace("m-kg-s", system)).unwrap();
        let out = here.join(system);
        let output = run(&here.join("rig.toml"), &out);
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(!result["loads"].as_array().unwrap().is_empty());
        for load in result["loads"].as_array().unwrap() {
            assert_eq!(load["name"], "f_1");
            assert!(load["value"].is_null() && load["sigma"].is_null(), "{load}");
            assert!(load["max"].as_f64().unwrap() > 0.0, "{load}");
        }
        let tables = &result["tables"];
        assert_eq!(tables["loads.csv"]["f_1"], force);
        assert_eq!(tables["restoring_force.csv"]["force_model"], force);
        assert_eq!(tables["restoring_force.csv"]["stretch"], length);
        assert_eq!(
            tables["restoring_force.csv"]["rate"],
            format!("{length}/s").as_str()
        );
        let page = std::fs::read_to_string(out.join("report.html")).unwrap();
        for label in [
            format!("force, {force} over time, s"),
            format!("force, {force} over stretch, {length}"),
            format!("density of force, {force}²/Hz"),
            format!("by mass, {force}"),
        ] {
            assert!(page.contains(&label), "{system}: {label}");
        }
    }
}

/// A force with reversed sign, or a record a thousand times as large. No noise is declared, and the model explains
/// nothing of it.
#[test]
fn a_model_that_leaves_most_of_a_channel_is_an_error_where_no_noise_is_declared() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/rig");
    for (name, y, u, lost) in [
        ("as_it_is", 1.0, 1.0, None),
        ("sign", 1.0, -1.0, Some("input-sign-reversed")),
        ("unit", 1e3, 1.0, Some("model-incomplete")),
    ] {
        let here = folder(&format!("identify_lost_{name}"));
        for file in ["oscillator.toml", "oscillator_holdout.csv"] {
            std::fs::copy(example.join(file), here.join(file)).unwrap();
        }
        let text = std::fs::read_to_string(example.join("oscillator.csv")).unwrap();
        let row = |(i, line): (usize, &str)| {
            let numbers: Vec<f64> = line.split(',').filter_map(|n| n.parse().ok()).collect();
            match (i, numbers.as_slice()) {
                (1.., [t, a, b]) => format!("{t},{},{}\n", y * a, u * b),
                _ => format!("{line}\n"),
            }
        };
        let changed: String = text.lines().enumerate().map(row).collect();
        std::fs::write(here.join("oscillator.csv"), changed).unwrap();
        let output = run(&here.join("oscillator.toml"), &here.join("out"));
        let code = if lost.is_some() { 1 } else { 0 };
        let printed = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(code), "{name}: {printed}");
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let findings = result["findings"].as_array().unwrap();
        let codes = ["input-sign-reversed", "model-incomplete"];
        let mut errors = findings.iter().filter_map(|f| f["code"].as_str());
        let told = errors.find(|code| codes.contains(code));
        assert_eq!(told, lost, "{name}: {printed}");
    }
}

#[test]
fn a_channel_whose_name_is_misspelt_is_named_and_not_taken_for_one_that_was_not_measured() {
    let Some(job) = support::find_shared_path("hidden_effects/dynamics/dev-d1/job.toml") else {
        return;
    };
    let here = folder("identify_misspelt");
    for entry in std::fs::read_dir(job.parent().unwrap()).unwrap() {
        let from = entry.unwrap().path();
        if from.is_file() {
            let text = std::fs::read(&from).unwrap();
            let text = String::from_utf8_lossy(&text).into_owned();
            let text = match from.extension().is_some_and(|e| e == "csv") {
                true => text.replacen("f_wheel", "f_whel", 1),
                false => text,
            };
            std::fs::write(here.join(from.file_name().unwrap()), text).unwrap();
        }
    }
    let output = run(&here.join("job.toml"), &here.join("out"));
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let findings = result["findings"].as_array().unwrap();
    let found = findings.iter().find(|f| f["code"] == "channel-misspelt");
    let message = found.expect("a finding")["message"].as_str().unwrap();
    assert!(message.contains("`f_whel` for `f_wheel`"), "{message}");
}

/// Returns the columns of a table by name.
fn columns(path: &Path) -> std::collections::BTreeMap<String, Vec<f64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut out: Vec<Vec<f64>> = vec![vec![]; names.len()];
    for line in lines {
        let values = line.split(',').map(|v| v.parse().unwrap());
        out.iter_mut().zip(values).for_each(|(c, v)| c.push(v));
    }
    names.into_iter().map(str::to_owned).zip(out).collect()
}

/// The second conclusion of the thesis: the force on the chassis is the sprung mass times its acceleration.
#[test]
fn one_accelerometer_and_a_known_sprung_mass_give_the_chassis_force_with_its_interval() {
    let here = folder("identify_one_accelerometer");
    let (mass, rate, size) = (3000.0, 200.0, 2.0);
    let wave = |hz: f64, t: f64| (std::f64::consts::TAU * hz * t).sin();
    let a = |t: f64| size * (0.6 * wave(3.1, t) + 0.4 * wave(7.3, t));
    let mut text = String::from("t,a_body [m/s2]\n");
    for i in 0..12_000 {
        let t = f64::from(i) / rate;
        text.push_str(&format!("{t:.3},{:.9}\n", 9.80665 + a(t)));
    }
    std::fs::write(here.join("data.csv"), text).unwrap();
    let job = format!(
        "units = \"m-kg-s\"\n[vehicle]\nmodel = \"front2\"\nterms = [\"k_s\", \"c_s\"]\ndata = \"data.csv\"\nband_hz = [0.7, 20.0]\n\
         known = {{ m_b = {mass} }}\nnoise = {{ acc = 0.05, force = 60.0 }}\ntolerance = {{ gain = 0.01 }}\n"
    );
    std::fs::write(here.join("job.toml"), &job).unwrap();
    let output = run(&here.join("job.toml"), &here.join("out"));
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{printed}");
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(
        result["findings"].as_array().unwrap().is_empty(),
        "{printed}"
    );
    let open = result["unidentifiable"][0].as_str().unwrap();
    assert!(open.contains("k_s") && open.contains("a_wheel"), "{open}");
    let table = columns(&here.join("out/chassis_forces.csv"));
    let n = table["time"].len();
    // White noise of the stated size in the band of 19.3 Hz of 100 Hz, and one per cent of the gain.
    let noise = 0.05 * (19.3f64 / 100.0).sqrt();
    for i in n / 4..3 * n / 4 {
        let truth = mass * a(table["time"][i]);
        let [force, low, high] = ["b.by_mass", "b.low", "b.high"].map(|c| table[c][i]);
        // The record ends within a period, and the filter of the band spreads the step. Measured: 1.1e-3.
        assert!(
            (force - truth).abs() < 2e-3 * mass * size,
            "{force} {truth}"
        );
        let half = 1.96 * mass * noise.hypot(0.01 * force / mass);
        assert!(
            (high - force - half).abs() < 1e-3 * half,
            "{high} {force} {half}"
        );
        assert!(
            (force - low - half).abs() < 1e-3 * half,
            "{low} {force} {half}"
        );
    }
    // Without a mass, the missing channel is a fault.
    let without = job.replace(&format!("known = {{ m_b = {mass} }}\n"), "");
    std::fs::write(here.join("job.toml"), without).unwrap();
    let output = run(&here.join("job.toml"), &here.join("without"));
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{printed}");
    assert!(printed.contains("a_wheel"), "{printed}");
}

/// For a measured quarter truck, the mass alone gives the force of spring and damper.
#[test]
fn the_force_by_a_known_mass_is_that_of_spring_and_damper() {
    let here = folder("identify_mass_alone");
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/quarter_truck");
    let text = std::fs::read_to_string(example.join("data.csv")).unwrap();
    let write = |name: &str, text: &str| std::fs::write(here.join(name), text).unwrap();
    let body: String = text
        .lines()
        .map(|l| l.split(',').take(2).collect::<Vec<_>>().join(",") + "\n")
        .collect();
    write("data.csv", &text);
    write("body.csv", &body);
    let job = "units = \"m-kg-s\"\n[vehicle]\nmodel = \"front2\"\nterms = [\"k_s\", \"c_s\"]\ndata = \"data.csv\"\nband_hz = [0.7, 20.0]\n";
    write("job.toml", job);
    let output = run(&here.join("job.toml"), &here.join("out"));
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let parameters = result["parameters"].as_array().unwrap();
    let mass = parameters.iter().find(|p| p["name"] == "m_b").unwrap();
    let mass = mass["value"].as_f64().unwrap();
    let known = format!("{job}known = {{ m_b = {mass} }}\n");
    write("known.toml", &known.replace("data.csv", "body.csv"));
    let output = run(&here.join("known.toml"), &here.join("known"));
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{printed}");
    let full = columns(&here.join("out/chassis_forces.csv"));
    let alone = columns(&here.join("known/chassis_forces.csv"));
    assert!(!alone.contains_key("b.by_springs") && !alone.contains_key("s"));
    // The computation of the spring stretch cuts off the ends of both records, or the shorter record starts later.
    let at = |t: f64| full["time"].iter().position(|x| (x - t).abs() < 1e-6);
    let (mut squares, mut n) = ([0.0; 2], 0);
    for (t, force) in alone["time"].iter().zip(&alone["b.by_mass"]) {
        if let Some(i) = at(*t) {
            squares[0] += (force - full["b.by_springs"][i]).powi(2);
            squares[1] += force * force;
            n += 1;
        }
    }
    assert!(n > 3000, "{n}");
    // Sensor noise is below one per cent of the accelerations, as for both methods with the whole model.
    assert!(squares[0] < 0.02f64.powi(2) * squares[1], "{squares:?}");
}

/// `identify` and `reconcile` report a reversed wheel force as such, without any effect of the model.
#[test]
fn a_reversed_wheel_force_is_an_error_of_identify_and_reconcile() {
    let here = folder("identify_reversed");
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/quarter_truck");
    for name in ["data.csv", "holdout.csv"] {
        let text = std::fs::read_to_string(example.join(name)).unwrap();
        let rows = text.lines().enumerate().map(|(i, l)| match i {
            0 => format!("{l}\n"),
            _ => {
                let (head, force) = l.rsplit_once(',').unwrap();
                format!("{head},{}\n", -force.parse::<f64>().unwrap())
            }
        });
        std::fs::write(here.join(name), rows.collect::<String>()).unwrap();
    }
    let job = std::fs::read_to_string(example.join("identify.toml")).unwrap();
    let job = format!("{job}\n[reconcile]\npath = \"dynamic\"\n");
    std::fs::write(here.join("job.toml"), job).unwrap();
    for command in ["identify", "reconcile"] {
        let output = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .args([command, here.join("job.toml").to_str().unwrap(), "--json"])
            .args(["--out", here.join(command).to_str().unwrap()])
            .output()
            .unwrap();
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{command}: {printed}");
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let findings = result["findings"].as_array().unwrap();
        let wrong: Vec<_> = findings
            .iter()
            .filter(|f| f["severity"] == "error")
            .collect();
        assert_eq!(wrong.len(), 1, "{command}: {findings:?}");
        assert_eq!(wrong[0]["code"], "input-sign-reversed", "{command}");
        assert_eq!(wrong[0]["subject"], "f_wheel", "{command}");
        for text in [
            printed,
            String::from_utf8_lossy(&output.stdout).into_owned(),
        ] {
            assert!(!text.contains("NaN") && !text.contains("()"), "{text}");
        }
        if command == "reconcile" {
            assert_eq!(result["verdict"], "unknown");
            assert_eq!(result["named"], serde_json::json!([]));
        }
    }
}
