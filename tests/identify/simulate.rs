//! `simulate`: inputs, faults, files, and the way back by `identify`.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;
use strainbridge::host::context::InMemory;
use strainbridge::workflow::simulate::SimulatedResponse;
use strainbridge::{Context, Faults, Job, Outcome, check, identify, simulate};

const VEHICLE: &str = "units = \"m-kg-s\"\n[vehicle]\nmodel = \"front2\"\nterms = [\"k_s\", \"c_s\"]\ndata = \"data.csv\"\n";
const KNOWN: &str = "known = { m_b = 3200.0, m_f = 1400.0, k_s = 4.8e5, c_s = 5600.0 }\n";
const ON_TYRE: &str =
    "known = { m_b = 3200.0, m_f = 1400.0, k_s = 4.8e5, c_s = 5600.0, k_t = 2.0e6, c_t = 900.0 }\n";

pub fn table(head: &str, rate_hz: f64, columns: &[Vec<f64>]) -> String {
    let mut text = format!("{head}\n");
    for i in 0..columns[0].len() {
        let _ = write!(text, "{:.6}", i as f64 / rate_hz);
        columns.iter().for_each(|c| {
            let _ = write!(text, ",{:.9e}", c[i]);
        });
        text.push('\n');
    }
    text
}

pub fn run(job: &str, data: &str) -> Result<Outcome<SimulatedResponse>, Faults> {
    let files = InMemory::default()
        .with_file("job.toml", job)
        .with_file("data.csv", data);
    simulate(
        &Job::read(Path::new("job.toml"), &files)?,
        &Context::new(&files),
    )
}

fn refused(job: &str, data: &str, expected: &[&str]) {
    let faults = run(job, data).map(|_| ()).unwrap_err().to_string();
    for part in expected {
        assert!(faults.contains(part), "{part}: {faults}");
    }
}

/// A standard normal number by the polar form of Box and Muller.
pub fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (random.random(), random.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (2.0 * PI * v).cos()
}

/// A rough road: waves of random phase from 0.3 to 25 Hz at one speed, which begins level.
fn road(n: usize, rate_hz: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let waves: Vec<(f64, f64, f64)> = (1..100)
        .map(|k| {
            let f = 0.25 * f64::from(k) + 0.05;
            (
                2.0 * PI * f,
                random.random_range(0.0..2.0 * PI),
                3e-3 / (1.0 + f),
            )
        })
        .collect();
    let height = |t: f64| -> f64 { waves.iter().map(|(w, p, a)| a * (w * t + p).sin()).sum() };
    (0..n)
        .map(|i| {
            let t = i as f64 / rate_hz;
            height(t) * (1.0 - (-t).exp())
        })
        .collect()
}

/// Noise of 0.02 m/s2 and 60 N on accelerations and wheel force of a road: `identify` recovers each parameter within 3.5 standard deviations.
#[test]
fn identify_recovers_the_parameters_of_a_simulated_record() {
    let rate = 500.0;
    let data = table("time [s],z_wheel [m]", rate, &[road(32_000, rate, 7)]);
    let found = run(&format!("{VEHICLE}{ON_TYRE}"), &data).unwrap();
    assert_eq!(found.driven_by, ["z_wheel"]);
    assert!(found.findings.is_empty(), "{:?}", found.findings);
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut noisy = |name: &str, sigma: f64, level: f64| -> Vec<f64> {
        let channel = found.channel(name).unwrap().iter();
        channel
            .map(|v| v + level + sigma * normal(&mut random))
            .collect()
    };
    let weight = 4600.0 * 9.80665;
    let columns = [
        noisy("a_body", 0.02, 9.80665),
        noisy("a_wheel", 0.02, 9.80665),
        noisy("f_wheel", 60.0, weight),
    ];
    let record = table(
        "time [s],a_body [m/s2],a_wheel [m/s2],f_wheel [N]",
        rate,
        &columns,
    );
    let job = format!("{VEHICLE}noise = {{ acc = 0.02, force = 60.0 }}\nband_hz = [0.7, 20.0]\n");
    let files = InMemory::default()
        .with_file("job.toml", job)
        .with_file("data.csv", record.as_str());
    let job = Job::read(Path::new("job.toml"), &files).unwrap();
    let identified = identify(&job, &Context::new(&files)).unwrap();
    for (name, truth) in [
        ("m_b", 3200.0),
        ("m_f", 1400.0),
        ("k_s", 4.8e5),
        ("c_s", 5600.0),
    ] {
        let p = identified
            .parameters
            .iter()
            .find(|p| p.name == name)
            .unwrap();
        let (value, sigma) = (p.value.unwrap(), p.sigma.unwrap());
        assert!(
            (value - truth).abs() < 3.5 * sigma,
            "{name}: {value} +- {sigma}"
        );
        assert!(sigma < 0.01 * truth, "{name}: {sigma}");
    }
    // The measured force with its weight drives the model to the motion without noise, to the noise of the record.
    let force = format!("{VEHICLE}{KNOWN}input = \"wheel_force\"\n");
    let back = run(&force, &record).unwrap();
    let codes: Vec<&str> = back.findings.iter().map(|f| f.code).collect();
    assert!(codes.contains(&"static-part-in-input"), "{codes:?}");
    let pairs = back
        .channel("s.stretch")
        .unwrap()
        .iter()
        .zip(found.channel("s.stretch").unwrap());
    let gap = pairs.clone().map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let size = pairs.map(|(_, b)| b * b).sum::<f64>();
    assert!(gap < 1e-3 * size, "{}", gap / size);
    // So does the recorded acceleration of the wheel alone, and it gives the wheel force.
    let one = format!("{VEHICLE}{KNOWN}input = [\"a_wheel\"]\n");
    let back = run(&one, &record).unwrap();
    let pairs = back
        .channel("f_wheel")
        .unwrap()
        .iter()
        .zip(found.channel("f_wheel").unwrap());
    let gap = pairs.clone().map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let size = pairs.map(|(_, b)| b * b).sum::<f64>();
    assert!(gap < 1e-3 * size, "{}", gap / size);
}

/// The rig of the thesis (4.4): the motion simulated from the force equals the motion simulated from the acceleration of the driven mass.
#[test]
fn the_rig_moves_the_same_from_force_and_from_one_acceleration() {
    let head = "units = \"m-kg-s\"\n[vehicle]\nmodel = \"rig\"\ndata = \"data.csv\"\n";
    let known = "known = { m_1 = 3.0, m_2 = 5.0, k_1 = 9e3, c_1 = 20.0, k_2 = 2e4, c_2 = 30.0 }\n";
    let rate = 1000.0;
    let force: Vec<f64> = (0..4000)
        .map(|i| i as f64 / rate)
        .map(|t| 40.0 * (2.0 * PI * 3.0 * t).sin().powi(3))
        .collect();
    let job = format!("{head}{known}");
    let forward = run(
        &job,
        &table("time [s],f_1 [N]", rate, std::slice::from_ref(&force)),
    )
    .unwrap();
    let recorded = forward.channel("a_1").unwrap().to_vec();
    let backward = run(&job, &table("time [s],a_1 [m/s2]", rate, &[recorded])).unwrap();
    for name in ["f_1", "a_2", "2.displacement"] {
        let (a, b) = (
            forward.channel(name).unwrap(),
            backward.channel(name).unwrap(),
        );
        let size = a.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let gap = a
            .iter()
            .zip(b)
            .fold(0.0f64, |m, (x, y)| m.max((x - y).abs()));
        assert!(gap < 1e-5 * size, "{name}: {gap} of {size}");
    }
}

#[test]
fn what_does_not_determine_a_simulation_is_refused() {
    let rate = 500.0;
    let wave: Vec<f64> = (0..500).map(|i| (i as f64 / 20.0).sin()).collect();
    let force = table("time [s],f_wheel [N]", rate, std::slice::from_ref(&wave));
    let all = format!("{VEHICLE}{KNOWN}");
    refused(
        &format!("{VEHICLE}known = {{ m_b = 3200.0, k_s = 4.8e5 }}\n"),
        &force,
        &["vehicle.known", "2 missing: m_f, c_s"],
    );
    refused(
        &format!("{VEHICLE}known = {{ m_x = 1.0 }}\n"),
        &force,
        &["m_x", "m_b, m_f"],
    );
    let both = table(
        "time [s],f_wheel [N],a_wheel [m/s2]",
        rate,
        &[wave.clone(), wave.clone()],
    );
    refused(
        &all,
        &both,
        &["vehicle.input", "\"wheel_force\", \"acceleration\""],
    );
    let named = format!("{all}input = [\"f_wheel\", \"a_wheel\"]\n");
    refused(&named, &both, &["more than one way"]);
    refused(&format!("{all}input = \"road\"\n"), &force, &["k_t, c_t"]);
    let on_road = format!("{VEHICLE}{ON_TYRE}input = \"road\"\n");
    refused(&on_road, &force, &["no column `z_wheel`"]);
    refused(
        &format!("{all}input = \"wind\"\n"),
        &force,
        &["vehicle.input", "`road`"],
    );
    refused(
        &format!("{all}input = [\"f_whel\"]\n"),
        &force,
        &["did you mean `f_wheel`"],
    );
    let body = table("time [s],a_body [m/s2]", rate, std::slice::from_ref(&wave));
    refused(&all, &body, &["f_wheel", "nothing drives it"]);
    let two = table(
        "time [s],a_body [m/s2],a_wheel [m/s2]",
        rate,
        &[wave.clone(), wave.clone()],
    );
    refused(&all, &two, &["no motion remains"]);
    let nothing = table("time [s],speed [m/s]", rate, std::slice::from_ref(&wave));
    refused(&all, &nothing, &["no channel that can drive"]);
    let gap = force.replacen("0.006000,", "0.006000,#", 1);
    let gap: String = gap
        .lines()
        .map(|l| l.split_once('#').map_or(l, |(time, _)| time).to_owned() + "\n")
        .collect();
    refused(&all, &gap, &["f_wheel", "sample 4", "cannot have a gap"]);
    let slow = table("time [s],f_wheel [N]", 20.0, std::slice::from_ref(&wave));
    refused(
        &all,
        &slow,
        &["fastest mode", "samples a period", "resample"],
    );
    refused(
        &format!("{all}corrections = {{ f_wheel = {{ gain = 1.1 }} }}\n"),
        &force,
        &["corrections"],
    );
    let rig =
        "units = \"m-kg-s\"\n[vehicle]\nmodel = \"rig\"\ndata = \"data.csv\"\ninput = \"road\"\n";
    refused(rig, &force, &["no tyres"]);
}

#[test]
fn a_wheel_that_lifts_off_is_an_error() {
    let rate = 500.0;
    let steep: Vec<f64> = road(4000, rate, 5).iter().map(|z| 12.0 * z).collect();
    let data = table("time [s],z_wheel [m]", rate, &[steep]);
    let found = run(&format!("{VEHICLE}{ON_TYRE}"), &data).unwrap();
    let lifted = found
        .findings
        .iter()
        .find(|f| f.code == "wheel-lifts-off")
        .unwrap();
    assert_eq!(lifted.subject, "f_wheel");
}

/// An accelerometer with an offset: the displacement drifts and is reported; the wheel force contains mass times offset, and no drift.
#[test]
fn an_offset_of_an_acceleration_drifts_and_is_reported() {
    let rate = 500.0;
    let recorded: Vec<f64> = (0..30_000)
        .map(|i| 0.05 + (0.06 * f64::from(i)).sin())
        .collect();
    let data = table("time [s],a_wheel [m/s2]", rate, &[recorded]);
    let found = run(&format!("{VEHICLE}{KNOWN}"), &data).unwrap();
    let codes: Vec<&str> = found.findings.iter().map(|f| f.code).collect();
    assert_eq!(codes, ["integrated-motion-drifts"]);
    let tail = &found.channel("f_wheel").unwrap()[20_000..];
    let mean = tail.iter().sum::<f64>() / tail.len() as f64;
    assert!((mean - 4600.0 * 0.05).abs() < 20.0, "{mean}");
}

/// Gravity in the mean of an acceleration, and the weight of the stated masses in the means of wheel forces, show their sign and unit.
#[test]
fn a_sign_or_a_unit_that_the_means_refute_is_an_error() {
    let rate = 500.0;
    let wave = |level: f64, size: f64| -> Vec<f64> {
        (0..8000)
            .map(|i| level + size * (0.06 * f64::from(i)).sin())
            .collect()
    };
    let (g, weight) = (9.80665, 4600.0 * 9.80665);
    let cases = [
        ("a_wheel", wave(g, 1.0), None),
        ("a_wheel", wave(0.0, 1.0), None),
        ("a_wheel", wave(-g, 1.0), Some("input-sign-reversed")),
        ("a_wheel", wave(1.0, 0.1), Some("input-unit")),
        ("f_wheel", wave(weight, 4000.0), None),
        // A force without its static part and with an offset of a thousandth of the weight is no force in kN.
        ("f_wheel", wave(0.001 * weight, 4000.0), None),
        (
            "f_wheel",
            wave(-weight, 4000.0),
            Some("input-sign-reversed"),
        ),
        ("f_wheel", wave(0.001 * weight, 4.0), Some("input-unit")),
        // A constant force whose unit is stated, a tenth of the weight, is a force in N and not in kgf.
        ("f_wheel [N]", wave(0.1 * weight, 0.0), None),
    ];
    for (channel, samples, expected) in cases {
        let data = table(&format!("time [s],{channel}"), rate, &[samples]);
        let found = run(&format!("{VEHICLE}{KNOWN}"), &data).unwrap();
        let errors: Vec<&str> = found
            .findings
            .iter()
            .filter(|f| f.severity == strainbridge::Severity::Error)
            .map(|f| f.code)
            .collect();
        assert_eq!(
            errors,
            Vec::from_iter(expected),
            "{channel}: {:?}",
            found.findings
        );
    }
}

/// Command line: files, JSON, exit codes, and the same job through `check`.
#[test]
fn the_command_writes_its_files_and_check_accepts_its_job() {
    let here = super::folder("simulate");
    let rate = 500.0;
    let write = |name: &str, text: &str| std::fs::write(here.join(name), text).unwrap();
    write(
        "data.csv",
        &table("time [s],z_wheel [mm]", rate, &[vec![0.0; 600]]),
    );
    let bumps: Vec<f64> = road(2000, rate, 2).iter().map(|z| 1e3 * z).collect();
    write("data.csv", &table("time [s],z_wheel [mm]", rate, &[bumps]));
    write("job.toml", &format!("{VEHICLE}{ON_TYRE}"));
    let start = |command: &str, more: &[&str]| {
        std::process::Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .arg(command)
            .arg(here.join("job.toml"))
            .args(more)
            .output()
            .unwrap()
    };
    let out = here.join("out");
    let done = start(
        "simulate",
        &["--out", out.to_str().unwrap(), "--json", "--threads", "1"],
    );
    assert_eq!(
        done.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let result: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(result["command"], "simulate");
    assert!(
        result["summary"]
            .as_str()
            .unwrap()
            .contains("largest wheel force")
    );
    let written = std::fs::read_to_string(out.join("response.csv")).unwrap();
    let header = written.lines().next().unwrap();
    assert!(
        header.starts_with("time [s],a_body [m/s2],a_wheel [m/s2],z_wheel [m],f_wheel [N],"),
        "{header}"
    );
    assert_eq!(written.lines().count(), 2001);
    let stated = &result["tables"]["response.csv"];
    assert!(!stated.is_null(), "{}", result["tables"]);
    assert!(out.join("report.html").exists());
    let checked = start("check", &["--json"]);
    assert_eq!(
        checked.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&checked.stdout)
    );
    let printed: serde_json::Value = serde_json::from_slice(&checked.stdout).unwrap();
    assert_eq!(
        printed["faults"].as_array().map(Vec::len),
        Some(0),
        "{printed}"
    );
    let shown = start("check", &[]);
    let shown = String::from_utf8_lossy(&shown.stdout).into_owned()
        + &String::from_utf8_lossy(&shown.stderr);
    assert!(shown.contains("strainbridge simulate"), "{shown}");
    // `response.csv` is a record: a simulation from its wheel force repeats it.
    std::fs::copy(out.join("response.csv"), here.join("data.csv")).unwrap();
    let again = format!("{VEHICLE}{KNOWN}input = \"wheel_force\"\n");
    let again = run(
        &again,
        &std::fs::read_to_string(here.join("data.csv")).unwrap(),
    )
    .unwrap();
    assert_eq!(again.samples, 2000);
    write("job.toml", VEHICLE);
    assert_eq!(
        start("simulate", &["--out", out.to_str().unwrap()])
            .status
            .code(),
        Some(2)
    );
}

#[test]
fn check_reports_the_faults_of_a_simulation() {
    let files = InMemory::default()
        .with_file("job.toml", format!("{VEHICLE}input = \"wheel_force\"\n"))
        .with_file("data.csv", "time [s],f_wheel [N]\n0,0\n0.002,1\n0.004,0\n");
    let found = check(&["job.toml".into()], &Context::new(&files)).unwrap();
    let faults: Vec<String> = found.faults.iter().map(ToString::to_string).collect();
    assert!(
        faults
            .iter()
            .any(|f| f.contains("4 missing: m_b, m_f, k_s, c_s")),
        "{faults:?}"
    );
}
