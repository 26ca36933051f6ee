//! Cases whose effect must be found through the solver, from job to extended deck.

use super::hidden;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn run(command: &str, job: &Path, out: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .arg(command)
        .arg(job)
        .arg("--out")
        .arg(out)
        // Nothing is written beside the cases of ../shared.
        .arg("--no-cache")
        .output()
        .expect("the program runs")
}

fn result(out: &Path) -> Value {
    let text = std::fs::read_to_string(out.join("result.json")).expect("result.json");
    serde_json::from_str(&text).expect("valid json")
}

/// Reconciles a case of ../shared; its result and the folder it was written to.
fn reconciled(case: &str) -> Option<(Value, PathBuf, Value)> {
    let dir = hidden::shared()?;
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("reconcile_{case}"));
    let _ = std::fs::remove_dir_all(&out);
    let done = run(
        "reconcile",
        &dir.join("deck").join(case).join("job.toml"),
        &out,
    );
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let truth = std::fs::read_to_string(dir.join("deck/truth").join(format!("{case}.json")));
    let truth = serde_json::from_str(&truth.expect("the truth")).expect("valid json");
    Some((result(&out), out, truth))
}

/// (before^2 - after^2) / (before^2 - left^2), with `left` what remains when the effect is known, by the case's author.
fn closed(result: &Value, truth: &Value) -> f64 {
    let square = |v: &Value| v.as_f64().unwrap_or(f64::NAN).powi(2);
    let before = square(&truth["gap_before"]);
    assert!((square(&result["gap"]["before"]) - before).abs() < 1e-3 * before);
    (before - square(&result["gap"]["after"])) / (before - square(&truth["gap_when_known"]))
}

#[test]
fn a_zone_15_percent_thicker_is_found_through_the_solver_and_its_deck_solves_and_recovers() {
    let Some((found, out, truth)) = reconciled("dev-f1") else {
        return;
    };
    assert_eq!(found["named"], serde_json::json!(["rail_stiffness:L4"]));
    let effect = &found["effects"][0];
    let (size, sigma) = (effect["size"].as_f64(), effect["sigma"].as_f64());
    let (size, sigma) = (size.expect("a size"), sigma.expect("its sigma"));
    // The truth is a thickness times 1.15.
    assert!(
        (size - 15.0).abs() < 3.0 * sigma && sigma < 3.0,
        "{size} +- {sigma}"
    );
    assert!(closed(&found, &truth) > 0.7, "{}", found["gap"]);
    assert!(found["gap"]["explained_share"].as_f64().expect("a share") > 0.7);
    let job = out.join("job_extended.toml");
    let deck = std::fs::read_to_string(out.join("deck_extended.bdf")).expect("the extended deck");
    assert!(
        deck.lines()
            .any(|l| l.starts_with("PSHELL*") && l.contains("14"))
    );
    for (command, table) in [("solve", "results.op2"), ("recover", "loads.csv")] {
        let folder = out.join(command);
        let done = run(command, &job, &folder);
        // 1: loads that were not asked for (the payload) strain the structure too, and `recover` says so.
        assert!(
            done.status.code().is_some_and(|c| c < 2),
            "{command}: {}",
            String::from_utf8_lossy(&done.stderr)
        );
        assert!(folder.join(table).exists(), "{command}");
    }
}

#[test]
fn a_turned_sign_is_found_on_a_deck_whose_mesh_makes_two_percent_and_nothing_else_is_named() {
    let Some((found, out, truth)) = reconciled("dev-f2") else {
        return;
    };
    assert_eq!(found["named"], serde_json::json!(["sign_flip:G09"]));
    assert!(closed(&found, &truth) > 0.7, "{}", found["gap"]);
    // The mesh alone makes 2.2 % by another program's finer mesh; ours is half as wide, not infinitely fine.
    let mesh = found["gap"]["mesh"].as_f64().expect("a number");
    let known = truth["model_error_gap"].as_f64().expect("a number");
    assert!((mesh - known).abs() < 0.3 * known, "{mesh} {known}");
    let done = run(
        "recover",
        &out.join("job_extended.toml"),
        &out.join("recover"),
    );
    assert!(done.status.code().is_some_and(|c| c < 2));
    // The channel is put right in all readings, those to come as well; nothing is left to name.
    let job = out.join("job_extended.toml");
    let text = std::fs::read_to_string(&job).expect("the extended job");
    let table: toml::Table = text.parse().expect("valid toml");
    let correction = &table["correction"][0];
    assert_eq!(correction["gauge"].as_str(), Some("G09"));
    assert_eq!(correction["sign"].as_integer(), Some(-1));
    let done = run("reconcile", &job, &out.join("again"));
    assert!(done.status.success());
    let again = result(&out.join("again"));
    assert_eq!(again["verdict"], "none", "{}", again["named"]);
    let gap = |of: &Value, key: &str| of["gap"][key].as_f64().expect("a gap");
    assert!((gap(&again, "before") / gap(&found, "after") - 1.0).abs() < 0.01);
}

#[test]
fn a_zone_that_the_job_does_not_name_is_no_set_of_gauges_and_cards() {
    let Some(dir) = hidden::shared() else {
        return;
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("reconcile_no_zones");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    for entry in std::fs::read_dir(dir.join("deck/dev-f1")).expect("the case") {
        let path = entry.expect("an entry").path();
        if let (true, Some(name)) = (path.is_file(), path.file_name()) {
            std::fs::copy(&path, folder.join(name)).expect("a copy");
        }
    }
    let job = folder.join("job.toml");
    let text = std::fs::read_to_string(&job).expect("the job");
    let kept: Vec<&str> = text.lines().filter(|l| !l.starts_with("zones =")).collect();
    assert!(kept.len() < text.lines().count());
    std::fs::write(&job, kept.join("\n")).expect("the job without zones");
    let out = folder.join("out");
    let done = run("reconcile", &job, &out);
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let found = result(&out);
    // A plate 1.5 m long is 15 % thicker: a region there, or nothing that is named; three gauges and a card are none of it.
    let named = found["named"].as_array().expect("a list");
    let region = |n: &Value| {
        n.as_str()
            .is_some_and(|n| n.starts_with("local_stiffness:"))
    };
    assert!(named.iter().all(region), "{named:?}");
    let verdict = if named.is_empty() { "unknown" } else { "named" };
    assert_eq!(found["verdict"], verdict, "{}", found["remains"]);
}
