//! `calibrate` through the program: the examples of the guide, whose unknown runs were made with loads written here.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Exit code and `result.json` of a command, standard error.
fn run(command: &str, job: &Path, out: &Path) -> (Option<i32>, Value, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args([
            command.as_ref(),
            job.as_os_str(),
            "--out".as_ref(),
            out.as_os_str(),
        ])
        .output()
        .unwrap();
    let text = std::fs::read(out.join("result.json")).unwrap_or_default();
    let result = serde_json::from_slice(&text).unwrap_or(Value::Null);
    (
        done.status.code(),
        result,
        String::from_utf8_lossy(&done.stderr).into_owned(),
    )
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name)
        .join("calibrate.toml")
}

/// Value and sigma of a load in a run, as `recover` gives them.
fn load(result: &Value, run: &str, name: &str) -> (f64, f64) {
    let loads = result["loads"].as_array().unwrap();
    let found = loads
        .iter()
        .find(|l| l["run"] == run && l["name"] == name)
        .unwrap();
    (
        found["value"].as_f64().unwrap(),
        found["sigma"].as_f64().unwrap(),
    )
}

#[test]
fn trucks_that_nobody_weighed_are_weighed_by_the_bridge_within_their_intervals() {
    let folder = scratch("calibrate-bridge");
    let (code, result, said) = run("calibrate", &example("bridge"), &folder.join("cal"));
    assert_eq!(code, Some(0), "{said}");
    let c = &result["calibration"];
    assert_eq!(c["runs"], 12);
    assert_eq!(c["prior"], "none");
    assert_eq!(c["coverage"]["of"], 12);
    // Made with 3 % of scatter in size and a twentieth of a gauge's distance in place; noise of a hundredth of that.
    let scatter = c["repeat_scatter_rel"].as_f64().unwrap();
    assert!((0.015..0.1).contains(&scatter), "{scatter}");
    assert!(c["noise_rel"].as_f64().unwrap() < scatter / 3.0);
    let (code, result, said) = run(
        "recover",
        &folder.join("cal/calibrated.toml"),
        &folder.join("loads"),
    );
    assert_eq!(code, Some(0), "{said}");
    for (run, lane, truth) in [
        ("R13", "west", 310.0),
        ("R14", "middle", 150.0),
        ("R15", "east", 265.0),
    ] {
        let (value, sigma) = load(&result, run, lane);
        // Three sigma: no more than one of a few hundred lies outside.
        assert!(
            (value - truth).abs() < 3.0 * sigma,
            "{run}: {value} +- {sigma}, truth {truth}"
        );
        assert!(
            sigma < 0.1 * truth && sigma > 0.01 * truth,
            "{run}: {sigma}"
        );
    }
}

#[test]
fn a_payload_of_which_the_sum_alone_is_known_teaches_too() {
    let folder = scratch("calibrate-onboard");
    let (code, result, said) = run("calibrate", &example("onboard"), &folder.join("cal"));
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(
        result["calibration"]["runs"], 9,
        "eight weighed bay by bay, one by its sum"
    );
    let (code, result, said) = run(
        "recover",
        &folder.join("cal/calibrated.toml"),
        &folder.join("loads"),
    );
    assert_eq!(code, Some(0), "{said}");
    for (run, bay, truth) in [
        ("L1", "front", 12.0),
        ("L1", "rear", 31.0),
        ("L2", "front", 33.0),
        ("L2", "rear", 5.0),
    ] {
        let (value, sigma) = load(&result, run, bay);
        assert!(
            (value - truth).abs() < 3.5 * sigma,
            "{run} {bay}: {value} +- {sigma}, truth {truth}"
        );
    }
}

#[test]
fn runs_that_do_not_determine_s_are_said_so_and_known_loads_that_are_missing_are_a_fault() {
    let folder = scratch("calibrate-undetermined");
    for file in ["strain.csv", "runs.csv", "calibrate.toml"] {
        std::fs::copy(example("bridge").with_file_name(file), folder.join(file)).unwrap();
    }
    let job = folder.join("calibrate.toml");
    let text = std::fs::read_to_string(&job).unwrap();
    let west = text.replace(
        "[calibration]",
        "[calibration]\nruns = [\"R01\", \"R02\", \"R03\", \"R04\"]",
    );
    std::fs::write(&job, &west).unwrap();
    let (code, result, _) = run("calibrate", &job, &folder.join("out"));
    assert_eq!(code, Some(1));
    let findings = result["findings"].as_array().unwrap();
    assert!(
        findings
            .iter()
            .any(|f| f["code"] == "calibration-not-determined"),
        "{findings:?}"
    );
    std::fs::write(
        &job,
        text.replace("[calibration]", "[calibration]\nruns = [\"R13\"]"),
    )
    .unwrap();
    let (code, _, said) = run("calibrate", &job, &folder.join("out"));
    assert_eq!(code, Some(2));
    assert!(
        said.contains("runs.csv:14: run: run `R13` is to teach and its loads are not known"),
        "{said}"
    );
}
