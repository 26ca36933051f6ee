//! Measured strain and recorded runs in the formats of loggers and spreadsheets.

use std::fmt::Write;
use strainbridge::host::context::InMemory;
use strainbridge::{Context, Faults, Job, calibrate, payload, reconcile, recover, sensitivity};

/// S with two loads and three gauges.
const S: &str = "gauge,A.FZ,B.FZ\nG1,1,0\nG2,0,1\nG3,1,1\n";

fn job(more: &str) -> String {
    format!(
        "units = \"m-kg-s\"\n[sensitivity]\nfile = \"S.csv\"\n[[load]]\nname = \"A.FZ\"\n[[load]]\nname = \"B.FZ\"\n\
         [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 1.0\n{more}"
    )
}

fn files(strain: impl AsRef<[u8]>, more: &str) -> InMemory {
    InMemory::default()
        .with_file("job.toml", job(more))
        .with_file("S.csv", S)
        .with_file("strain.csv", strain.as_ref())
}

/// Returns strain of five runs or samples in a unit of `micro` microstrain.
fn strain(key: &str, unit: &str, micro: f64) -> String {
    let mut text = format!("{key},G1 [{unit}],G2 [{unit}],G3 [{unit}]\n");
    for i in 0..5 {
        let (a, b) = (100.0 + f64::from(i * i), 50.0 - f64::from(2 * i));
        let name = match key {
            "run" => format!("R{i}"),
            _ => format!("0.{i}"),
        };
        let [x, y, z] = [a, b, a + b].map(|v| v / micro);
        let _ = writeln!(text, "{name},{x},{y},{z}");
    }
    text
}

/// Returns the recovered loads, by run or by sample.
fn loads(files: &InMemory) -> Vec<f64> {
    let found = recover(&Job::read("job.toml", files).unwrap(), &Context::new(files)).unwrap();
    match found.runs() {
        Some(runs) => runs.loads.iter().map(|l| l.value).collect(),
        None => {
            let history = found.record().unwrap().history.as_ref().unwrap();
            let values = history.rows().flat_map(|row| row.loads);
            values.map(|load| load.unwrap()[0]).collect()
        }
    }
}

fn faults_of<T>(answer: Result<T, Faults>) -> Faults {
    match answer {
        Err(faults) => faults,
        Ok(_) => panic!("it should be refused"),
    }
}

fn utf16(text: &str) -> Vec<u8> {
    let mut out = vec![0xff, 0xfe];
    text.encode_utf16()
        .for_each(|u| out.extend(u.to_le_bytes()));
    out
}

/// The loads equal the readings of G1 and G2, because S is the identity there. G3 reads their sum.
#[test]
fn every_unit_and_code_of_text_gives_the_same_loads_in_runs_and_in_records() {
    for key in ["run", "time"] {
        let right = loads(&files(strain(key, "um/m", 1.0), ""));
        for (i, pair) in right.chunks_exact(2).enumerate() {
            let i = i as f64;
            let expected = [100.0 + i * i, 50.0 - 2.0 * i];
            // The first load is 100 in the unit of the report.
            let off = pair
                .iter()
                .zip(expected)
                .map(|(v, e)| (v / right[0] - e / 100.0).abs());
            assert!(off.fold(0.0, f64::max) < 1e-9, "{key}: {pair:?}");
        }
        for (unit, micro) in [("mm/m", 1e3), ("m/m", 1e6), ("µm/m", 1.0)] {
            let text = strain(key, unit, micro);
            let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
            for (code, bytes) in [
                ("UTF-8", text.clone().into_bytes()),
                ("UTF-16", utf16(&text)),
                ("Windows", latin),
            ] {
                let found = loads(&files(bytes, ""));
                let pairs = found.iter().zip(&right);
                // Division by a unit and multiplication change the last digit of a reading.
                let off = pairs.map(|(a, b)| (a - b).abs() / b.abs());
                assert_eq!(found.len(), right.len());
                assert!(off.fold(0.0, f64::max) < 1e-12, "{key} {unit} {code}");
            }
        }
    }
}

#[test]
fn a_record_where_runs_are_needed_has_one_message_in_every_command() {
    let record = strain("time", "um/m", 1.0);
    let runs = "[runs]\nfile = \"runs.csv\"\nunits = { force = \"N\" }\n";
    let files = files(record, runs).with_file("runs.csv", "run,A.FZ,B.FZ\nR0,1,2\n");
    let job = Job::read("job.toml", &files).unwrap();
    let cx = Context::new(&files);
    let of_calibrate = faults_of(calibrate(&job, &cx));
    let of_reconcile = faults_of(reconcile(&job, &cx));
    assert_eq!(of_calibrate[0], of_reconcile[0]);
    assert!(of_calibrate[0].wrong.contains("cannot be read as runs"));
}

#[test]
fn a_hundred_numbers_with_marks_between_thousands_are_one_fault() {
    let mut text = "run;G1;G2;G3\n".to_owned();
    for i in 0..30 {
        let _ = writeln!(text, "R{i};2.497,6;1.250,5;3.748,1");
    }
    let faults = faults_of(recover(
        &Job::read("job.toml", &files(&text, "")).unwrap(),
        &Context::new(&files(&text, "")),
    ));
    assert_eq!(faults.len(), 1, "{faults}");
    let printed = faults[0].to_string();
    assert!(printed.starts_with("strain.csv:2:"), "{printed}");
    for part in ["`2.497,6`", "mark between thousands", "89 more"] {
        assert!(printed.contains(part), "{part}: {printed}");
    }
}

#[test]
fn a_cell_of_text_in_a_column_of_strain_is_named_once() {
    let text = strain("run", "um/m", 1.0).replace("R3,109", "R3,slipped");
    let files = files(&text, "");
    let job = Job::read("job.toml", &files).unwrap();
    let faults = faults_of(recover(&job, &Context::new(&files)));
    assert_eq!(faults.len(), 1, "{faults}");
    assert!(
        faults[0]
            .to_string()
            .starts_with("strain.csv:5: G1 [um/m]: `slipped`"),
        "{}",
        faults[0]
    );
}

#[test]
fn a_load_without_a_column_is_one_fault_that_names_the_column_meant() {
    let runs = "[runs]\nfile = \"runs.csv\"\nunits = { force = \"N\" }\n";
    let mut table = "run,A.FZ,FZ_B\n".to_owned();
    for i in 0..5 {
        let _ = writeln!(table, "R{i},100,50");
    }
    let files = files(strain("run", "um/m", 1.0), runs).with_file("runs.csv", table);
    let job = Job::read("job.toml", &files).unwrap();
    let faults = faults_of(reconcile(&job, &Context::new(&files)));
    let of_load: Vec<String> = faults.iter().map(ToString::to_string).collect();
    let [one] = &of_load[..] else {
        panic!("{of_load:?}")
    };
    assert!(one.contains("`B.FZ`"), "{one}");
    assert!(one.contains("columns = { \"B.FZ\" = \"FZ_B\" }"), "{one}");
}

/// Square plate that is fixed at one side, and a coordinate system whose x axis is the basic y axis.
const PLATE: &str = "SOL 101\nCEND\nSPC = 1\nBEGIN BULK\n\
    GRID,1,,0.,0.,0.\nGRID,2,,100.,0.,0.\nGRID,3,,100.,100.,0.\nGRID,4,,0.,100.,0.\n\
    CORD2R,5,0,30.,20.,0.,30.,20.,1.\n,30.,120.,0.\n\
    CQUAD4,7,1,1,2,3,4\nPSHELL,1,1,2.,1,,1\nMAT1,1,210000.,,.3,7.85-9\n\
    SPC1,1,123456,1,4\nENDDATA\n";

/// By the S of the job, the strain corresponds to a force of -250 N along basic y at the grid of the payload.
#[test]
fn a_payload_acts_along_a_force_that_is_stated_in_another_coordinate_system() {
    let weight = |load: &str| {
        let job = format!(
            "units = \"mm-t-s\"\nreport_units = {{ force = \"N\" }}\n[model]\ndeck = \"plate.bdf\"\n\
             [[load]]\nname = \"P\"\ngrid = 2\n{load}\n[gauges]\nfile = \"gauges.csv\"\n"
        );
        let gauges = "name,element,surface,dir_x,dir_y,dir_z\nG1,7,bottom,1,0,0\nG2,7,bottom,1,1,0\nG3,7,bottom,0,1,0\n";
        let files = InMemory::default()
            .with_file("plate.bdf", PLATE)
            .with_file("job.toml", job.clone())
            .with_file("gauges.csv", gauges);
        let read = Job::read("job.toml", &files).unwrap();
        let s = sensitivity(&read, &Context::new(&files)).unwrap();
        let s = &s.prepared.sensitivity;
        let strain: Vec<String> = (0..3)
            .map(|g| (s.values[(g, 0)] * -250e6).to_string())
            .collect();
        let files = files
            .with_file("strain.csv", format!("run,G1,G2,G3\nR1,{}\n", strain.join(",")))
            .with_file(
                "job.toml",
                format!(
                    "{job}[measured]\nstrain = \"strain.csv\"\nnoise_microstrain = 0.1\n[payload]\ngrid = 2\nuse = [\"strain\"]\n"
                ),
            );
        let read = Job::read("job.toml", &files).unwrap();
        let found = payload(&read, &Context::new(&files)).unwrap();
        let run = &found.weighing.runs[0];
        (run.force, run.interval)
    };
    let (along_y, interval) = weight("component = \"FY\"");
    assert!(interval[0] < 250.0 && 250.0 < interval[1], "{interval:?}");
    assert!(interval[1] - interval[0] < 25.0, "{interval:?}");
    let (in_system_5, _) = weight("component = \"FX\"\ncid = 5");
    // The same force. The last digit of the rotated vector differs.
    assert!(
        (in_system_5 - along_y).abs() < 1e-9 * along_y,
        "{in_system_5} {along_y}"
    );
}
