//! Files of every kind: results that contain a subcase twice, records in several units of time, files of an unexpected
//! kind.

use super::{S, loads, strain};
use std::fmt::Write;
use std::path::PathBuf;
use strainbridge::host::context::InMemory;
use strainbridge::workflow::check::CheckedFiles;
use strainbridge::{Context, Faults, Job, Outcome, check, sensitivity, strains};

/// Plate of two quads in m, kg, s under an axial force.
const PLATE: &str = "SOL 101\nCEND\nBEGIN BULK
GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,1.,1.,0.
GRID,4,,0.,1.,0.
GRID,5,,2.,0.,0.
GRID,6,,2.,1.,0.
CQUAD4,11,1,1,2,3,4
CQUAD4,12,1,2,5,6,3
PSHELL,1,1,0.01,1,,1
MAT1,1,2.+11,,0.3
FORCE,1,5,,1.,1.,0.,0.
ENDDATA
";

/// Returns shell strain of subcase 1 as a punch file: element, strain along x at both fibre distances.
fn punch(elements: &[(u32, f64)]) -> String {
    let mut text = "$TITLE   = T\n$SUBTITLE=\n$LABEL   =\n$ELEMENT STRAINS\n$REAL OUTPUT\n\
                    $SUBCASE ID = 1\n$ELEMENT TYPE = 33 QUAD4\n"
        .to_owned();
    for (id, exx) in elements {
        let fibre = |z: f64| [z, *exx, 0.0, 0.0, 0.0, *exx, 0.0, *exx];
        let words = [fibre(-0.005), fibre(0.005)].concat();
        for (i, three) in words.chunks(3).enumerate() {
            let head = match i {
                0 => format!("{id:>10}"),
                _ => "-CONT-".to_owned(),
            };
            let _ = write!(text, "{head:<18}");
            three.iter().for_each(|v| {
                let _ = write!(text, "{v:>18.6E}");
            });
            text.push('\n');
        }
    }
    text
}

fn plate_job(results: &str, load: &str) -> String {
    format!(
        "units = \"m-kg-s\"\n[model]\ndeck = \"plate.bdf\"\nresults = [{results}]\n\
         [[load]]\nname = \"A\"\nload_set = 1\nsubcase = 1\n{load}\n\
         [[gauge]]\nname = \"G1\"\nelement = 11\n[[gauge]]\nname = \"G2\"\nelement = 12\n"
    )
}

/// Returns S of both gauges in microstrain per N.
fn s_of(files: &InMemory, job: &str) -> Result<Vec<f64>, Faults> {
    let files = files.clone().with_file("job.toml", job);
    let read = Job::read("job.toml", &files)?;
    let s = sensitivity(&read, &Context::new(&files))?;
    let values = &s.prepared.sensitivity.values;
    Ok(values.as_slice().iter().map(|v| v * 1e6).collect())
}

fn words(faults: &Faults) -> String {
    faults.iter().map(ToString::to_string).collect()
}

fn check_files(files: &InMemory, names: &[&str]) -> Outcome<CheckedFiles> {
    let names: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
    check(&names, &Context::new(files)).unwrap()
}

#[test]
fn a_subcase_that_two_results_hold_with_other_values_is_not_taken_from_the_first() {
    let first = [(11, 10e-6), (12, 12e-6)];
    let last = [(11, 18e-6), (12, 20e-6)];
    let files = InMemory::default()
        .with_file("plate.bdf", PLATE)
        .with_file("first.pch", punch(&first))
        .with_file("last.pch", punch(&last))
        .with_file("copy.pch", punch(&first))
        .with_file("left.pch", punch(&first[..1]))
        .with_file("right.pch", punch(&first[1..]))
        .with_file("twice.pch", punch(&first) + &punch(&last));
    let close = |s: Result<Vec<f64>, Faults>, expected: [f64; 2]| {
        let s = s.unwrap_or_else(|f| panic!("{}", words(&f)));
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9;
        assert!(s.iter().zip(&expected).all(near), "{s:?}");
    };
    let both = "\"first.pch\", \"last.pch\"";
    let refused = s_of(&files, &plate_job(both, "")).unwrap_err();
    assert!(
        words(&refused).contains("result = \"first.pch\""),
        "{}",
        words(&refused)
    );
    // Accepted cases: the job names the file, both files have equal values, or the files have different elements.
    close(
        s_of(&files, &plate_job(both, "result = \"last.pch\"")),
        [18.0, 20.0],
    );
    close(
        s_of(&files, &plate_job("\"first.pch\", \"copy.pch\"", "")),
        [10.0, 12.0],
    );
    close(
        s_of(&files, &plate_job("\"right.pch\", \"left.pch\"", "")),
        [10.0, 12.0],
    );
    let refused = s_of(&files, &plate_job("\"twice.pch\"", "")).unwrap_err();
    assert!(words(&refused).contains("subcase 1 is twice in `twice.pch`"));
    let cx = Context::new(&files);
    let read = strains("plate.bdf".as_ref(), &["twice.pch".into()], &cx).unwrap();
    let code = |f: &strainbridge::finding::Finding| f.code == "subcase-ambiguous";
    assert_eq!(read.findings.iter().filter(|f| code(f)).count(), 1);
    for (names, expected) in [
        (&["plate.bdf", "twice.pch"][..], 1),
        (&["plate.bdf", "first.pch", "last.pch"], 1),
        (&["plate.bdf", "first.pch", "copy.pch"], 0),
        (&["plate.bdf", "left.pch", "right.pch"], 0),
    ] {
        let found = check_files(&files, names);
        assert!(found.faults.is_empty());
        let n = found.findings.iter().filter(|f| code(f)).count();
        assert_eq!(n, expected, "{names:?}");
    }
}

/// Returns a job with a given S, and a record of four gauges with these times.
fn build_record_job(head: &str, time: impl Fn(usize) -> String) -> InMemory {
    let mut s = "gauge,A,B\n".to_owned();
    for (g, row) in S.iter().enumerate() {
        let _ = writeln!(s, "G{},{},{}", g + 1, row[0], row[1]);
    }
    let mut record = format!("{head},G1,G2,G3,G4\n");
    for i in 0..200 {
        let [a, b] = loads(i);
        let readings = strain(a, b).map(|v| v.to_string());
        let _ = writeln!(record, "{},{}", time(i), readings.join(","));
    }
    let job = "units = \"m-kg-s\"\n[sensitivity]\nfile = \"s.csv\"\n\
               [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.1\n";
    InMemory::default()
        .with_file("s.csv", s)
        .with_file("job.toml", job)
        .with_file("strain.csv", record)
}

#[test]
fn times_in_any_unit_give_the_rate_and_an_unknown_unit_is_an_error() {
    let noon = 20_574.5 * 86_400.0;
    let at = |i: usize| i as f64 * 0.01;
    for (files, expected) in [
        (build_record_job("time", |i| format!("{:.2}", at(i))), None),
        (
            build_record_job("time [ms]", |i| (10 * i).to_string()),
            None,
        ),
        (
            build_record_job("time [d]", |i| format!("{:e}", at(i) / 86_400.0)),
            None,
        ),
        (
            build_record_job("time", |i| format!("{:.10}", 46_143.5 + at(i) / 86_400.0)),
            Some("time-unit-recognised"),
        ),
        (
            build_record_job("time", |i| format!("{:.0}", (noon + at(i)) * 1e3)),
            Some("time-unit-recognised"),
        ),
        // The unit may be milliseconds, or the samples may be ten seconds apart.
        (
            build_record_job("time", |i| (10 * i).to_string()),
            Some("time-unit-doubtful"),
        ),
        (
            build_record_job("time", |i| format!("{:e}", at(i) * 1e-6)),
            Some("time-unit-doubtful"),
        ),
    ] {
        let job = Job::read("job.toml", &files).unwrap();
        let done = strainbridge::recover(&job, &Context::new(&files)).unwrap();
        let mut about_time = done
            .findings
            .iter()
            .filter(|f| f.code.starts_with("time-unit"));
        let found = about_time.next().map(|f| f.code);
        assert_eq!(found, expected);
        if expected != Some("time-unit-doubtful") {
            let result = serde_json::to_value(&done.answer).unwrap();
            let rate = result["sample_rate_hz"].as_f64().unwrap();
            assert!((rate - 100.0).abs() < 1e-3, "{rate}");
        }
    }
}

#[test]
fn check_states_in_one_line_what_a_file_is() {
    let record = build_record_job("time", |i| format!("{:.2}", i as f64 * 0.01));
    let files = record
        .with_file("table.csv", "run,G1,G2\nR1,1,2\n")
        .with_file("report.pdf", b"%PDF-1.7\n\x00\x01".to_vec())
        .with_file(
            "noise.dat",
            [b"GRID,1\n\x00\x08\x1b[31m".to_vec(), vec![0; 5000]].concat(),
        );
    let found = check_files(&files, &["strain.csv", "table.csv"]);
    assert!(found.faults.is_empty(), "{:?}", found.faults);
    let lines: Vec<String> = found.records.iter().map(|r| r.text()).collect();
    assert_eq!(
        lines,
        [
            "record `strain.csv`: CSV, 4 channels (G1, G2, G3, G4), 200 samples at 100 Hz, 2 s",
            "table `table.csv`: CSV, 3 columns (run, G1, G2)",
        ]
    );
    for (name, what) in [
        ("report.pdf", "a PDF document"),
        ("noise.dat", "a binary file"),
    ] {
        let found = check_files(&files, &[name]);
        assert_eq!(found.faults.len(), 1, "{:?}", found.faults);
        let fault = found.faults[0].to_string();
        assert!(
            fault.contains(what) && !fault.contains(char::is_control),
            "{fault}"
        );
    }
}

#[test]
fn another_kind_of_file_than_the_one_expected_is_one_fault() {
    let files = build_record_job("time", |i| format!("{:.2}", i as f64 * 0.01));
    let strain_is = |bytes: &[u8]| {
        let files = files.clone().with_file("strain.csv", bytes);
        let job = Job::read("job.toml", &files).unwrap();
        let refused = strainbridge::recover(&job, &Context::new(&files));
        words(&refused.err().expect("a fault"))
    };
    let deck = strain_is(PLATE.as_bytes());
    assert!(deck.contains("it is a Nastran deck"), "{deck}");
    let image = strain_is(b"\x89PNG\r\n\x1a\n\x00\x00");
    assert!(image.contains("it is a PNG image"), "{image}");
    let other = strain_is(b"time,left,right\n0,1,2\n0.01,1,2\n");
    assert!(other.contains("its columns are left, right"), "{other}");
    let deck = InMemory::default()
        .with_file(
            "main.bdf",
            "SOL 101\nCEND\nBEGIN BULK\nINCLUDE 'part.bdf'\nENDDATA\n",
        )
        .with_file("part.bdf", b"TDSm\x00\x00".to_vec())
        .with_file("rec.rsp", b"TDSm\x00\x00".to_vec());
    let found = check_files(&deck, &["main.bdf"]);
    let printed: String = found.faults.iter().map(ToString::to_string).collect();
    assert!(printed.contains("a record in TDMS form"), "{printed}");
    let solved =
        strainbridge::solve_deck("rec.rsp".as_ref(), Default::default(), &Context::new(&deck));
    let printed = words(&solved.err().expect("a fault"));
    assert!(
        printed.contains("it is a record in TDMS form, not a Nastran deck"),
        "{printed}"
    );
}
