//! Faults of measured channels, planted in the readings of three models, for each command that reads them.
//!
//! A fault must either be harmless or be reported, alone or among the faults that look equal. A wrong result always has
//! an error. Correct readings cause no error.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use std::fmt::Write;
use strainbridge::finding::Finding;
use strainbridge::host::context::InMemory;
use strainbridge::{Context, Job, Severity, calibrate, payload, reconcile, recover};

/// Planted fault of the readings, by run and gauge.
struct Planted {
    name: &'static str,
    change: fn(&mut [Vec<f64>]),
    /// Codes that report the fault. One of them is enough.
    codes: &'static [&'static str],
    /// Faulty gauges, by number.
    gauges: &'static [usize],
}

/// Faulty gauges. Both have large readings in all three models.
const AT: usize = 2;
const OTHER: usize = 6;

const FAULTS: [Planted; 8] = [
    Planted {
        name: "sign",
        change: |e| e.iter_mut().for_each(|r| r[AT] *= -1.0),
        codes: &["input-sign-reversed", "gauge-other-side"],
        gauges: &[AT],
    },
    Planted {
        name: "millistrain",
        change: |e| e.iter_mut().for_each(|r| r[AT] *= 1e-3),
        codes: &["input-unit", "gauge-dead"],
        gauges: &[AT],
    },
    Planted {
        name: "nanostrain",
        change: |e| e.iter_mut().for_each(|r| r[AT] *= 1e3),
        codes: &["input-unit", "reading-beyond-gauges", "reading-impossible"],
        gauges: &[AT],
    },
    Planted {
        name: "gain",
        change: |e| e.iter_mut().for_each(|r| r[AT] *= 0.6),
        codes: &["gauge-suspect", "gauge-shifted"],
        gauges: &[AT],
    },
    Planted {
        name: "offset",
        change: |e| e.iter_mut().for_each(|r| r[AT] += 60.0),
        codes: &["gauge-suspect", "gauge-shifted"],
        gauges: &[AT],
    },
    Planted {
        name: "dead",
        change: |e| {
            e.iter_mut()
                .enumerate()
                .for_each(|(i, r)| r[AT] = 0.2 * (i % 3) as f64 - 0.2)
        },
        codes: &["gauge-dead"],
        gauges: &[AT],
    },
    Planted {
        name: "stuck",
        change: |e| e.iter_mut().for_each(|r| r[AT] = 37.5),
        codes: &["gauge-silent", "gauge-suspect", "gauge-shifted"],
        gauges: &[AT],
    },
    Planted {
        name: "exchanged",
        change: |e| e.iter_mut().for_each(|r| r.swap(AT, OTHER)),
        codes: &["inputs-exchanged"],
        gauges: &[AT, OTHER],
    },
];

/// Result of a command: its findings, and whether all values are within three standard deviations of the truth.
struct Outcome {
    findings: Vec<Finding>,
    harmless: bool,
}

/// Tests the result of a command against the rule of this file.
fn check(place: &str, planted: &Planted, gauges: &[String], out: &Outcome) {
    let findings = &out.findings;
    let errs = findings.iter().any(|f| f.severity == Severity::Error);
    assert!(
        out.harmless || errs,
        "{place}: wrong without an error: {findings:?}"
    );
    let of = |f: &&Finding| {
        let names = planted.gauges.iter().map(|g| &gauges[*g]);
        let mut printed = names.map(|n| {
            f.subject.split(", ").any(|s| s == n) || f.message.contains(&format!("`{n}`"))
        });
        planted.codes.contains(&f.code) && printed.any(|s| s)
    };
    assert!(
        out.harmless || findings.iter().any(|f| of(&f)),
        "{place}: not named: {findings:?}"
    );
}

fn text_of(header: &str, key: impl Fn(usize) -> String, rows: &[Vec<f64>]) -> String {
    let mut text = format!("{header}\n");
    for (i, row) in rows.iter().enumerate() {
        text += &key(i);
        row.iter().for_each(|v| {
            let _ = write!(text, ",{v}");
        });
        text.push('\n');
    }
    text
}

/// Returns whether each value is within three standard deviations of `truth(run, load)`, if that is known.
fn holds(list: &Value, truth: impl Fn(&str, &str) -> Option<f64>) -> bool {
    let within = |l: &Value| {
        let (run, name) = (l["run"].as_str().unwrap(), l["name"].as_str().unwrap());
        let Some(truth) = truth(run, name) else {
            return true;
        };
        let (value, sigma) = (l["value"].as_f64(), l["sigma"].as_f64());
        value
            .zip(sigma)
            .is_none_or(|(v, s)| (v - truth).abs() <= 3.0 * s)
    };
    list.as_array().unwrap().iter().all(within)
}

/// Given S with loads of one size, and readings of runs or of a record.
struct Matrix {
    s: Vec<Vec<f64>>,
    loads: Vec<Vec<f64>>,
    readings: Vec<Vec<f64>>,
}

const NOISE: f64 = 0.5;

impl Matrix {
    /// Returns `n` gauges and `k` loads. The columns differ in size as wheel forces and moments of a truck do.
    fn new((n, k): (usize, usize), rows: usize, is_record: bool, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut gaussian = || {
            let (u, v): (f64, f64) = (random.random_range(1e-12..1.0), random.random());
            (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
        };
        let s: Vec<Vec<f64>> = (0..n)
            .map(|g| {
                (0..k)
                    .map(|l| (1.0 + 0.5 * ((g + l) % 3) as f64) * gaussian())
                    .collect()
            })
            .collect();
        let loads: Vec<Vec<f64>> = (0..rows)
            .map(|i| {
                let wave = |l: usize| (0.02 * (l + 3) as f64 * i as f64 + l as f64).sin();
                (0..k)
                    .map(|l| 40.0 * if is_record { wave(l) } else { gaussian() })
                    .collect()
            })
            .collect();
        let readings = loads
            .iter()
            .map(|f| {
                let strain = |row: &Vec<f64>| row.iter().zip(f).map(|(s, f)| s * f).sum::<f64>();
                s.iter()
                    .map(|row| strain(row) * (1.0 + 0.005 * gaussian()) + NOISE * gaussian())
                    .collect()
            })
            .collect();
        Self { s, loads, readings }
    }

    fn gauges(&self) -> Vec<String> {
        (0..self.s.len()).map(|g| format!("G{g}")).collect()
    }

    fn files(&self, key: &str, readings: &[Vec<f64>]) -> InMemory {
        let names: Vec<String> = (0..self.s[0].len()).map(|l| format!("F{l}")).collect();
        let loads: String = names
            .iter()
            .map(|n| format!("[[load]]\nname = \"{n}\"\n"))
            .collect();
        let key_of = |i: usize| match key {
            "time" => format!("{}", i as f64 * 0.01),
            _ => format!("R{i}"),
        };
        InMemory::default()
            .with_file("S.csv", text_of(&format!("gauge,{}", names.join(",")), |g| format!("G{g}"), &self.s))
            .with_file("strain.csv", text_of(&format!("{key},{}", self.gauges().join(",")), key_of, readings))
            .with_file("runs.csv", text_of(&format!("run,{}", names.join(",")), key_of, &self.loads))
            .with_file(
                "job.toml",
                format!(
                    "units = \"m-kg-s\"\n[sensitivity]\nfile = \"S.csv\"\nper = {{ force = \"N\" }}\n{loads}[measured]\nstrain = \"strain.csv\"\n\
                     noise_microstrain = {NOISE}\nmodel_uncertainty_rel = 0.005\n"
                ),
            )
    }

    /// Returns the job with recorded loads.
    fn with_runs(files: InMemory) -> InMemory {
        let path = std::path::Path::new("job.toml");
        let text = strainbridge::host::context::Files::load(&files, path)
            .unwrap()
            .to_vec();
        let text = String::from_utf8(text).unwrap()
            + "[runs]\nfile = \"runs.csv\"\nunits = { force = \"N\" }\nnoise = { force = 1e-3 }\n[calibration]\nmodel_uncertainty_rel = 0.02\n";
        files.with_file("job.toml", text)
    }

    fn recover_loads(&self, key: &str, readings: &[Vec<f64>]) -> Outcome {
        let files = self.files(key, readings);
        let job = Job::read("job.toml", &files).unwrap();
        let done = recover(&job, &Context::new(&files)).unwrap();
        let mean =
            |l: usize| self.loads.iter().map(|f| f[l]).sum::<f64>() / self.loads.len() as f64;
        let truth = |run: &str, name: &str| {
            let l: usize = name[1..].parse().unwrap();
            Some(match key {
                "time" => mean(l),
                _ => self.loads[run[1..].parse::<usize>().unwrap()][l],
            })
        };
        let answer = serde_json::to_value(&done.answer).unwrap();
        Outcome {
            harmless: holds(&answer["loads"], truth),
            findings: done.findings.0,
        }
    }
}

#[test]
fn recover_names_each_fault_of_a_gauge_in_runs_and_records_of_two_matrices() {
    for (shape, model) in [((24, 9), "truck"), ((10, 3), "matrix")] {
        for (key, rows) in [("run", 12), ("time", 400)] {
            let right = Matrix::new(shape, rows, key == "time", 7);
            let sound = right.recover_loads(key, &right.readings);
            let errors = sound
                .findings
                .iter()
                .filter(|f| f.severity == Severity::Error);
            assert!(
                sound.harmless && errors.count() == 0,
                "{:?}",
                sound.findings
            );
            for planted in &FAULTS {
                let mut readings = right.readings.clone();
                (planted.change)(&mut readings);
                let out = right.recover_loads(key, &readings);
                check(
                    &format!("{model}, {key}, {}", planted.name),
                    planted,
                    &right.gauges(),
                    &out,
                );
            }
        }
    }
}

#[test]
fn calibrate_names_each_fault_of_a_gauge_that_recorded_loads_show() {
    for (shape, model) in [((24, 9), "truck"), ((10, 3), "matrix")] {
        let right = Matrix::new(shape, 14, false, 11);
        for planted in &FAULTS {
            let mut readings = right.readings.clone();
            (planted.change)(&mut readings);
            let files = Matrix::with_runs(right.files("run", &readings));
            let job = Job::read("job.toml", &files).unwrap();
            let done = calibrate(&job, &Context::new(&files)).unwrap();
            let out = Outcome {
                findings: done.findings.0,
                harmless: false,
            };
            let errs = Finding::new(Severity::Error, "none", "", "", "");
            // The runs determine S, so S includes a fault that a gauge has in all runs. The added error replaces the
            // missing one.
            let out = Outcome {
                findings: [out.findings, vec![errs]].concat(),
                ..out
            };
            check(
                &format!("{model}, calibrate, {}", planted.name),
                planted,
                &right.gauges(),
                &out,
            );
        }
    }
}

#[test]
fn reconcile_names_the_gauge_at_fault_of_a_matrix() {
    let right = Matrix::new((8, 3), 14, false, 11);
    for planted in [&FAULTS[0], &FAULTS[3], &FAULTS[5], &FAULTS[7]] {
        let mut readings = right.readings.clone();
        (planted.change)(&mut readings);
        let files = Matrix::with_runs(right.files("run", &readings));
        let job = Job::read("job.toml", &files).unwrap();
        let done = reconcile(&job, &Context::new(&files)).unwrap();
        let answer = serde_json::to_value(&done.answer).unwrap();
        let ids = |list: &Value| -> Vec<String> {
            let list = list.as_array().into_iter().flatten();
            list.map(|e| {
                e["id"]
                    .as_str()
                    .or(e.as_str())
                    .unwrap_or_default()
                    .to_owned()
            })
            .collect()
        };
        let printed = [ids(&answer["named"]), ids(&answer["rivals"])].concat();
        let of = |g: &usize| printed.iter().any(|id| id.ends_with(&format!("G{g}")));
        assert!(
            planted.gauges.iter().any(of),
            "{}: {printed:?}",
            planted.name
        );
    }
}

/// The carrier of `examples/frame` with a separate file and table of gauges.
struct Carrier {
    files: InMemory,
    header: String,
    rows: Vec<Vec<f64>>,
    wheels: Vec<Vec<f64>>,
}

fn numbers(text: &str) -> (String, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let header = lines.next().unwrap().to_owned();
    let row = |l: &str| l.split(',').skip(1).map(|v| v.parse().unwrap()).collect();
    (header, lines.map(row).collect())
}

impl Carrier {
    fn new() -> Self {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame");
        let text = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
        let names = [
            "recover.toml",
            "payload.toml",
            "frame.bdf",
            "gauges.csv",
            "runs.csv",
        ];
        let files = names.iter().fold(InMemory::default(), |all, name| {
            all.with_file(name, text(name))
        });
        let (header, rows) = numbers(&text("strain.csv"));
        Self {
            files: files.with_file("strain.csv", text("strain.csv")),
            header,
            rows,
            wheels: numbers(&text("runs.csv")).1,
        }
    }

    fn gauges(&self) -> Vec<String> {
        self.header.split(',').skip(1).map(str::to_owned).collect()
    }

    fn files_with_fault(&self, planted: &Planted) -> InMemory {
        let mut rows = self.rows.clone();
        (planted.change)(&mut rows);
        let key = |i: usize| format!("R{:02}", i + 1);
        self.files
            .clone()
            .with_file("strain.csv", text_of(&self.header, key, &rows))
    }

    fn recover_loads(&self, files: &InMemory) -> Outcome {
        let job = Job::read("recover.toml", files).unwrap();
        let done = recover(&job, &Context::new(files)).unwrap();
        let truth = |run: &str, name: &str| {
            let wheel = ["N.FZ", "L.FZ", "R.FZ"].iter().position(|w| *w == name)?;
            let run: usize = run[1..].parse().unwrap();
            Some(self.wheels[run - 1][3 + wheel])
        };
        let answer = serde_json::to_value(&done.answer).unwrap();
        Outcome {
            harmless: holds(&answer["loads"], truth),
            findings: done.findings.0,
        }
    }

    fn recover_payload(&self, files: &InMemory) -> Outcome {
        let job = Job::read("payload.toml", files).unwrap();
        let done = payload(&job, &Context::new(files)).unwrap();
        let answer = serde_json::to_value(&done.answer).unwrap();
        let list = answer["payload"].as_array().unwrap();
        let within = |l: &Value| {
            let run: usize = l["run"].as_str().unwrap()[1..].parse().unwrap();
            let (mass, sigma) = (l["mass"].as_f64(), l["mass_sigma"].as_f64());
            let truth = self.wheels[run - 1][0];
            mass.zip(sigma)
                .is_none_or(|(m, s)| (m - truth).abs() <= 3.0 * s)
        };
        Outcome {
            harmless: list.iter().all(within),
            findings: done.findings.0,
        }
    }
}

#[test]
fn recover_and_payload_name_each_fault_of_a_gauge_of_a_frame() {
    let frame = Carrier::new();
    let sound = [
        frame.recover_loads(&frame.files),
        frame.recover_payload(&frame.files),
    ];
    for out in sound {
        let errors = out
            .findings
            .iter()
            .filter(|f| f.severity == Severity::Error);
        assert!(out.harmless && errors.count() == 0, "{:?}", out.findings);
    }
    for planted in &FAULTS {
        let files = frame.files_with_fault(planted);
        let name = |command: &str| format!("frame, {command}, {}", planted.name);
        check(
            &name("recover"),
            planted,
            &frame.gauges(),
            &frame.recover_loads(&files),
        );
        check(
            &name("payload"),
            planted,
            &frame.gauges(),
            &frame.recover_payload(&files),
        );
    }
}

/// Correct jobs of all shapes, with runs and records. `STRAINBRIDGE_TRIALS` sets their number, 200 by default.
#[test]
fn sound_readings_are_an_error_in_one_job_of_a_hundred_at_most() {
    let trials: u64 = std::env::var("STRAINBRIDGE_TRIALS").map_or(200, |t| t.parse().unwrap());
    let (mut errors, mut named) = (0, 0);
    for seed in 0..trials {
        let shape = [(24, 9), (10, 3), (8, 4), (5, 3)][seed as usize % 4];
        let right = Matrix::new(shape, [12, 3, 30][seed as usize % 3], false, 100 + seed);
        let out = right.recover_loads("run", &right.readings);
        errors += u64::from(out.findings.iter().any(|f| f.severity == Severity::Error));
        let of_search = |f: &Finding| f.code.starts_with("input") || f.code == "gauge-dead";
        named += u64::from(out.findings.iter().any(of_search));
    }
    // A binomial variable with a probability of 1 % exceeds this limit with a chance of one in a hundred.
    let most = 0.01 * trials as f64 + 2.4 * (0.01 * trials as f64).sqrt() + 0.5;
    assert!((errors as f64) < most, "{errors} of {trials}");
    assert_eq!(named, 0);
}

/// If three wheels have tensile forces in all runs, the sign of the readings may be wrong. One wheel in compression
/// excludes it.
#[test]
fn wheels_that_all_pull_are_a_warning_and_wheels_that_push_are_not() {
    use strainbridge::host::context::InMemory;
    use strainbridge::{Context, Job};
    let codes = |strain: &str| -> Vec<&'static str> {
        let loads = ["L", "M", "R"]
            .map(|name| format!("[[load]]\nname = \"{name}\"\ngrid = 1\ncomponent = \"FZ\"\n"));
        let job = format!(
            "units = \"m-kg-s\"\nsensitivity = {{ file = \"s.csv\" }}\nmeasured = {{ strain = \"strain.csv\", noise_microstrain = 1.0 }}\n{}",
            loads.concat()
        );
        let files = InMemory::default()
            .with_file("job.toml", job)
            .with_file(
                "s.csv",
                "gauge,L,M,R\nG1,0.1,0,0\nG2,0,0.1,0\nG3,0,0,0.1\nG4,0.05,0.05,0\n",
            )
            .with_file("strain.csv", format!("run,G1,G2,G3,G4\n{strain}"));
        let job = Job::read("job.toml", &files).unwrap_or_else(|f| panic!("{f:?}"));
        let got = strainbridge::recover(&job, &Context::new(&files));
        let got = got.unwrap_or_else(|f| panic!("{f:?}"));
        got.findings.iter().map(|f| f.code).collect()
    };
    let pull = codes("A,-100,-200,-300,-150\nB,-120,-80,-200,-100\n");
    assert!(pull.contains(&"input-sign-reversed"), "{pull:?}");
    for sound in [
        "A,100,200,300,150\nB,120,80,200,100\n",
        "A,-100,-200,-300,-150\nB,-120,80,-200,-20\n",
    ] {
        let found = codes(sound);
        assert!(!found.contains(&"input-sign-reversed"), "{found:?}");
    }
}
