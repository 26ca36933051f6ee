//! `identify` from job to result.json.

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
    let case = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/hidden_effects/dynamics/dev-d1/job.toml");
    if !case.exists() {
        eprintln!("skipped: {} is absent", case.display());
        return;
    }
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
