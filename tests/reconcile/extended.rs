//! The extended model holds the effect: reconciled again as it stands there is nothing to name and the gap is at its floor, on the runs it
//! was found in and, their raw readings put in, on runs that were never seen. One case a kind of effect.

use super::hidden;
use hidden::generator::{Background, hide};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use strainbridge::reconcile::strain::StrainFrame;

/// What the gap may be above its floor: the floor is a root mean square of some hundred readings, whose own scatter is a tenth.
const AT_FLOOR: f64 = 1.25;

fn run(command: &str, job: &Path, out: &Path) -> (Option<i32>, Value) {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .arg(command)
        .arg(job)
        .arg("--out")
        .arg(out)
        .args(["--no-cache", "--json"])
        .output()
        .expect("the program runs");
    let code = done.status.code();
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(code != Some(2), "{command} {}: {said}", job.display());
    let result = serde_json::from_slice(&done.stdout).expect("valid json");
    (code, result)
}

/// The frame with as many runs again.
fn doubled(base: &StrainFrame) -> StrainFrame {
    let mut out = base.clone();
    let o = &mut out.observations;
    let n = o.runs.len();
    o.runs.extend((n + 1..=2 * n).map(|r| format!("R{r:02}")));
    o.values.extend_from_within(..);
    o.held_out.extend_from_within(..);
    out.loads.extend_from_within(..);
    out.payload.extend_from_within(..);
    out
}

/// Readings and notes of some runs, as files of a folder.
fn write_runs(frame: &StrainFrame, runs: std::ops::Range<usize>, folder: &Path) {
    std::fs::create_dir_all(folder).expect("a folder");
    let (n_g, n_l) = (frame.n_gauges(), frame.n_loads());
    let names = |list: &[String]| list.join(",");
    let mut strain = format!("run,{}\n", names(&frame.observations.channels));
    let mut notes = format!("run,payload_kg,payload_x_m,{}\n", names(&frame.load_names));
    for r in runs {
        let name = &frame.observations.runs[r];
        let row = &frame.observations.values[r * n_g..(r + 1) * n_g];
        let cells: Vec<String> = row.iter().map(|v| format!("{v:.4}")).collect();
        let _ = writeln!(strain, "{name},{}", cells.join(","));
        let [mass, x, _] = frame.payload[r];
        let loads = &frame.loads[r * n_l..(r + 1) * n_l];
        let cells: Vec<String> = loads.iter().map(|v| format!("{v:.6}")).collect();
        let x = x + frame.payload_origin[0];
        let _ = writeln!(notes, "{name},{mass},{x},{}", cells.join(","));
    }
    std::fs::write(folder.join("strain.csv"), strain).expect("written");
    std::fs::write(folder.join("runs.csv"), notes).expect("written");
}

/// The job of the shared case, its tables where they are, its runs those of the folder.
fn write_job(frame: &StrainFrame, shared: &Path, folder: &Path) -> PathBuf {
    let text = std::fs::read_to_string(shared.join("job.toml")).expect("the job");
    let mut job: toml::Table = text.parse().expect("valid toml");
    let absolute = |v: &mut toml::Value| {
        if let toml::Value::String(s) = v
            && s.ends_with(".csv")
        {
            *s = shared.join(&*s).display().to_string();
        }
    };
    for section in ["sensitivity", "gauges"] {
        for (_, v) in job[section].as_table_mut().expect("a section") {
            absolute(v);
            for (_, v) in v.as_table_mut().into_iter().flatten() {
                absolute(v);
                for (_, v) in v.as_table_mut().into_iter().flatten() {
                    absolute(v);
                }
            }
        }
    }
    let set = |job: &mut toml::Table, section: &str, key: &str, value: toml::Value| {
        job[section]
            .as_table_mut()
            .expect("a section")
            .insert(key.into(), value);
    };
    set(
        &mut job,
        "measured",
        "noise_microstrain",
        frame.noise.into(),
    );
    let columns: toml::Table = frame
        .load_names
        .iter()
        .map(|n| (n.clone(), n.clone().into()))
        .chain([
            ("payload_mass".to_owned(), "payload_kg".into()),
            ("payload_x".to_owned(), "payload_x_m".into()),
        ])
        .collect();
    set(&mut job, "runs", "columns", columns.into());
    use strainbridge::reconcile::strain::{PayloadWeight, WheelForces};
    if frame.payload_weight == PayloadWeight::Missing {
        set(&mut job, "payload", "weight_in_model", false.into());
    }
    if frame.wheel_forces == WheelForces::FlatGroundModel {
        set(&mut job, "runs", "wheel_forces", "flat_ground_model".into());
    }
    let path = folder.join("job.toml");
    std::fs::write(&path, toml::to_string(&job).expect("toml")).expect("written");
    path
}

struct Found {
    /// Result of the first pass.
    result: Value,
    /// Folder of the case.
    folder: PathBuf,
    /// The case.
    frame: StrainFrame,
}

/// A case in which `effect` is hidden, reconciled on the first half of its runs.
fn found(effect: &str, size: f64, seed: u64) -> Option<Found> {
    let shared = hidden::shared()?.join("static/dev-s1");
    let base = doubled(&hidden::frame_of(&shared));
    let case = hide(&base, effect, size, Background::Clean, seed);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("extended_{effect}_{seed}"));
    let _ = std::fs::remove_dir_all(&folder);
    let n = base.n_runs() / 2;
    write_runs(&case.frame, 0..n, &folder);
    write_runs(&case.frame, n..2 * n, &folder.join("new"));
    let job = write_job(&case.frame, &shared, &folder);
    let (_, result) = run("reconcile", &job, &folder.join("out"));
    Some(Found {
        result,
        folder,
        frame: case.frame,
    })
}

fn assert_nothing_left(effect: &str, result: &Value) {
    assert_eq!(
        result["verdict"], "none",
        "{effect}: {} {}",
        result["named"], result["gap"]
    );
    let gap = |key: &str| result["gap"][key].as_f64().expect("a gap");
    assert!(
        gap("before") < AT_FLOOR * gap("floor"),
        "{effect}: {}",
        result["gap"]
    );
}

/// The extended job with the raw readings and notes of runs that were never seen.
fn with_new_runs(found: &Found, extended: &Path) -> PathBuf {
    let text = std::fs::read_to_string(extended).expect("the extended job");
    let mut job: toml::Table = text.parse().expect("valid toml");
    let n = found.frame.n_runs() / 2;
    let new =
        |file: &str| toml::Value::from(found.folder.join("new").join(file).display().to_string());
    let o = &found.frame.observations;
    let held: Vec<toml::Value> = (n..2 * n)
        .filter(|r| o.held_out[*r])
        .map(|r| o.runs[r].clone().into())
        .collect();
    let measured = job["measured"].as_table_mut().expect("[measured]");
    measured.insert("strain".into(), new("strain.csv"));
    measured.insert("hold_out".into(), held.into());
    let runs = job["runs"].as_table_mut().expect("[runs]");
    runs.insert("file".into(), new("runs.csv"));
    let path = extended.with_file_name("new_runs.toml");
    std::fs::write(&path, toml::to_string(&job).expect("toml")).expect("written");
    path
}

#[test]
fn the_extended_model_holds_every_kind_of_effect_on_runs_never_seen_too() {
    for (effect, size, seed) in [
        ("sign_flip", 1.0, 11),
        ("gauge_gain", 0.7, 12),
        ("zero_drift", 40.0, 13),
        ("gauge_swap", 1.0, 14),
        ("dead_channel", 1.0, 15),
        ("card_gain", 1.2, 16),
        ("gauge_angle", 90.0, 17),
        ("rail_stiffness", 20.0, 18),
        ("global_scale", 12.0, 19),
        ("payload_offset", 0.35, 20),
        ("unaccounted_mass", 900.0, 21),
        ("lateral_wheel_loads", 0.8, 22),
        ("thermal_uniform", 18.0, 23),
        ("thermal_gradient", 8.0, 24),
        ("payload_gravity_missing", 1.0, 25),
    ] {
        let Some(found) = found(effect, size, seed) else {
            return;
        };
        let r = &found.result;
        let named = r["named"].as_array().expect("names");
        assert_eq!(r["verdict"], "named", "{effect} {seed}: {}", r["gap"]);
        let extended = r["extended_model"].as_str();
        let extended = PathBuf::from(extended.unwrap_or_else(|| panic!("{effect}: {named:?}")));
        let again = run("reconcile", &extended, &found.folder.join("again"));
        assert_nothing_left(effect, &again.1);
        let (code, loads) = run("recover", &extended, &found.folder.join("recover"));
        assert_eq!(code, Some(0), "{effect}: {}", loads["findings"]);
        let new = with_new_runs(&found, &extended);
        let unseen = run("reconcile", &new, &found.folder.join("unseen"));
        assert_nothing_left(&format!("{effect}, new runs"), &unseen.1);
    }
}

/// Faults of channels are `[[correction]]` entries; readings stay those of the job.
#[test]
fn a_fault_of_a_channel_is_a_correction_of_the_extended_job() {
    for (effect, size, key, value) in [
        ("sign_flip", 1.0, "sign", Some(-1.0)),
        ("gauge_gain", 0.7, "gain", Some(0.7)),
        ("zero_drift", 80.0, "offset_microstrain", None),
        ("gauge_swap", 1.0, "exchanged_with", None),
        ("dead_channel", 1.0, "ignore", None),
    ] {
        let Some(found) = found(effect, size, 31) else {
            return;
        };
        let extended = found.result["extended_model"].as_str().expect("a job");
        let text = std::fs::read_to_string(extended).expect("the extended job");
        let job: toml::Table = text.parse().expect("valid toml");
        let list = job["correction"].as_array().expect("corrections");
        let entry = list.iter().find(|c| c.get(key).is_some());
        let entry = entry.unwrap_or_else(|| panic!("{effect}: {list:?}"));
        let number = entry[key]
            .as_float()
            .or(entry[key].as_integer().map(|i| i as f64));
        if let (Some(v), Some(number)) = (value, number) {
            // Noise of a gauge among the better three quarters: some per cent of its reading.
            assert!((number / v - 1.0).abs() < 0.1, "{effect}: {entry}");
        }
        assert!(
            job["measured"]["strain"]
                .as_str()
                .is_some_and(|s| s.ends_with("strain.csv") && !s.contains("extended")),
            "{effect}"
        );
    }
}

/// A note of one run may be wrong in several ways: the extended model holds the one that was found.
#[test]
fn the_note_that_was_wrong_is_the_one_that_is_put_right() {
    for seed in [41, 42, 43, 44] {
        let Some(found) = found("run_record", 0.8, seed) else {
            return;
        };
        let r = &found.result;
        if r["verdict"] != "named" {
            continue;
        }
        let extended = PathBuf::from(r["extended_model"].as_str().expect("a job"));
        let again = run("reconcile", &extended, &found.folder.join("again"));
        assert_nothing_left("run_record", &again.1);
    }
}

/// Ground that is not flat is no model of the structure: nothing is written, and it is said why.
#[test]
fn what_can_not_be_put_into_the_model_is_said() {
    let Some(found) = found("uneven_ground", 4.0, 51) else {
        return;
    };
    let r = &found.result;
    assert_eq!(r["named"], serde_json::json!(["uneven_ground"]));
    assert!(r["extended_model"].is_null());
    let findings = r["findings"].as_array().expect("findings");
    assert!(findings.iter().any(|f| f["code"] == "effect-not-in-model"));
}
