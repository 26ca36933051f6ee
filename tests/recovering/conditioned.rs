//! `[conditioning]`: recovers the applied loads from readings with drift, spikes, offset, apparent thermal strain and
//! mains hum.

use crate::drawn::Numbers;
use crate::in_fleet::{check_extremes, fleet_and_extremes};
use std::f64::consts::TAU;
use std::fmt::Write;
use strainbridge::host::context::InMemory;
use strainbridge::{Context, Job, Severity};

const RATE: f64 = 200.0;
const SAMPLES: usize = 8000;
const S: [[f64; 2]; 4] = [[0.10, 0.02], [0.02, 0.10], [0.05, 0.05], [0.08, -0.03]];
const THERMAL: f64 = 1.4;
const NOISE: f64 = 0.5;

/// Returns the loads in N. They are zero in the first five seconds.
fn loads(t: f64) -> [f64; 2] {
    let moves = if t < 5.0 { 0.0 } else { 1.0 };
    [
        moves * 900.0 * (TAU * 0.7 * t).sin(),
        moves * 500.0 * (TAU * 1.3 * t).cos(),
    ]
}

fn temperature(t: f64) -> f64 {
    21.0 + 6.0 * (t / 40.0).powi(2)
}

/// Faults of the logger by gauge: offset, drift per second, and amplitude of a hum of 50 Hz, microstrain.
const FAULTS: [[f64; 3]; 4] = [
    [30.0, 0.5, 2.0],
    [-12.0, -0.3, 2.0],
    [4.0, 0.0, 2.0],
    [0.0, 0.8, 2.0],
];

/// Returns a strain table with the faults that `on` enables: thermal strain, offset, drift, hum, spikes.
fn record(on: [bool; 5]) -> String {
    let mut numbers = Numbers(5);
    let mut out = String::from("time,G1,G2,G3,G4,T1\n");
    let [thermal, offset, drift, hum, spikes] = on;
    for i in 0..SAMPLES {
        let t = i as f64 / RATE;
        let f = loads(t);
        let _ = write!(out, "{t:.4}");
        for (g, s) in S.iter().enumerate() {
            let [zero, slope, wave] = FAULTS[g];
            let mut strain = s[0] * f[0] + s[1] * f[1] + NOISE * numbers.draw_normal();
            strain += f64::from(u8::from(thermal)) * THERMAL * temperature(t);
            strain += f64::from(u8::from(offset)) * zero;
            strain += f64::from(u8::from(drift)) * slope * t;
            strain += f64::from(u8::from(hum)) * wave * (TAU * 50.0 * t).sin();
            if spikes && i % 1000 == 250 + g {
                strain += 800.0;
            }
            let _ = write!(out, ",{strain:.5}");
        }
        let _ = writeln!(out, ",{:.4}", temperature(t));
    }
    out
}

fn job(more: &str) -> String {
    format!(
        "units = \"m-kg-s\"\nload = [{{ name = \"left\" }}, {{ name = \"right\" }}]\nsensitivity = {{ file = \"s.csv\" }}\n\
         measured = {{ strain = \"strain.csv\", noise_microstrain = {NOISE}, reference = \"none\" }}\n{more}"
    )
}

fn files(on: [bool; 5], more: &str) -> InMemory {
    let mut s = String::from("gauge,left,right\n");
    for (g, row) in S.iter().enumerate() {
        let _ = writeln!(s, "G{},{},{}", g + 1, row[0], row[1]);
    }
    InMemory::default()
        .with_file("s.csv", s)
        .with_file("strain.csv", record(on))
        .with_file("job.toml", job(more))
}

/// Returns the largest error of a load, the share of intervals that contain the true load, and the outcome as JSON.
fn recover(on: [bool; 5], more: &str) -> (f64, f64, serde_json::Value) {
    let files = files(on, more);
    let job = Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
    let got =
        strainbridge::recover(&job, &Context::new(&files)).unwrap_or_else(|f| panic!("{f:?}"));
    let history = got.answer.record().unwrap().history.as_ref().unwrap();
    let (mut worst, mut inside, mut all) = (0.0_f64, 0, 0);
    for row in history.rows() {
        let expected = loads(row.time);
        // A filter smears the step of the loads after five seconds.
        if (row.time - 5.0).abs() < 0.5 || row.time < 0.5 || row.time > 39.5 {
            continue;
        }
        for (load, expected) in row.loads.iter().zip(expected) {
            let [value, low, high] = load.unwrap();
            worst = worst.max((value - expected).abs());
            inside += usize::from((low..=high).contains(&expected));
            all += 1;
        }
    }
    let text = serde_json::to_string(&got.answer).unwrap();
    (
        worst,
        f64::from(inside as u32) / f64::from(all),
        serde_json::from_str(&text).unwrap(),
    )
}

const ALL: &str = "[conditioning]\nspikes = true\ntemperature = { channel = \"T1\", microstrain_per_degC = 1.4 }\n\
                   zero_s = [0.5, 4.5]\ndrift = \"linear\"\nlow_pass_hz = 20.0\n";

#[test]
fn faults_of_the_logger_are_removed_and_each_step_states_its_change() {
    let on = [true, true, true, true, true];
    let (raw, held, bare) = recover(on, "");
    assert!(raw > 500.0 && held < 0.6, "{raw} {held}");
    assert!(bare.get("conditioning").is_none());
    let (worst, held, got) = recover(on, ALL);
    // The loads themselves have a slope in a least squares fit. 900 N at 0.7 Hz give up to 1.5 N per second over 40 s,
    // and the fitted line includes it.
    println!("{worst} {held}");
    assert!(worst < 22.0, "{worst}");
    assert!(held > 0.9, "{held}");
    let steps = got["conditioning"].as_array().unwrap();
    let named = |name: &'static str| steps.iter().filter(move |s| s["step"] == name);
    for step in ["spikes", "temperature", "zero", "drift", "low_pass"] {
        assert_eq!(named(step).count(), 4, "{step}: {got}");
    }
    assert!(named("spikes").all(|s| s["samples"] == 8), "{steps:?}");
    // The drift of gauge G4 is 0.8 microstrain per second, measured from the middle of the zero interval.
    let drift = named("drift").find(|s| s["gauge"] == "G4").unwrap();
    let expected: f64 = (0..SAMPLES)
        .map(|i| (0.8 * (i as f64 / RATE - 2.5)).powi(2))
        .sum();
    let expected = (expected / SAMPLES as f64).sqrt();
    let off = drift["rms_microstrain"].as_f64().unwrap() / expected - 1.0;
    assert!(off.abs() < 0.1, "{off}");
}

/// The loads can tilt the line of a drift by more than the noise. A warning reports this error, because no interval
/// contains it. Without loads there is no warning.
#[test]
fn a_drift_that_loads_tilt_is_a_warning() {
    let section = "[conditioning]\ndrift = \"linear\"\n";
    let codes = |strain: String| -> Vec<(&'static str, Severity)> {
        let files = files([false; 5], section).with_file("strain.csv", strain);
        let job = Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
        let got = strainbridge::recover(&job, &Context::new(&files));
        let got = got.unwrap_or_else(|f| panic!("{f:?}"));
        got.findings.iter().map(|f| (f.code, f.severity)).collect()
    };
    let warned = ("corrections-applied", Severity::Warning);
    // The first five seconds of the record have no loads. In the whole record, 900 N oscillate in 24 cycles.
    let drifting = record([false, false, true, false, false]);
    let idle: Vec<&str> = drifting.lines().take(1000).collect();
    let found = codes(format!("{}\n", idle.join("\n")));
    assert!(!found.contains(&warned), "{found:?}");
    let found = codes(drifting);
    assert!(found.contains(&warned), "{found:?}");
}

/// Without faults of the logger, conditioning changes the loads by less than their intervals.
#[test]
fn a_sound_record_keeps_its_loads() {
    let (plain, _, _) = recover([false; 5], "");
    let (worst, held, _) = recover(
        [false; 5],
        "[conditioning]\nspikes = true\nzero_s = [0.5, 4.5]\nlow_pass_hz = 20.0\n",
    );
    assert!(worst <= plain && held > 0.95, "{worst} {plain} {held}");
}

/// Corrections are applied once, before conditioning. Zero, thermal strain and offset therefore refer to the corrected
/// strain of the gauge.
#[test]
fn corrections_are_applied_once_and_before_conditioning() {
    let more = "[[correction]]\ngauge = \"G1\"\nsign = -1\noffset_microstrain = 300.0\n";
    let on = [true, true, false, false, false];
    let change = |text: &str| -> String {
        let mut lines = text.lines();
        let mut out = format!("{}\n", lines.next().unwrap());
        for line in lines {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            let strain: f64 = cells[1].parse().unwrap();
            cells[1] = format!("{:.5}", 300.0 - strain);
            out += &format!("{}\n", cells.join(","));
        }
        out
    };
    let section = "[conditioning]\nzero_s = [0.5, 4.5]\ntemperature = { channel = \"T1\", microstrain_per_degC = 1.4 }\n";
    let (plain, _, _) = recover(on, section);
    let files = files(on, &format!("{more}{section}")).with_file("strain.csv", change(&record(on)));
    let job = Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
    let got =
        strainbridge::recover(&job, &Context::new(&files)).unwrap_or_else(|f| panic!("{f:?}"));
    let history = got.answer.record().unwrap().history.as_ref().unwrap();
    let far = |row: &strainbridge::workflow::recover::HistoryRow| {
        let expected = loads(row.time);
        let both = row.loads.iter().zip(expected);
        both.map(|(l, e)| (l.unwrap()[0] - e).abs())
            .fold(0.0, f64::max)
    };
    let worst = history.rows().map(|r| far(&r)).fold(0.0, f64::max);
    assert!(worst < 1.5 * plain, "{worst} {plain}");
}

/// A gauge that is dead in a part of the record is blank there, before a filter can hide it. The loads come from the
/// other gauges.
#[test]
fn a_gauge_that_is_dead_for_a_while_is_blank_there() {
    let text = record([false; 5]);
    let mut dead = String::new();
    for (i, line) in text.lines().enumerate() {
        let mut cells: Vec<&str> = line.split(',').collect();
        if (2200..4000).contains(&i) {
            cells[2] = "12.7";
        }
        dead += &format!("{}\n", cells.join(","));
    }
    let files =
        files([false; 5], "[conditioning]\nlow_pass_hz = 20.0\n").with_file("strain.csv", dead);
    let job = Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
    let got =
        strainbridge::recover(&job, &Context::new(&files)).unwrap_or_else(|f| panic!("{f:?}"));
    let steps = &got.answer.reading_conditioning;
    let blank = steps.iter().find(|s| s.step == "constant").unwrap();
    assert_eq!((blank.gauge.as_str(), blank.samples), ("G2", 1800));
    let history = got.answer.record().unwrap().history.as_ref().unwrap();
    for row in history.rows().filter(|r| (12.0..19.0).contains(&r.time)) {
        for (load, expected) in row.loads.iter().zip(loads(row.time)) {
            assert!((load.unwrap()[0] - expected).abs() < 25.0, "{}", row.time);
        }
    }
}

/// Faults of `[conditioning]` name their key: times beyond the record, corner frequencies, channels, two zeros, runs.
#[test]
fn what_conditioning_cannot_do_is_a_fault() {
    let cases = [
        ("zero_s = [30.0, 60.0]", "zero_s"),
        ("zero_s = [1.0, 1.2]", "zero_s"),
        ("zero_s = [4.0, 1.0]", "zero_s"),
        ("low_pass_hz = 100.0", "low_pass_hz"),
        ("low_pass_hz = 5.0\nhigh_pass_hz = 9.0", "high_pass_hz"),
        (
            "temperature = { channel = \"T9\", microstrain_per_degC = 1.4 }",
            "temperature.channel",
        ),
        (
            "temperature = { channel = \"T1\" }",
            "temperature.microstrain_per_degC",
        ),
        ("drift = \"cubic\"", "drift"),
        (
            "temperature = { channel = \"G2\", microstrain_per_degC = 1.4 }",
            "temperature.channel",
        ),
    ];
    for (text, key) in cases {
        let files = files([false; 5], &format!("[conditioning]\n{text}\n"));
        let run = |job: Job| strainbridge::recover(&job, &Context::new(&files)).map(|_| ());
        let fault = Job::read("job.toml", &files).and_then(run).unwrap_err();
        let printed = format!("{fault:?}");
        assert!(
            printed.contains(&format!("conditioning.{key}")),
            "{text}: {printed}"
        );
    }
    // A step that removes static strain together with a zero file, a temperature in another unit, and a `[[section]]`
    // with a separate file.
    let two = |conditioning: &str, more: &str, field: &str| {
        let text = format!("{more}[conditioning]\n{conditioning}\n");
        let files = files([false; 5], &text)
            .with_file("zero.csv", record([false; 5]))
            .with_file(
                "strain.csv",
                record([false; 5]).replacen("T1", "T1 [degF]", 1),
            );
        let zero = job(&text).replace("reference =", "zero = \"zero.csv\", reference =");
        let files = if more.is_empty() && field != "temperature.channel" {
            files.with_file("job.toml", zero)
        } else {
            files
        };
        let run = |job: Job| strainbridge::recover(&job, &Context::new(&files)).map(|_| ());
        let fault = Job::read("job.toml", &files).and_then(run).unwrap_err();
        assert!(
            format!("{fault:?}").contains(field),
            "{conditioning}: {fault:?}"
        );
    };
    let thermal = "temperature = { channel = \"T1\", microstrain_per_degC = 1.4 }";
    two("zero_s = [0.5, 4.5]", "", "conditioning.zero_s");
    two("high_pass_hz = 0.1", "", "conditioning.high_pass_hz");
    two(thermal, "", "conditioning.temperature");
    two(thermal, "", "temperature.channel");
    let section = "[[section]]\nname = \"A\"\nfile = \"strain.csv\"\n";
    two("spikes = true", section, "section.file");
    let runs = files([false; 5], "[conditioning]\nspikes = true\n")
        .with_file("strain.csv", "run,G1,G2,G3,G4\nR1,1,2,3,4\n");
    let job = Job::read("job.toml", &runs).unwrap();
    let fault = strainbridge::recover(&job, &Context::new(&runs))
        .map(|_| ())
        .unwrap_err();
    assert!(format!("{fault:?}").contains("contains runs"), "{fault:?}");
}

/// Left load: 24.5 periods of a sine with a range of 1800 N, so that the pseudo-damage with slope 5 is 24.5 times 1800^5.
#[test]
fn fleet_conditions_records_as_recover_does() {
    let on = [true, true, true, true, true];
    let files = files(on, ALL);
    let (fleet, findings, extremes) = fleet_and_extremes("conditioned", &files, &job(ALL));
    check_extremes(&fleet, &findings, &extremes);
    let left = &fleet.vehicles[0].loads[0];
    let expected = 24.5 * 1800_f64.powi(5);
    // The fitted drift and the thermal strain leave up to 11 N of 900 N, the power makes 6 % of it.
    assert!(
        (left.damage / expected - 1.0).abs() < 0.1,
        "{}",
        left.damage / expected
    );
    assert!(
        findings.iter().any(|f| f.code == "corrections-applied"),
        "{findings:?}"
    );
}
