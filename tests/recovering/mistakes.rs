//! Common mistakes in runs. Every command that reads the runs reports the mistake, and reports nothing for correct
//! runs.

use super::{S, loads, strain};
use std::fmt::Write;
use strainbridge::finding::Finding;
use strainbridge::host::context::InMemory;
use strainbridge::{Context, Disk, Job, Severity, calibrate, payload, reconcile, recover};

const RUNS: usize = 10;

/// Returns readings and recorded loads of ten runs. `record` changes the recorded loads.
fn files(record: impl Fn([f64; 2]) -> [f64; 2]) -> InMemory {
    let (mut readings, mut runs) = ("run,G1,G2,G3,G4\n".to_owned(), "run,A.FZ,B.FZ\n".to_owned());
    for i in 0..RUNS {
        let [a, b] = loads(3 * i);
        let _ = write!(readings, "R{i}");
        for (g, v) in strain(a, b).into_iter().enumerate() {
            let noise = ((i * 5 + g * 3) % 7) as f64 / 7.0 - 0.43;
            let _ = write!(readings, ",{}", v + noise);
        }
        readings.push('\n');
        let [a, b] = record([a, b]);
        let _ = writeln!(runs, "R{i},{a},{b}");
    }
    let rows = S.iter().enumerate();
    let s: String = rows
        .map(|(g, [a, b])| format!("G{},{a},{b}\n", g + 1))
        .collect();
    InMemory::default()
        .with_file("S.csv", format!("gauge,A.FZ,B.FZ\n{s}"))
        .with_file("strain.csv", readings)
        .with_file("runs.csv", runs)
        .with_file(
            "job.toml",
            "units = \"m-kg-s\"\n[sensitivity]\nfile = \"S.csv\"\nper = { force = \"N\" }\n[[load]]\nname = \"A.FZ\"\n[[load]]\nname = \"B.FZ\"\n\
             [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.5\nmodel_uncertainty_rel = 0.01\nhold_out = [\"R8\", \"R9\"]\n\
             [runs]\nfile = \"runs.csv\"\nunits = { force = \"N\" }\nnoise = { force = 1e-4 }\n[calibration]\nmodel_uncertainty_rel = 0.02\n",
        )
}

/// Returns the findings of `recover`, `calibrate` and `reconcile`.
fn findings(files: &InMemory) -> [Vec<Finding>; 3] {
    let job = Job::read("job.toml", files).unwrap();
    let cx = Context::new(files);
    [
        recover(&job, &cx).unwrap().findings.0,
        calibrate(&job, &cx).unwrap().findings.0,
        reconcile(&job, &cx).unwrap().findings.0,
    ]
}

#[test]
fn right_records_are_named_by_no_command() {
    for found in findings(&files(|f| f)) {
        let wrong = found.iter().filter(|f| f.severity == Severity::Error);
        assert_eq!(wrong.count(), 0, "{found:?}");
        assert!(
            found.iter().all(|f| !f.code.starts_with("input")),
            "{found:?}"
        );
    }
}

#[test]
fn every_command_names_the_mistake_of_the_records() {
    /// Changes that the mistake makes in the recorded loads.
    type Mistake = fn([f64; 2]) -> [f64; 2];
    let mistakes: [(Mistake, &str, &str); 6] = [
        (|[a, b]| [-a, -b], "input-sign-reversed", "all"),
        (|[a, b]| [-a, b], "input-sign-reversed", "A.FZ"),
        (|[a, b]| [a, -b], "input-sign-reversed", "B.FZ"),
        (|[a, b]| [b, a], "inputs-exchanged", "A.FZ, B.FZ"),
        (|f| f.map(|v| 1e-3 * v), "input-unit", "all"),
        (|f| f.map(|v| v / 4.448), "input-unit", "all"),
    ];
    for (mistake, code, subject) in mistakes {
        for (found, command) in
            findings(&files(mistake))
                .iter()
                .zip(["recover", "calibrate", "reconcile"])
        {
            let named: Vec<&Finding> = found
                .iter()
                .filter(|f| f.code.starts_with("input"))
                .collect();
            assert_eq!(named.len(), 1, "{command} {code}: {found:?}");
            assert_eq!(
                (named[0].code, named[0].subject.as_str()),
                (code, subject),
                "{command}"
            );
            // `recover` does not use the recorded loads. It reports an error only if the readings may be wrong.
            if command != "recover" || subject == "all" && code != "inputs-exchanged" {
                assert_eq!(named[0].severity, Severity::Error, "{command} {code}");
            }
        }
    }
}

/// Returns the findings of `recover` on the carrier of `examples/frame` with another table of gauges.
fn carrier(gauges: &str) -> Vec<Finding> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame");
    let text = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let files = ["recover.toml", "frame.bdf", "strain.csv"]
        .iter()
        .fold(InMemory::default(), |all, name| {
            all.with_file(name, text(name))
        })
        .with_file("gauges.csv", gauges);
    let job = Job::read("recover.toml", &files).unwrap();
    recover(&job, &Context::new(&files)).unwrap().findings.0
}

#[test]
fn gauges_on_the_other_side_or_with_angles_in_radians_are_named() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame");
    let table = std::fs::read_to_string(folder.join("gauges.csv")).unwrap();
    let sides = ["gauge-other-side", "gauge-angle-in-radians"];
    assert!(carrier(&table).iter().all(|f| !sides.contains(&f.code)));
    let turned = table
        .replace(",bottom,", ",?,")
        .replace(",top,", ",bottom,")
        .replace(",?,", ",top,");
    let found = carrier(&turned);
    let named: Vec<&str> = found
        .iter()
        .filter(|f| sides.contains(&f.code))
        .map(|f| f.subject.as_str())
        .collect();
    assert_eq!(named, ["all"], "{found:?}");
    // The angles from the x axis of the element state the directions. In the second case, the numbers are radians.
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
    let angle = column("angle_from_element_x_deg");
    for (radians, expected) in [(false, vec![]), (true, vec!["all"])] {
        let mut by_angle = "name,element,surface,angle_deg\n".to_owned();
        for line in lines.clone() {
            let f: Vec<&str> = line.split(',').collect();
            let degrees: f64 = f[angle].parse().unwrap();
            let number = if radians {
                degrees.to_radians()
            } else {
                degrees
            };
            let _ = writeln!(by_angle, "{},{},{},{number}", f[0], f[1], f[2]);
        }
        let found = carrier(&by_angle);
        let named = found.iter().filter(|f| f.code == sides[1]);
        let named: Vec<&str> = named.map(|f| f.subject.as_str()).collect();
        assert_eq!(named, expected, "{found:?}");
    }
}

#[test]
fn readings_in_another_unit_of_strain_leave_all_loads_far_below_their_size() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame");
    let files = ["recover.toml", "frame.bdf", "gauges.csv"]
        .iter()
        .fold(InMemory::default(), |all, name| {
            all.with_file(name, std::fs::read_to_string(folder.join(name)).unwrap())
        });
    let strain = std::fs::read_to_string(folder.join("strain.csv")).unwrap();
    let thousandth = |line: &str| {
        let cells = line.split(',').map(|c| match c.parse::<f64>() {
            Ok(v) => (1e-3 * v).to_string(),
            Err(_) => c.to_owned(),
        });
        cells.collect::<Vec<_>>().join(",")
    };
    let text: Vec<String> = strain.lines().map(thousandth).collect();
    let files = files.with_file("strain.csv", text.join("\n") + "\n");
    let job = Job::read("recover.toml", &files).unwrap();
    let found = recover(&job, &Context::new(&files)).unwrap().findings.0;
    let far = found.iter().find(|f| f.code == "load-far-below-expected");
    let far = far.unwrap_or_else(|| panic!("{found:?}"));
    assert_eq!(
        (far.severity, far.subject.as_str()),
        (Severity::Error, "all")
    );
    let right = Job::read(folder.join("recover.toml"), &Disk).unwrap();
    let found = recover(&right, &Context::new(&Disk)).unwrap().findings.0;
    assert!(found.iter().all(|f| f.code != "load-far-below-expected"));
}

/// Returns the findings of `payload` on the carrier after a change of its job, its strain and its runs file.
fn collect_payload_findings(
    job: impl Fn(String) -> String,
    strain: impl Fn(String) -> String,
    runs: impl Fn(String) -> String,
) -> Vec<Finding> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/frame");
    let text = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let files = InMemory::default()
        .with_file("frame.bdf", text("frame.bdf"))
        .with_file("gauges.csv", text("gauges.csv"))
        .with_file("payload.toml", job(text("payload.toml")))
        .with_file("strain.csv", strain(text("strain.csv")))
        .with_file("runs.csv", runs(text("runs.csv")));
    let job = Job::read("payload.toml", &files).unwrap();
    payload(&job, &Context::new(&files)).unwrap().findings.0
}

/// Returns the job with the payload at the grid of the deck, weighed by strain alone.
fn at_the_grid(job: String) -> String {
    let (head, rest) = job.split_once("[runs]").unwrap();
    let (_, section) = rest.split_once("[payload]").unwrap();
    let section = section
        .replace("\"free\"", "\"known\"")
        .replace("\"strain\", \"reactions\"", "\"strain\"");
    format!("{head}[payload]{section}")
}

#[test]
fn a_stated_place_that_the_strain_refutes_is_named_and_a_right_one_is_not() {
    let of = |found: &[Finding]| -> Vec<String> {
        let named = found
            .iter()
            .filter(|f| f.code == "payload-place-contradicted");
        named.map(|f| f.subject.clone()).collect()
    };
    let only = |runs: [&'static str; 2]| {
        move |text: String| -> String {
            let kept = text
                .lines()
                .filter(|l| runs.iter().any(|r| l.starts_with(r)) || l.starts_with("run,"));
            kept.map(|l| format!("{l}\n")).collect()
        }
    };
    // The payload of R01 is at the grid. The payloads of R05 and R06 are 300 mm away from it.
    let right = collect_payload_findings(at_the_grid, only(["R01", "R01"]), |t| t);
    assert_eq!(of(&right), Vec::<String>::new(), "{right:?}");
    let wrong = collect_payload_findings(at_the_grid, only(["R05", "R06"]), |t| t);
    assert_eq!(of(&wrong).len(), 1, "{wrong:?}");
    // The runs file states the place of each run in metres. A finding names only runs with a wrong place.
    let known = |job: String| {
        let job = job.replace("\"free\"", "\"known\"");
        job.replace("support = \"known\"", "support = \"free\"")
            .replace("\"strain\", \"reactions\"", "\"strain\"")
    };
    let own = collect_payload_findings(known, |t| t, |t| t);
    assert_eq!(of(&own), Vec::<String>::new(), "{own:?}");
    let moved = |text: String| -> String {
        let change = |line: &str| match line.strip_prefix("R03,900,2.100,") {
            Some(rest) => format!("R03,900,2.800,{rest}\n"),
            None => line.to_owned() + "\n",
        };
        text.lines().map(change).collect()
    };
    let wrong = collect_payload_findings(known, |t| t, moved);
    assert_eq!(of(&wrong), ["R03"], "{wrong:?}");
}

#[test]
fn recorded_masses_that_the_readings_contradict_are_an_error() {
    let named = |found: &[Finding]| found.iter().any(|f| f.code == "recorded-mass-contradicts");
    assert!(!named(&collect_payload_findings(|t| t, |t| t, |t| t)));
    let of_sixty_percent = |text: String| -> String {
        let change = |line: &str| {
            let mut f: Vec<String> = line.split(',').map(str::to_owned).collect();
            if let Ok(kg) = f[1].parse::<f64>() {
                f[1] = (0.6 * kg).to_string();
            }
            f.join(",") + "\n"
        };
        text.lines().map(change).collect()
    };
    let found = collect_payload_findings(|t| t, |t| t, of_sixty_percent);
    assert!(named(&found), "{found:?}");
}

#[test]
fn tables_in_the_code_of_windows_are_read_and_names_of_another_case_are_shown_with_the_gauges() {
    let right = files(|f| f);
    let units = "um/m,um/m,um/m,um/m\n";
    let text = |name: &str| {
        let path = std::path::Path::new(name);
        String::from_utf8(
            strainbridge::host::context::Files::load(&right, path)
                .unwrap()
                .to_vec(),
        )
        .unwrap()
    };
    let strain = text("strain.csv");
    let (header, rows) = strain.split_once('\n').unwrap();
    let with_units = format!("{header}\n,{units}{rows}").replace("um/m", "µm/m");
    let windows: Vec<u8> = with_units.chars().map(|c| c as u8).collect();
    assert!(windows.contains(&0xb5) && std::str::from_utf8(&windows).is_err());
    let loads = |files: &InMemory| {
        let job = Job::read("job.toml", files).unwrap();
        let found = recover(&job, &Context::new(files)).unwrap();
        serde_json::to_value(&found.answer).unwrap()
    };
    assert_eq!(
        loads(&right.clone().with_file("strain.csv", windows)),
        loads(&right)
    );
    let lower = right.with_file("strain.csv", strain.replace('G', "g "));
    let job = Job::read("job.toml", &lower).unwrap();
    let faults = recover(&job, &Context::new(&lower))
        .err()
        .unwrap()
        .to_string();
    assert!(faults.contains("differ by case or separators"), "{faults}");
}
