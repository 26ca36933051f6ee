//! Reconcile on measured records: a bridge with a lowered support, and a truck with two contradictory gauges.

use super::hidden::{self, plain_frame};
use std::path::Path;
use strainbridge::reconcile::strain::{GaugeFacts, PayloadWeight, StrainFrame, Wiring, examine};
use strainbridge::reconcile::{Cause, Observations, Verdict, evaluate_cause_sets};

/// Returns the columns of a record by name, with rows in time.
fn record(dir: &Path, file: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(dir.join("real").join(file)).expect("a record");
    let mut lines = text.lines();
    let header = lines
        .next()
        .expect("a header")
        .split(',')
        .map(str::to_owned);
    let row = |l: &str| l.split(',').map(|v| v.parse().expect("a number")).collect();
    (header.collect(), lines.map(row).collect())
}

/// Returns means over seconds `from..to` of force 1, force 2, strain (NaN if the record has none) and air temperature.
fn means(dir: &Path, file: &str, from: f64, to: f64) -> ([f64; 3], f64) {
    let (header, rows) = record(dir, file);
    let mean = |name: &str| {
        let Some(c) = header.iter().position(|h| h == name) else {
            return f64::NAN;
        };
        let kept: Vec<f64> = rows
            .iter()
            .filter(|r| r[0] >= from && r[0] < to)
            .map(|r| r[c])
            .collect();
        kept.iter().sum::<f64>() / kept.len() as f64
    };
    (
        ["force1_kN", "force2_kN", "strain_ue"].map(mean),
        mean("air_C"),
    )
}

/// Run of the bridge: file, start and end in seconds, and whether the support is lowered.
struct Window(&'static str, f64, f64, bool);

fn bridge(dir: &Path, windows: &[Window], held_out: &[usize]) -> (Observations, [Cause; 2]) {
    let mut observations = Observations {
        channels: ["force 1", "force 2", "strain"].map(str::to_owned).to_vec(),
        runs: Vec::new(),
        values: Vec::new(),
        held_out: Vec::new(),
    };
    let (mut settlement, mut air) = (Vec::new(), Vec::new());
    for (k, Window(file, from, to, lowered)) in windows.iter().enumerate() {
        let (readings, degrees) = means(dir, file, *from, *to);
        observations.runs.push(format!("{file} {from}"));
        observations.values.extend(readings);
        observations.held_out.push(held_out.contains(&k));
        settlement.push(f64::from(u8::from(*lowered)));
        air.push(degrees);
    }
    let cause = |name: &str, values| Cause {
        name: name.to_owned(),
        values,
    };
    (
        observations,
        [
            cause("settlement", settlement),
            cause("air temperature", air),
        ],
    )
}

const BEFORE: &str = "munich_ref_support_load_01.csv";
const AFTER: &str = "munich_support_load_01.csv";
const LOWERING: &str = "munich_support_01_lowering_01.csv";
const LOWERED: &str = "munich_support_01_lowering_02.csv";
/// Traffic changes minute means by some kN and microstrain. The scatter within one stage is 2.5 to 3.9.
const NOISE: [f64; 3] = [3.0; 3];

#[test]
fn on_stage_means_of_the_bridge_settlement_and_temperature_are_alternatives_and_the_lowering_record_is_asked_for()
 {
    let Some(dir) = hidden::find_shared_folder() else {
        return;
    };
    let stages = [
        Window(BEFORE, 0.0, 1e9, false),
        Window(AFTER, 0.0, 1e9, true),
    ];
    let (observations, causes) = bridge(&dir, &stages, &[]);
    let outcome = evaluate_cause_sets(&observations, &NOISE, &causes);
    assert_eq!(outcome.verdict, Verdict::Unknown);
    let rivals: Vec<String> = outcome.rivals.iter().map(|r| r.names.join("+")).collect();
    assert_eq!(rivals.len(), 2, "{rivals:?}");
    for name in ["settlement", "air temperature"] {
        assert!(rivals.iter().any(|r| r == name), "{rivals:?}");
        assert!(outcome.next_measurement.contains(name));
    }
    assert!(
        outcome.next_measurement.contains("with time stamps"),
        "{}",
        outcome.next_measurement
    );
}

#[test]
fn with_the_lowering_record_the_settlement_is_named_and_the_temperature_is_not() {
    let Some(dir) = hidden::find_shared_folder() else {
        return;
    };
    // The air warms by 0.4 degrees before the support is lowered. The temperature is constant while the support is
    // lowered.
    let mut windows = vec![
        Window(BEFORE, 0.0, 1e9, false),
        Window(AFTER, 0.0, 1e9, true),
    ];
    windows.extend((0..6).map(|k| {
        Window(
            LOWERING,
            60.0 * f64::from(k),
            60.0 * f64::from(k + 1),
            false,
        )
    }));
    windows.extend(
        (16..20).map(|k| Window(LOWERING, 60.0 * f64::from(k), 60.0 * f64::from(k + 1), true)),
    );
    windows.extend(
        (1..7).map(|k| Window(LOWERED, 60.0 * f64::from(k), 60.0 * f64::from(k + 1), true)),
    );
    let (observations, causes) = bridge(&dir, &windows, &[4, 7, 9, 13, 16]);
    let outcome = evaluate_cause_sets(&observations, &NOISE, &causes);
    assert_eq!(outcome.verdict, Verdict::Named);
    assert_eq!(outcome.sets[0].names, ["settlement"]);
    let of = |names: &[&str]| {
        outcome
            .sets
            .iter()
            .find(|s| s.names == names)
            .expect("every set is weighed")
    };
    let (settlement, air) = (of(&["settlement"]), of(&["air temperature"]));
    assert!(settlement.log_evidence > air.log_evidence + 5.0);
    // In the held-out minutes, the residual comes from traffic, and from the second record, in which the support was
    // slightly lower.
    assert!(settlement.gap < 0.3 * of(&[]).gap, "{}", settlement.gap);
    assert!(
        settlement.gap < 0.5 * air.gap,
        "{} {}",
        settlement.gap,
        air.gap
    );
    // Between the means of both stages, the support forces fall by 23 and 43 kN, and the strain of the girder rises by
    // 34 microstrain.
    for (slope, expected) in settlement.slopes[0].iter().zip([-23.4, -42.7, 34.3]) {
        assert!(
            (slope.0 - expected).abs() < 3.0 * NOISE[0],
            "{slope:?} {expected}"
        );
    }
}

#[test]
fn the_command_asks_for_the_record_that_separates_two_causes_and_writes_a_page() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("reconcile_causes");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("written");
    // Rounded means of the two stages of the bridge.
    write(
        "strain.csv",
        "run,force1,force2,strain\nbefore,238.59,237.93,1.51\nafter,215.19,195.27,35.79\n",
    );
    write("runs.csv", "run,lowered,air_C\nbefore,0,2.0\nafter,1,4.0\n");
    write(
        "job.toml",
        "title = \"Bridge\"\nunits = \"m-kg-s\"\n[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 3.0\n[runs]\nfile = \"runs.csv\"\n\
         [reconcile]\npath = \"static\"\ncauses = { settlement = \"lowered\", temperature = \"air_C\" }\n",
    );
    let done = std::process::Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["reconcile", "--json"])
        .arg(folder.join("job.toml"))
        .output()
        .expect("the program runs");
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let result: serde_json::Value = serde_json::from_slice(&done.stdout).expect("valid json");
    assert_eq!(result["verdict"], "unknown");
    assert_eq!(result["named"], serde_json::json!([]));
    let rivals = result["rivals"].as_array().expect("a list");
    assert_eq!(rivals.len(), 2);
    assert!(rivals.iter().all(|r| r["indistinguishable"] == true));
    let next = result["next_measurement"].as_str().expect("words");
    assert!(
        next.contains("settlement") && next.contains("temperature"),
        "{next}"
    );
    assert!(folder.join("job.out/report.html").exists());
    // Columns of causes may have units, in the header or in a row below it.
    for head in [
        "run,lowered [-],air_C [degC]",
        "run,lowered,air_C\n-,-,degC",
    ] {
        write("runs.csv", &format!("{head}\nbefore,0,2.0\nafter,1,4.0\n"));
        let done = std::process::Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .args(["reconcile", "--json", "--out"])
            .arg(folder.join("units"))
            .arg(folder.join("job.toml"))
            .output()
            .expect("the program runs");
        let printed = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.success(), "{head}: {printed}");
        let other: serde_json::Value = serde_json::from_slice(&done.stdout).expect("valid json");
        assert_eq!(other["rivals"], result["rivals"], "{head}");
    }
}

/// Payload from each gauge alone for two runs (kN), tables C.1 and C.2 of the thesis.
const ESTIMATES: [(&str, [f64; 2]); 6] = [
    ("12", [281.064, -940.252]),
    ("13", [-380.649, -2599.416]),
    ("14", [34.154, 58.798]),
    ("15", [66.457, 35.757]),
    ("16", [27.959, 119.325]),
    ("17", [31.933, 56.215]),
];
/// Payload on the wheels, kN.
const ON_THE_TRUCK: [f64; 2] = [32.255, 54.414];
/// Change of these gauges between runs 1 and 2 that the thesis calls sensitive, at least, microstrain.
const LEAST_CHANGE: f64 = 15.0;

#[test]
fn gauges_12_and_13_of_the_thesis_are_unfit_for_the_payload_and_no_gain_or_sign_explains_them() {
    // Strain per kN that the estimate of run 2 implies for a change of 15 microstrain. At 12 and 13 it is a tenth of
    // the value at 14 and 17.
    let per_kn: Vec<f64> = ESTIMATES
        .iter()
        .map(|(_, e)| (LEAST_CHANGE / e[0]).abs())
        .collect();
    let readings = (0..2).flat_map(|run| {
        ESTIMATES
            .iter()
            .zip(&per_kn)
            .map(move |((_, e), s)| e[run] * s)
    });
    let observations = Observations {
        channels: ESTIMATES.iter().map(|e| e.0.to_owned()).collect(),
        runs: vec!["Run 2".into(), "Run 3".into()],
        values: readings.collect(),
        held_out: vec![false; 2],
    };
    let gauges = ESTIMATES
        .iter()
        .map(|e| GaugeFacts {
            name: e.0.to_owned(),
            wiring: Wiring::Bending,
            angle_deg: 0.0,
            position: None,
        })
        .collect();
    let load_names = vec!["payload".into()];
    let influence = per_kn
        .iter()
        .flat_map(|s| [*s, 0.0, 0.0, 0.0, 0.0])
        .collect();
    let loads = ON_THE_TRUCK.to_vec();
    let frame = StrainFrame {
        payload_weight: PayloadWeight::Missing,
        noise: 2.0,
        load_noise: 0.5,
        model_rel: 0.1,
        ..plain_frame(observations, gauges, load_names, influence, loads)
    };
    let outcome = examine(&frame, &[]);
    // The estimates are 281 and -381 kN in one run, -940 and -2599 kN in the next. Their ratio to the load varies, so
    // no gain, sign or angle fits.
    assert_eq!(outcome.verdict, Verdict::Unknown);
    assert!(outcome.effects.is_empty());
    let mut worst: Vec<&str> = outcome
        .gauges_off_before
        .iter()
        .map(|m| m.name.as_str())
        .collect();
    worst.truncate(2);
    worst.sort_unstable();
    assert_eq!(worst, ["12", "13"]);
    assert!(!outcome.remains.is_empty() && outcome.next_measurement != "none needed");
    // Nothing is reported for 14 and 17. They give the payload within a tenth in both runs.
    for fit in ["14", "17"] {
        assert!(
            outcome.gauges_off_before.iter().all(|m| m.name != fit),
            "{fit}"
        );
    }
}
