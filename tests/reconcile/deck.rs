//! Cases whose effect is found through the solver, from the job to the extended deck.

use super::hidden;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn run(command: &str, job: &Path, out: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .arg(command)
        .arg(job)
        .arg("--out")
        .arg(out)
        // The program writes nothing next to the cases of ../shared.
        .arg("--no-cache")
        .output()
        .expect("the program runs")
}

fn result(out: &Path) -> Value {
    let text = std::fs::read_to_string(out.join("result.json")).expect("result.json");
    serde_json::from_str(&text).expect("valid json")
}

/// Returns the folder of a case of ../shared.
fn case(name: &str) -> Option<PathBuf> {
    Some(hidden::find_shared_folder()?.join("deck").join(name))
}

/// Reconciles a case of ../shared. Returns its result, its output folder, and the truth.
fn reconcile_case(name: &str) -> Option<(Value, PathBuf, Value)> {
    let dir = case(name)?;
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("reconcile_{name}"));
    let _ = std::fs::remove_dir_all(&out);
    let done = run("reconcile", &dir.join("job.toml"), &out);
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let truth = dir.with_file_name("truth").join(format!("{name}.json"));
    let truth = std::fs::read_to_string(truth);
    let truth = serde_json::from_str(&truth.expect("the truth")).expect("valid json");
    Some((result(&out), out, truth))
}

/// Returns the fields on the first line of the cards that begin with `name`. Fields have eight or sixteen columns.
fn cards(deck: &str, name: &str) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    for line in deck.lines() {
        let Some(rest) = line.strip_prefix(name) else {
            continue;
        };
        let width = if rest.starts_with('*') { 16 } else { 8 };
        let body = line.get(8..72.min(line.len())).unwrap_or_default();
        let fields = body.as_bytes().chunks(width);
        let field = |f: &[u8]| String::from_utf8_lossy(f).trim().to_owned();
        found.push(fields.map(field).collect());
    }
    found
}

/// Returns the thickness of each PSHELL.
fn thicknesses(deck: &str) -> BTreeMap<u32, f64> {
    let number = |f: &String| f.parse::<f64>().expect("a thickness");
    let all = cards(deck, "PSHELL");
    assert!(!all.is_empty());
    let pair = |f: &Vec<String>| (f[0].parse().expect("an id"), number(&f[2]));
    all.iter().map(pair).collect()
}

/// Returns (before^2 - after^2) / (before^2 - left^2), where `left` is the gap that remains if the effect is known. The
/// author of the case states `left`.
fn closed_gap_share(result: &Value, truth: &Value) -> f64 {
    let square = |v: &Value| v.as_f64().unwrap_or(f64::NAN).powi(2);
    let before = square(&truth["gap_before"]);
    assert!((square(&result["gap"]["before"]) - before).abs() < 1e-3 * before);
    (before - square(&result["gap"]["after"])) / (before - square(&truth["gap_when_known"]))
}

#[test]
fn a_zone_15_percent_thicker_is_found_through_the_solver_and_its_deck_solves_and_recovers() {
    let Some((found, out, truth)) = reconcile_case("dev-f1") else {
        return;
    };
    assert_eq!(found["named"], serde_json::json!(["rail_stiffness:L4"]));
    let effect = &found["effects"][0];
    let (size, sigma) = (effect["size"].as_f64(), effect["sigma"].as_f64());
    let (size, sigma) = (size.expect("a size"), sigma.expect("its sigma"));
    // The true thickness is 1.15 times the thickness of the model.
    assert!(
        (size - 15.0).abs() < 3.0 * sigma && sigma < 3.0,
        "{size} +- {sigma}"
    );
    assert!(closed_gap_share(&found, &truth) > 0.7, "{}", found["gap"]);
    assert!(found["gap"]["explained_share"].as_f64().expect("a share") > 0.7);
    let job = out.join("job_extended.toml");
    let deck = std::fs::read_to_string(out.join("deck_extended.bdf")).expect("the extended deck");
    // The thickness of property 14 changes by the identified size. The other properties are unchanged.
    let nominal = std::fs::read_to_string(case("dev-f1").expect("the case").join("nominal.bdf"));
    let (before, after) = (thicknesses(&nominal.expect("the deck")), thicknesses(&deck));
    assert_eq!(before.len(), after.len());
    for (id, thickness) in &before {
        let factor = if *id == 14 { 1.0 + size / 100.0 } else { 1.0 };
        let ratio = after[id] / thickness;
        // A field of the card has seven digits.
        assert!((ratio / factor - 1.0).abs() < 1e-6, "{id}: {ratio}");
    }
    for (command, table) in [("solve", "results.op2"), ("recover", "loads.csv")] {
        let folder = out.join(command);
        let done = run(command, &job, &folder);
        let printed = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(0), "{command}: {printed}");
        assert!(folder.join(table).exists(), "{command}");
    }
}

#[test]
fn a_turned_sign_is_found_on_a_deck_whose_mesh_makes_two_percent_and_nothing_else_is_named() {
    let Some((found, out, truth)) = reconcile_case("dev-f2") else {
        return;
    };
    assert_eq!(found["named"], serde_json::json!(["sign_flip:G09"]));
    assert!(closed_gap_share(&found, &truth) > 0.7, "{}", found["gap"]);
    // By the finer mesh of another program, the mesh alone causes 2.2 %. The reference mesh here is only twice as fine.
    let mesh = found["gap"]["mesh"].as_f64().expect("a number");
    let known = truth["model_error_gap"].as_f64().expect("a number");
    assert!((mesh - known).abs() < 0.3 * known, "{mesh} {known}");
    let done = run(
        "recover",
        &out.join("job_extended.toml"),
        &out.join("recover"),
    );
    let printed = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(0), "{printed}");
    // The correction applies to the channel in all readings, including future ones. No further effect remains to
    // identify.
    let job = out.join("job_extended.toml");
    let text = std::fs::read_to_string(&job).expect("the extended job");
    let table: toml::Table = text.parse().expect("valid toml");
    let correction = &table["correction"][0];
    assert_eq!(correction["gauge"].as_str(), Some("G09"));
    assert_eq!(correction["sign"].as_integer(), Some(-1));
    let done = run("reconcile", &job, &out.join("again"));
    assert_eq!(done.status.code(), Some(0));
    let again = result(&out.join("again"));
    assert_eq!(again["verdict"], "none", "{}", again["named"]);
    let gap = |of: &Value, key: &str| of["gap"][key].as_f64().expect("a gap");
    assert!((gap(&again, "before") / gap(&found, "after") - 1.0).abs() < 0.01);
}

#[test]
fn without_zones_each_property_with_gauges_is_one_and_the_thicker_plate_is_named() {
    let Some(dir) = case("dev-f1") else {
        return;
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("reconcile_no_zones");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    for entry in std::fs::read_dir(&dir).expect("the case") {
        let path = entry.expect("an entry").path();
        if let (true, Some(name)) = (path.is_file(), path.file_name()) {
            std::fs::copy(&path, folder.join(name)).expect("a copy");
        }
    }
    let job = folder.join("job.toml");
    let text = std::fs::read_to_string(&job).expect("the job");
    let kept: Vec<&str> = text.lines().filter(|l| !l.starts_with("zones =")).collect();
    assert_eq!(kept.len() + 1, text.lines().count());
    std::fs::write(&job, kept.join("\n")).expect("the job without zones");
    let out = folder.join("out");
    let done = run("reconcile", &job, &out);
    assert_eq!(
        done.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    // In a plate 1.5 m long, property 14 is 15 % thicker.
    let found = result(&out);
    assert_eq!(found["verdict"], "named", "{}", found["remains"]);
    assert_eq!(
        found["named"],
        serde_json::json!(["rail_stiffness:property14"])
    );
    let effect = &found["effects"][0];
    let number = |key: &str| effect[key].as_f64().expect("a number");
    // Size in percent of the thickness, within 3.5 standard deviations.
    let off = (number("size") - 15.0) / number("sigma");
    assert!(off.abs() < 3.5, "{effect}");
}
