//! Gauges with the role `validation`: no command estimates loads from them, and `recover` compares them with its prediction.

use super::{S, loads, strain};
use std::fmt::Write;
use strainbridge::host::context::InMemory;
use strainbridge::workflow::recover::{RecoveredLoads, ValidationGauge};
use strainbridge::{Context, Job, calibrate, payload, reconcile, recover};

const NOISE: f64 = 0.3;

/// Returns a table of `n` rows without noise. The reading of gauge 4 has the error `off`, microstrain.
fn readings(key: &str, n: usize, off: f64) -> String {
    let mut text = format!("{key},G1,G2,G3,G4\n");
    for i in 0..n {
        let [a, b] = loads(i);
        let [g1, g2, g3, g4] = strain(a, b);
        let _ = match key {
            "time" => write!(text, "{}", i as f64 * 0.01),
            _ => write!(text, "R{i}"),
        };
        let _ = writeln!(text, ",{g1},{g2},{g3},{}", g4 + off);
    }
    text
}

/// Returns the job of these tests, with a role for gauge 4 and further lines.
fn files(strain: String, role: &str, more: &str) -> InMemory {
    let mut s = "gauge,A.FZ,B.FZ\n".to_owned();
    for (g, row) in S.iter().enumerate() {
        let _ = writeln!(s, "G{},{},{}", g + 1, row[0], row[1]);
    }
    let gauges = format!("name,role\nG1,estimate\nG2,estimate\nG3,\nG4,{role}\n");
    let job = format!(
        "units = \"m-kg-s\"\n[sensitivity]\nfile = \"S.csv\"\n[gauges]\nfile = \"gauges.csv\"\n\
         [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = {NOISE}\n{more}"
    );
    InMemory::default()
        .with_file("job.toml", job)
        .with_file("S.csv", s)
        .with_file("gauges.csv", gauges)
        .with_file("strain.csv", strain)
}

fn recover_job(files: &InMemory) -> RecoveredLoads {
    let job = Job::read("job.toml", files).unwrap();
    recover(&job, &Context::new(files)).unwrap().answer
}

/// Returns the loads of all runs, or statistics over all samples.
fn numbers(found: &RecoveredLoads) -> Vec<f64> {
    match (found.runs(), found.record()) {
        (Some(runs), _) => runs.loads.iter().map(|l| l.value).collect(),
        (_, Some(record)) => (record.loads.iter())
            .flat_map(|l| [l.value, l.min, l.max, l.rms])
            .collect(),
        _ => Vec::new(),
    }
}

fn require_single_gauge(list: &[ValidationGauge]) -> &ValidationGauge {
    let [gauge] = list else { panic!("{list:?}") };
    assert_eq!(gauge.name, "G4");
    gauge
}

/// An error of 50 microstrain at the validation gauge appears in its difference and changes no load.
#[test]
fn a_validation_gauge_changes_no_load_and_shows_its_own_error() {
    for key in ["run", "time"] {
        let right = recover_job(&files(readings(key, 40, 0.0), "validation", ""));
        let off = recover_job(&files(readings(key, 40, 50.0), "reserve", ""));
        assert_eq!(numbers(&right), numbers(&off), "{key}");
        let used = recover_job(&files(readings(key, 40, 50.0), "estimate", ""));
        assert_ne!(numbers(&right), numbers(&used), "{key}");
        assert!(used.validation.is_empty());
        let (right, off) = (
            require_single_gauge(&right.validation),
            require_single_gauge(&off.validation),
        );
        assert_eq!((right.n, off.n), (40, 40), "{key}");
        // Readings have sixteen digits.
        assert!(right.rms_microstrain.unwrap() < 1e-9, "{right:?}");
        assert!(
            (off.rms_microstrain.unwrap() - 50.0).abs() < 1e-9,
            "{off:?}"
        );
        // The variance of reading minus prediction, by hand: noise^2 (1 + s4 (S' S)^-1 s4').
        let [mut aa, mut ab, mut bb] = [0.0; 3];
        for row in &S[..3] {
            aa += row[0] * row[0];
            ab += row[0] * row[1];
            bb += row[1] * row[1];
        }
        let det = aa * bb - ab * ab;
        let [a, b] = S[3];
        let form = (a * a * bb - 2.0 * a * b * ab + b * b * aa) / det;
        let expected = NOISE * (1.0 + form).sqrt();
        let found = off.expected_rms_microstrain.unwrap();
        assert!(
            (found / expected - 1.0).abs() < 1e-9,
            "{key}: {found} {expected}"
        );
    }
}

#[test]
fn a_validation_gauge_that_contradicts_its_prediction_is_named() {
    let files = files(readings("run", 12, 50.0), "validation", "");
    let job = Job::read("job.toml", &files).unwrap();
    let found = recover(&job, &Context::new(&files)).unwrap();
    let named = found
        .findings
        .iter()
        .any(|f| f.code == "prediction-poor" && f.subject == "G4");
    assert!(named, "{:?}", found.findings);
    // The column of the validation gauge is not reported as unknown.
    let unknown = found
        .findings
        .iter()
        .any(|f| f.code == "strain-without-gauge");
    assert!(!unknown, "{:?}", found.findings);
}

#[test]
fn a_job_of_validation_gauges_alone_is_refused() {
    let files = files(readings("run", 12, 0.0), "validation", "");
    let all = "name,role\nG1,validation\nG2,validation\n";
    let files = files.with_file("gauges.csv", all);
    let job = Job::read("job.toml", &files).unwrap();
    let faults = recover(&job, &Context::new(&files))
        .map(|_| ())
        .unwrap_err();
    assert!(faults.iter().any(|f| f.field == "role"), "{faults:?}");
}

/// Runs a command twice. Only the reading of the validation gauge differs, so the results must be equal.
#[test]
fn commands_that_estimate_from_readings_leave_validation_gauges_out() {
    let runs = |with_mass: bool| {
        let (column, mass) = if with_mass {
            (",payload_mass", ",10")
        } else {
            ("", "")
        };
        let mut text = format!("run,A.FZ,B.FZ{column}\n");
        for i in 0..12 {
            let [a, b] = loads(i);
            let _ = writeln!(text, "R{i},{a},{b}{mass}");
        }
        text
    };
    let more = "[[load]]\nname = \"A.FZ\"\n[[load]]\nname = \"B.FZ\"\n[runs]\nfile = \"runs.csv\"\nunits = { force = \"N\" }\n\
                noise = { force = 1.0 }\n[payload]\nuse = [\"strain\", \"reactions\"]\nnominal_x = 0.0\n[reconcile]\npath = \"static\"\n";
    let signature = "gauge,b0\nG1,1\nG2,0.5\nG3,0.2\nG4,0.1\n";
    let answer = |command: usize, off: f64| {
        let with_payload = more.to_owned() + "[sensitivity.signatures]\npayload = \"b.csv\"\n";
        let files = files(
            readings("run", 12, off),
            "validation",
            match command {
                2 => &with_payload,
                _ => more,
            },
        );
        let files = files
            .with_file("runs.csv", runs(command == 2))
            .with_file("b.csv", signature);
        let job = Job::read("job.toml", &files).unwrap();
        let cx = Context::new(&files);
        match command {
            0 => serde_json::to_value(&calibrate(&job, &cx).unwrap().answer.calibration),
            1 => serde_json::to_value(&reconcile(&job, &cx).unwrap().answer),
            _ => serde_json::to_value(&payload(&job, &cx).unwrap().answer),
        }
        .unwrap()
    };
    for command in 0..3 {
        let (right, off) = (answer(command, 0.0), answer(command, 500.0));
        assert_eq!(right, off, "{command}");
        assert!(!right.to_string().contains("G4"), "{command}: {right}");
    }
}
