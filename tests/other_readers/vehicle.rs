//! Accelerations in files of other programs.

use crate::python::read_by;
use crate::support;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Returns the parameters that `identify` finds with the record in `data` and the held-out record in `holdout`.
fn identify_parameters(dir: &Path, text: &str, ending: &str) -> Vec<Value> {
    let job = dir.join(format!("job_{ending}.toml"));
    let text = text
        .replace("data.csv", &format!("data_real.{ending}"))
        .replace("holdout.csv", &format!("holdout_real.{ending}"));
    std::fs::write(&job, text).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["identify", job.to_str().unwrap(), "--json"])
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(0), "{error}");
    let result: Value = serde_json::from_slice(&done.stdout).unwrap();
    result["parameters"].as_array().unwrap().clone()
}

#[test]
fn accelerations_in_rpc_iii_parquet_and_mdf4_give_the_parameters_of_the_table() {
    let Some(case) = support::find_shared_path("hidden_effects/dynamics/dev-d1/job.toml") else {
        return;
    };
    let text = std::fs::read_to_string(&case).unwrap();
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("accelerations");
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).unwrap();
    let paths = ["data", "holdout"].map(|name| {
        let target = dir.join(format!("{name}_real.csv"));
        let table = std::fs::read(case.with_file_name(format!("{name}.csv"))).unwrap();
        std::fs::write(&target, table).unwrap();
        target.to_str().unwrap().to_owned()
    });
    let paths = paths.each_ref().map(String::as_str);
    if read_by("read_exchange.py", &paths).is_none() || read_by("read_records.py", &paths).is_none()
    {
        return;
    }
    let expected = identify_parameters(&dir, &text, "csv");
    let mut endings = vec!["rsp"];
    if cfg!(feature = "parquet") {
        endings.push("parquet");
    }
    if cfg!(feature = "mdf") {
        endings.push("mf4");
    }
    for ending in endings {
        let read = identify_parameters(&dir, &text, ending);
        assert!(!expected.is_empty() && read.len() == expected.len());
        for (got, e) in read.iter().zip(&expected) {
            assert_eq!(got["name"], e["name"]);
            let [a, b, sigma] = [&got["value"], &e["value"], &e["sigma"]].map(|v| v.as_f64());
            let (Some(a), Some(b)) = (a, b) else {
                assert_eq!(a, b, "{ending} {}", e["name"]);
                continue;
            };
            // 32-bit reals change an estimate far less than its uncertainty.
            let allowed = 0.01 * sigma.unwrap_or(b.abs());
            assert!(
                (a - b).abs() <= allowed,
                "{ending} {}: {a} for {b}",
                e["name"]
            );
        }
    }
}
