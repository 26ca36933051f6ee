//! The extended model contains the effect. A second `reconcile` identifies nothing more, and the gap is at the expected
//! residual.
//!
//! The tests use the runs in which the effect was found, and further runs with raw readings. There is one case for each
//! kind of effect.

use super::hidden;
use hidden::generator::{Background, hide};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use strainbridge::reconcile::strain::StrainFrame;

/// Largest ratio of the gap to the expected residual. The latter is a root mean square of some hundred readings with a
/// scatter of a tenth.
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
    let printed = String::from_utf8_lossy(&done.stderr);
    assert!(code != Some(2), "{command} {}: {printed}", job.display());
    let result = serde_json::from_slice(&done.stdout).expect("valid json");
    (code, result)
}

/// Returns the frame with twice as many runs.
fn double_runs(base: &StrainFrame) -> StrainFrame {
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

/// Writes readings and recorded values of some runs as files into a folder.
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

/// Writes the job of the shared case with absolute paths to its tables. Its runs are the files in the folder.
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
    /// Result of the first `reconcile`.
    result: Value,
    /// Folder of the case.
    folder: PathBuf,
    /// Frame with the hidden effect.
    frame: StrainFrame,
    /// Hidden effects with their places.
    truth: Vec<String>,
}

impl Found {
    /// Fails if the hidden effect is neither identified nor listed as indistinguishable from the identified effect.
    fn assert_named(&self, effect: &str) {
        let r = &self.result;
        let printed = format!("{effect} {:?}: {} {}", self.truth, r["named"], r["rivals"]);
        assert_eq!(r["verdict"], "named", "{printed} {}", r["remains"]);
        let rivals = r["rivals"].as_array().expect("rivals");
        let alike = |t: &String| {
            let mut alike = rivals.iter().filter(|r| r["indistinguishable"] == true);
            alike.any(|r| r["id"] == t.as_str())
        };
        let is_named = r["named"] == serde_json::json!(self.truth);
        assert!(is_named || self.truth.iter().all(alike), "{printed}");
    }
}

/// Reconciles a case with the hidden `effect` on the first half of its runs.
fn reconcile_hidden_effect(effect: &str, size: f64, seed: u64) -> Option<Found> {
    // Tests run in parallel, and some hide the same effect.
    let test = std::thread::current()
        .name()
        .map_or_else(String::new, |n| n.replace("::", "_"));
    let name = format!("{test}_{effect}_{seed}");
    found_in(&name, (effect, size, seed), |_, _| String::new())
}

/// Reconciles a case with a hidden effect in the folder `name`.
///
/// `besides` may change the case and write further files into the folder. Its return value is appended to the job.
fn found_in(
    name: &str,
    (effect, size, seed): (&str, f64, u64),
    besides: impl FnOnce(&mut StrainFrame, &Path) -> String,
) -> Option<Found> {
    let shared = hidden::find_shared_folder()?.join("static/dev-s1");
    let once = hidden::frame_of(&shared);
    let n = once.n_runs();
    // Other runs cannot confirm an error in the record of one run.
    let of_runs = effect.starts_with("run_");
    let base = if of_runs { once } else { double_runs(&once) };
    let mut case = hide(&base, effect, size, Background::Clean, seed);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let more = besides(&mut case.frame, &folder);
    write_runs(&case.frame, 0..n, &folder);
    write_runs(&case.frame, n..base.n_runs(), &folder.join("new"));
    let job = write_job(&case.frame, &shared, &folder);
    let text = std::fs::read_to_string(&job).expect("the job");
    std::fs::write(&job, text + &more).expect("written");
    let (_, result) = run("reconcile", &job, &folder.join("out"));
    Some(Found {
        result,
        folder,
        frame: case.frame,
        truth: case.truth,
    })
}

/// Returns the path of the extended job. Fails if the effect is not identified.
fn extended_job_path(found: &Found, effect: &str) -> PathBuf {
    let r = &found.result;
    assert_eq!(
        r["verdict"], "named",
        "{effect}: {} {}",
        r["best_attempt"], r["remains"]
    );
    let path = r["extended_model"].as_str();
    PathBuf::from(path.unwrap_or_else(|| panic!("{effect}: {}", r["findings"])))
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

/// Writes the extended job with raw readings and records of further runs.
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
        ("uneven_ground", 4.0, 51),
    ] {
        let Some(found) = reconcile_hidden_effect(effect, size, seed) else {
            return;
        };
        found.assert_named(effect);
        let extended = extended_job_path(&found, effect);
        let again = run("reconcile", &extended, &found.folder.join("again"));
        assert_nothing_left(effect, &again.1);
        let (code, loads) = run("recover", &extended, &found.folder.join("recover"));
        assert_eq!(code, Some(0), "{effect}: {}", loads["findings"]);
        let new = with_new_runs(&found, &extended);
        let unseen = run("reconcile", &new, &found.folder.join("unseen"));
        assert_nothing_left(&format!("{effect}, new runs"), &unseen.1);
    }
}

/// Faults of channels become `[[correction]]` entries. The readings of the job are unchanged.
#[test]
fn a_fault_of_a_channel_is_a_correction_of_the_extended_job() {
    enum Is {
        /// The number, and the largest difference from it.
        About(f64, f64),
        True,
        /// The other channel of the exchange.
        Other,
    }
    for (effect, size, key, value) in [
        ("sign_flip", 1.0, "sign", Is::About(-1.0, 0.0)),
        // The noise of a gauge among the better three quarters is some per cent of its reading.
        ("gauge_gain", 0.7, "gain", Is::About(0.7, 0.07)),
        // Four standard deviations of noise of 2 microstrain over seven runs, and of forces that are not exact.
        (
            "zero_drift",
            80.0,
            "offset_microstrain",
            Is::About(80.0, 6.0),
        ),
        ("gauge_swap", 1.0, "exchanged_with", Is::Other),
        ("dead_channel", 1.0, "ignore", Is::True),
    ] {
        let Some(found) = reconcile_hidden_effect(effect, size, 31) else {
            return;
        };
        found.assert_named(effect);
        let extended = extended_job_path(&found, effect);
        let text = std::fs::read_to_string(extended).expect("the extended job");
        let job: toml::Table = text.parse().expect("valid toml");
        let list = job["correction"].as_array().expect("corrections");
        let [entry] = list.as_slice() else {
            panic!("{effect}: {list:?}");
        };
        let place = found.truth[0].split(':').nth(1).expect("a place");
        let (gauge, other) = place.split_once('+').unwrap_or((place, ""));
        assert_eq!(entry["gauge"].as_str(), Some(gauge), "{effect}: {entry}");
        let number = entry[key]
            .as_float()
            .or(entry[key].as_integer().map(|i| i as f64));
        match value {
            Is::About(v, apart) => {
                let number = number.unwrap_or_else(|| panic!("{effect}: {entry}"));
                // The zero can drift in both directions.
                let number = if effect == "zero_drift" {
                    number.abs()
                } else {
                    number
                };
                assert!((number - v).abs() <= apart, "{effect}: {entry}");
            }
            Is::True => assert_eq!(entry[key].as_bool(), Some(true), "{effect}"),
            Is::Other => assert_eq!(entry[key].as_str(), Some(other), "{effect}"),
        }
        assert!(
            job["measured"]["strain"]
                .as_str()
                .is_some_and(|s| s.ends_with("strain.csv") && !s.contains("extended")),
            "{effect}"
        );
    }
}

/// The record of one run may contain several errors. The extended model contains the error that was found.
#[test]
fn the_note_that_was_wrong_is_the_one_that_is_put_right() {
    for seed in [41, 42, 43, 44] {
        let Some(found) = reconcile_hidden_effect("run_record", 0.8, seed) else {
            return;
        };
        // A mass that is 80 % too large in one loaded run of ten exceeds the noise many times, for every seed.
        found.assert_named("run_record");
        let extended = extended_job_path(&found, "run_record");
        let again = run("reconcile", &extended, &found.folder.join("again"));
        assert_nothing_left("run_record", &again.1);
        // The recorded value of the run, and its replacement.
        let added = &found.result["added"][0];
        assert!(
            added["path"]
                .as_str()
                .is_some_and(|p| p.starts_with("runs_extended.csv: run R"))
        );
        // The replacement is the true mass, which is the recorded one / 1.8. For 2400 kg, four standard deviations are
        // a twentieth.
        let words = |key: &str| added[key].as_str().unwrap_or_default();
        let number = |key: &str| words(key).strip_suffix(" kg")?.parse::<f64>().ok();
        let [old, new] = ["old", "new"].map(|k| number(k).unwrap_or_else(|| panic!("{added}")));
        assert!((1.8 * new / old - 1.0).abs() < 0.05, "{added}");
    }
}

/// A channel fault that no entry can correct excludes the channel, also in future runs. Records of the present runs are
/// corrected.
#[test]
fn the_extended_model_holds_channels_that_come_and_go_and_notes_that_are_wrong() {
    for (effect, size, seed) in [
        ("gain_drift", 0.5, 61),
        ("cross_sensitivity", 0.5, 62),
        ("intermittent_channel", 1.0, 63),
        ("saturated_channel", 0.3, 64),
        ("wheel_scale", 25.0, 65),
        ("run_exchange", 1.0, 66),
    ] {
        let Some(found) = reconcile_hidden_effect(effect, size, seed) else {
            return;
        };
        if effect == "cross_sensitivity" {
            // The gauge and its neighbour are symmetric, left and right. Half of the neighbour's reading is therefore
            // equivalent to a gain of 1.5.
            let gauge = found.truth[0].split(':').nth(1).expect("a gauge");
            let named = &found.result["named"];
            let [leak, gain] = ["cross_sensitivity", "gauge_gain"].map(|e| format!("{e}:{gauge}"));
            assert!(
                *named == serde_json::json!([leak]) || *named == serde_json::json!([gain]),
                "{named}"
            );
        } else {
            found.assert_named(effect);
        }
        let job = extended_job_path(&found, effect);
        let again = run("reconcile", &job, &found.folder.join("again"));
        assert_nothing_left(effect, &again.1);
        if matches!(effect, "wheel_scale" | "run_exchange") {
            continue;
        }
        let new = with_new_runs(&found, &job);
        let unseen = run("reconcile", &new, &found.folder.join("unseen"));
        assert_nothing_left(&format!("{effect}, new runs"), &unseen.1);
    }
}

/// Adds 0.8 times a change of S that no effect of the library resembles, and writes the change as a table.
///
/// `named` converts the column names of S to those of the table.
fn own_hypothesis(
    frame: &mut StrainFrame,
    folder: &Path,
    named: impl Fn(&str) -> String,
) -> String {
    let mut numbers = hidden::drawn::Numbers(3);
    let (n_g, n_l, n_c) = (frame.n_gauges(), frame.n_loads(), frame.n_columns());
    let change: Vec<f64> = (0..n_g * n_l)
        .map(|i| 0.17 * numbers.next() * frame.influence[i / n_l * n_c + i % n_l].abs())
        .collect();
    let names: Vec<String> = frame.load_names.iter().map(|n| named(n)).collect();
    let mut table = format!("gauge,{}\n", names.join(","));
    for (g, row) in change.chunks_exact(n_l).enumerate() {
        let cells: Vec<String> = row.iter().map(|v| format!("{v:.9}")).collect();
        let _ = writeln!(table, "{},{}", frame.gauges[g].name, cells.join(","));
    }
    for file in ["own.csv", "other.csv"] {
        std::fs::write(folder.join(file), &table).expect("written");
        // The second table is upside down. The readings contain nothing similar to it.
        let lines: Vec<&str> = table.lines().collect();
        let cells = |l: &&str| {
            l.split_once(',')
                .map(|c| c.1.to_owned())
                .unwrap_or_default()
        };
        let upside_down: Vec<String> = (lines[1..].iter())
            .zip(lines[1..].iter().rev())
            .map(|(own, other)| {
                let gauge = own.split(',').next().unwrap_or_default();
                format!("{gauge},{}", cells(other))
            })
            .collect();
        table = format!("{}\n{}\n", lines[0], upside_down.join("\n"));
    }
    for r in 0..frame.n_runs() {
        for g in 0..n_g {
            let loads = &frame.loads[r * n_l..(r + 1) * n_l];
            let row = &change[g * n_l..(g + 1) * n_l];
            let strain: f64 = row.iter().zip(loads).map(|(a, f)| a * f).sum();
            frame.observations.values[r * n_g + g] += 0.8 * strain;
        }
    }
    "[[reconcile.effect]]\nid = \"bracket_loose\"\nsignature = \"own.csv\"\nprior = 1.0\n\
     [[reconcile.effect]]\nid = \"other_bracket\"\nsignature = \"other.csv\"\nprior = 1.0\n"
        .to_owned()
}

#[test]
fn a_table_of_ones_own_goes_into_s_and_leaves_the_job_the_others_stay() {
    let as_load = |load: &str| load.to_owned();
    let as_column = |load: &str| format!("FZ_{}", load.trim_end_matches(".FZ"));
    let spellings: [(&str, &dyn Fn(&str) -> String); 2] =
        [("load", &as_load), ("column", &as_column)];
    for (spelling, named) in spellings {
        let name = format!("extended_own_{spelling}");
        let Some(found) = found_in(&name, ("none", 0.0, 71), |f, d| own_hypothesis(f, d, named))
        else {
            return;
        };
        assert_eq!(
            found.result["named"],
            serde_json::json!(["bracket_loose"]),
            "{spelling}: {}",
            found.result["best_attempt"]
        );
        let effect = &found.result["effects"][0];
        let number = |key: &str| effect[key].as_f64().expect("a number");
        // Four standard deviations, because the noise is one random sample.
        assert!(
            (number("size") - 0.8).abs() < 4.0 * number("sigma"),
            "{effect}"
        );
        let job = extended_job_path(&found, spelling);
        let text = std::fs::read_to_string(&job).expect("the extended job");
        let table: toml::Table = text.parse().expect("valid toml");
        let left = table["reconcile"]["effect"].as_array().expect("effects");
        let ids: Vec<&str> = left.iter().filter_map(|e| e["id"].as_str()).collect();
        assert_eq!(ids, ["other_bracket"]);
        // Other tables still name their columns as S does.
        assert_eq!(
            table["sensitivity"]["columns"]["RR.FZ"].as_str(),
            Some("FZ_RR")
        );
        let again = run("reconcile", &job, &found.folder.join("again"));
        assert_nothing_left(spelling, &again.1);
        let new = with_new_runs(&found, &job);
        let unseen = run("reconcile", &new, &found.folder.join("unseen"));
        assert_nothing_left(&format!("{spelling}, new runs"), &unseen.1);
    }
}

/// Accepts a first effect. In further runs, the gauge with the largest readings has a reversed sign, which is accepted
/// as a second effect.
#[test]
fn two_effects_are_accepted_one_after_the_other() {
    let Some(mut found) = reconcile_hidden_effect("rail_stiffness", 20.0, 18) else {
        return;
    };
    let first = extended_job_path(&found, "rail_stiffness");
    let frame = &mut found.frame;
    let (n_g, n) = (frame.n_gauges(), frame.n_runs());
    let values = &mut frame.observations.values;
    let size = |g: &usize| (0..n).map(|r| values[r * n_g + g].powi(2)).sum::<f64>();
    let g = (0..n_g)
        .max_by(|a, b| size(a).total_cmp(&size(b)))
        .expect("a gauge");
    (0..n).for_each(|r| values[r * n_g + g] *= -1.0);
    let turned = format!("sign_flip:{}", frame.gauges[g].name);
    write_runs(frame, n / 2..n, &found.folder.join("new"));
    let second = with_new_runs(&found, &first);
    let (_, result) = run("reconcile", &second, &found.folder.join("second"));
    assert_eq!(
        result["named"],
        serde_json::json!([turned]),
        "{}",
        result["best_attempt"]
    );
    let third = PathBuf::from(result["extended_model"].as_str().expect("a job"));
    let (_, last) = run("reconcile", &third, &found.folder.join("third"));
    assert_nothing_left("both", &last);
}

/// "Held out" refers to runs that no fit uses. Without such runs, neither the page nor the result uses the term. The
/// page has a fixed order of sections.
#[test]
fn without_hold_out_nothing_is_called_held_out_and_the_page_goes_from_verdict_to_notes() {
    let Some(found) = reconcile_hidden_effect("sign_flip", 1.0, 81) else {
        return;
    };
    let text = std::fs::read_to_string(found.folder.join("job.toml")).expect("the job");
    let mut job: toml::Table = text.parse().expect("valid toml");
    let measured = job["measured"].as_table_mut().expect("[measured]");
    measured.remove("hold_out");
    let path = found.folder.join("all_runs.toml");
    std::fs::write(&path, toml::to_string(&job).expect("toml")).expect("written");
    let out = found.folder.join("all_runs");
    let (_, result) = run("reconcile", &path, &out);
    assert_eq!(result["named"], serde_json::json!(found.truth));
    assert_eq!(result["gap"]["basis"], "cross-validated");
    assert!(result["reduced_chi2"].get("held_out").is_none());
    let page = std::fs::read_to_string(out.join("report.html")).expect("the page");
    for text in [result.to_string(), page.clone()] {
        let text = text.to_lowercase();
        assert!(!text.contains("held-out") && !text.contains("held out"));
    }
    let at = |title: &str| page.find(&format!("<h2>{title}</h2>"));
    let places = [
        "Verdict",
        "Largest gaps",
        "What was added",
        "Gap before and after",
        "Scatter before and after",
        "The gap on the model",
        "Remaining gap",
    ]
    .map(|t| at(t).unwrap_or_else(|| panic!("no heading {t}")));
    assert!(places.is_sorted(), "{places:?}");
    let added = &result["added"][0];
    assert_eq!([&added["old"], &added["new"]], ["1", "-1"], "{added}");
    assert!(
        added["path"]
            .as_str()
            .is_some_and(|p| p.contains("[[correction]]"))
    );
}

/// Uneven ground becomes a load of the extended job, in the unit of its runs. It is refused together with measured
/// wheel forces, which include it already.
#[test]
fn uneven_ground_is_a_load_of_the_extended_job() {
    let Some(found) = reconcile_hidden_effect("uneven_ground", 4.0, 51) else {
        return;
    };
    let r = &found.result;
    assert_eq!(r["named"], serde_json::json!(["uneven_ground"]));
    let size = r["effects"][0]["size"].as_f64().expect("a size");
    let extended = extended_job_path(&found, "uneven_ground");
    let text = std::fs::read_to_string(&extended).expect("the extended job");
    let mut job: toml::Table = text.parse().expect("valid toml");
    let ground = job["runs"]["ground"].as_float().expect("a number");
    assert!((ground - size).abs() < 1e-9 * size, "{ground} {size}");
    let runs = job["runs"].as_table_mut().expect("[runs]");
    runs.insert("wheel_forces".into(), "measured".into());
    let path = extended.with_file_name("measured_forces.toml");
    std::fs::write(&path, toml::to_string(&job).expect("toml")).expect("written");
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .arg("check")
        .arg(&path)
        .output()
        .expect("the program runs");
    assert_eq!(done.status.code(), Some(2));
    let printed = String::from_utf8_lossy(&done.stderr);
    assert!(printed.contains("runs.ground"), "{printed}");
}
