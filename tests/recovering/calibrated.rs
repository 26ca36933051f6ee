//! Commands on a calibrated job.
//!
//! `place` predicts the intervals of the gauges, `payload` weighs, and a gauge angle that is corrected already is not
//! corrected again.

use super::folder;
use super::supported::{deck, job};
use crate::drawn::Numbers;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

const LOADS: [&str; 4] = ["tip", "corner", "middle", "pull"];
/// Size of every load, N.
const SIZE: f64 = 50.0;

fn run(command: &str, job: &Path) -> (i32, Value, String) {
    let out = job.with_extension(format!("{command}.out"));
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args([command.as_ref(), job.as_os_str(), "--out".as_ref()])
        .arg(&out)
        .output()
        .unwrap();
    let result = std::fs::read(out.join("result.json")).unwrap_or_default();
    (
        done.status.code().unwrap_or(-1),
        serde_json::from_slice(&result).unwrap_or(Value::Null),
        String::from_utf8_lossy(&done.stderr).into_owned(),
    )
}

/// Calibrates a plate. Every gauge reads a few per cent more or less than its model predicts.
///
/// Each load acts alone in six runs with a scatter of 2 %. The last two runs, with all loads together, are not
/// calibration runs.
fn calibrate_plate(name: &str, more: &str) -> std::path::PathBuf {
    let dir = folder(name);
    let write = |name: &str, text: &str| std::fs::write(dir.join(name), text).unwrap();
    write("plate.bdf", &deck());
    write("model.toml", &job());
    let (code, _, printed) = run("sensitivity", &dir.join("model.toml"));
    assert_eq!(code, 0, "{printed}");
    let table = std::fs::read_to_string(dir.join("model.sensitivity.out/sensitivity.csv")).unwrap();
    let mut numbers = Numbers(7);
    let s: Vec<Vec<f64>> = table
        .lines()
        .skip(1)
        .map(|line| {
            let gain = 1.0 + 0.05 * numbers.draw_normal();
            let row = line.split(',').skip(1);
            row.map(|v| gain * v.parse::<f64>().unwrap()).collect()
        })
        .collect();
    let names: Vec<String> = (0..s.len()).map(|g| format!("G{g}")).collect();
    let mut runs = format!("run,{}\n", LOADS.join(","));
    let mut strain = format!("run,{}\n", names.join(","));
    let singles = (0..24).map(|i| {
        (
            format!("K{i}"),
            std::array::from_fn(|l| if l == i % 4 { SIZE } else { 0.0 }),
        )
    });
    let together = ["T1", "T2"].map(|n| (n.to_owned(), [SIZE; 4]));
    for (run, f) in singles.chain(together) {
        if run.starts_with('K') {
            let _ = writeln!(runs, "{run},{}", f.map(|v| v.to_string()).join(","));
        }
        strain += &run;
        for row in &s {
            let own: f64 = row.iter().zip(f).map(|(s, f)| s * f).sum();
            let scatter = 1.0 + 0.02 * numbers.draw_normal();
            let _ = write!(
                strain,
                ",{:.4}",
                own * scatter + 0.5 * numbers.draw_normal()
            );
        }
        strain.push('\n');
    }
    write("runs.csv", &runs);
    write("strain.csv", &strain);
    let with = format!(
        "[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\nmodel_uncertainty_rel = 0.05\nreference = \"none\"\n\
         [runs]\nfile = \"runs.csv\"\nunits = {{ force = \"N\" }}\n[calibration]\n{more}"
    );
    write("teach.toml", &(job() + &with));
    let (code, _, printed) = run("calibrate", &dir.join("teach.toml"));
    assert_eq!(code, 0, "{printed}");
    dir.join("teach.calibrate.out/calibrated.toml")
}

#[test]
fn place_plans_with_the_sigma_that_recover_states_by_the_calibrated_s() {
    let job = calibrate_plate(
        "calibrated-place",
        "[placement]\ngauges = 6\nnoise_microstrain = 0.5\nspacing = 5\n",
    );
    let (code, placed, printed) = run("place", &job);
    assert_eq!(code, 0, "{printed}");
    let (code, recovered, printed) = run("recover", &job);
    assert_eq!(code, 0, "{printed}");
    let list = recovered["loads"].as_array().unwrap();
    let planned = placed["installed"]["load_sigma"].as_array().unwrap();
    assert_eq!(planned.len(), LOADS.len());
    for p in planned {
        let stated = list
            .iter()
            .find(|l| l["run"] == "T1" && l["name"] == p["name"])
            .unwrap();
        let [p, r] = [p, stated].map(|l| l["sigma"].as_f64().unwrap());
        // In a run with all loads, the covariance between the columns of S changes sigma. Noise alone would give a
        // tenth of it.
        assert!((0.6..1.6).contains(&(p / r)), "{p} planned, {r} stated");
    }
}

#[test]
fn a_payload_is_weighed_by_the_calibrated_s_with_its_uncertainty() {
    let payload = "[payload]\ngrid = 50\nposition = \"known\"\nuse = [\"strain\"]\n";
    let job = calibrate_plate("calibrated-payload", payload);
    // The payload pulls down at the grid of load `tip`, whose column is calibrated.
    let s = std::fs::read_to_string(job.with_file_name("sensitivity.csv")).unwrap();
    let mut lines = s.lines();
    let names: Vec<&str> = lines
        .clone()
        .skip(1)
        .map(|l| l.split(',').next().unwrap())
        .collect();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let tip = header.iter().position(|h| *h == "tip").unwrap();
    let mut strain = format!("run,{}\nP1", names.join(","));
    for line in lines {
        let v: f64 = line.split(',').nth(tip).unwrap().parse().unwrap();
        let _ = write!(strain, ",{}", -SIZE * v);
    }
    strain.push('\n');
    std::fs::write(job.with_file_name("lift.csv"), strain).unwrap();
    let text = std::fs::read_to_string(&job).unwrap();
    let strain_key = text.lines().find(|l| l.starts_with("strain = ")).unwrap();
    std::fs::write(&job, text.replace(strain_key, "strain = \"lift.csv\"")).unwrap();
    let (code, r, printed) = run("payload", &job);
    assert_eq!(code, 0, "{printed}");
    let p = &r["payload"][0];
    let number = |key: &str| p[key].as_f64().unwrap_or_else(|| panic!("{key}: {p}"));
    let (force, sigma) = (number("force"), number("force_sigma"));
    assert!((force / SIZE - 1.0).abs() < 0.01, "{p}");
    // Nine gauges with errors of 2 %, calibrated with six runs, determine S within some tenths of a per cent. The error
    // is not zero.
    assert!(sigma > 0.001 * SIZE && sigma < 0.1 * SIZE, "{p}");
}

#[test]
fn a_gauge_that_was_turned_is_in_the_calibrated_s_and_not_turned_again() {
    let turned = "[[correction]]\ngauge = \"G2\"\nangle_deg = 5.0\n[[correction]]\ngauge = \"G4\"\ngain = 1.1\nangle_deg = -3.0\n";
    let job = calibrate_plate("calibrated-turned", turned);
    let text = std::fs::read_to_string(&job).unwrap();
    assert!(
        !text.contains("angle_deg = 5") && !text.contains("angle_deg = -3"),
        "{text}"
    );
    assert!(text.contains("gain = 1.1"), "{text}");
    let (code, r, printed) = run("recover", &job);
    assert_eq!(code, 0, "{printed}");
    assert_eq!(r["loads"].as_array().unwrap().len(), 26 * LOADS.len());
}
