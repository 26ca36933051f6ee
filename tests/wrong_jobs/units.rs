//! Jobs of `examples/` with numbers in other units than stated. Every answer has an error.

use super::copies::{copy_example, edit};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Returns a table with the numbers of one column, or of all columns but the first, multiplied by a factor.
fn scale_table(text: &str, column: Option<&str>, factor: f64) -> String {
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut out = header.join(",") + "\n";
    for line in lines {
        let fields = line.split(',').zip(&header).enumerate();
        let fields = fields.map(|(i, (field, name))| match field.parse::<f64>() {
            Ok(v) if i > 0 && column.is_none_or(|c| c == *name) => (v * factor).to_string(),
            _ => field.to_owned(),
        });
        out += &(fields.collect::<Vec<_>>().join(",") + "\n");
    }
    out
}

/// Returns a table with one number in a line replaced.
fn with_number(text: &str, line: usize, column: &str, number: &str) -> String {
    let mut header = text.lines().next().unwrap().split(',');
    let at = header.position(|c| c == column).unwrap();
    let lines = text.lines().enumerate().map(|(i, l)| {
        let mut fields: Vec<&str> = l.split(',').collect();
        if i + 1 == line {
            fields[at] = number;
        }
        fields.join(",") + "\n"
    });
    lines.collect()
}

/// Runs a command in a folder. Returns exit code, findings (severity, code, subject, message and remedy), and standard
/// error.
fn run_command(folder: &Path, arguments: &[&str]) -> (i32, Vec<String>, String) {
    let out = folder.join("judged.out");
    let _ = std::fs::remove_dir_all(&out);
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .arg("--out")
        .arg(&out)
        .env("STRAINBRIDGE_CACHE", folder.join("kept"))
        .current_dir(folder)
        .output()
        .unwrap();
    let text = std::fs::read(out.join("result.json")).unwrap_or_default();
    let result: Value = serde_json::from_slice(&text).unwrap_or(Value::Null);
    let findings = result["findings"].as_array().cloned().unwrap_or_default();
    let word = |f: &Value, key: &str| f[key].as_str().unwrap_or_default().to_owned();
    let codes = findings
        .iter()
        .map(|f| {
            ["severity", "code", "subject", "message", "remedy"]
                .map(|key| word(f, key))
                .join(" ")
        })
        .collect();
    let errors = String::from_utf8_lossy(&done.stderr).into_owned();
    (done.status.code().unwrap_or(-1), codes, errors)
}

/// Texts about the unit, or about the place where it is stated. An error of this code contains one of them.
const SAYS: [(&str, &[&str]); 9] = [
    ("input-unit", &["[runs] units"]),
    (
        "readings-below-noise",
        &[
            "State readings in microstrain",
            "State the unit after the name of the channel",
        ],
    ),
    ("reading-beyond-gauges", &["State readings in microstrain"]),
    ("reading-impossible", &["microstrain is expected"]),
    ("ballast-beyond-model", &["[runs] units"]),
    ("model-far-above-readings", &["[runs] units"]),
    (
        "load-beyond-expected",
        &["units of the strain file or of the table of loads"],
    ),
    (
        "prediction-poor",
        &["table of loads against `report_units`"],
    ),
    ("units-modulus", &["`units` of the job"]),
];

/// Fails unless the exit code is 1 and an error has this code, the stated subject, and a text of `SAYS`.
fn asks(folder: &Path, arguments: &[&str], error: &str) {
    let (exit, findings, errors) = run_command(folder, arguments);
    assert_eq!(exit, 1, "{arguments:?}\n{errors}");
    let code = error.split(' ').next().unwrap();
    let of_code = SAYS.iter().find(|s| s.0 == code);
    let (_, says) = of_code.unwrap_or_else(|| panic!("{code} is not in SAYS"));
    let head = format!("error {error}");
    let mut of_code = findings.iter().filter(|f| f.starts_with(&head));
    assert!(
        of_code.any(|f| says.iter().any(|s| f.contains(s))),
        "{arguments:?} {error} {findings:?}"
    );
}

/// Fails unless the command has a fault at this place and writes nothing.
fn refuses(folder: &Path, arguments: &[&str], place: &str) {
    let (exit, _, errors) = run_command(folder, arguments);
    assert_eq!(exit, 2, "{arguments:?}\n{errors}");
    assert!(errors.contains(place), "{arguments:?}\n{errors}");
    assert!(!folder.join("judged.out").exists(), "{arguments:?}");
}

#[test]
fn every_command_that_reads_strain_asks_for_its_unit() {
    for (folder, command, job, strain) in [
        ("frame", "reconcile", "reconcile.toml", "strain_wired.csv"),
        ("frame", "recover", "recover.toml", "strain.csv"),
        ("frame", "respond", "respond.toml", "strain.csv"),
        ("bridge", "calibrate", "calibrate.toml", "strain.csv"),
    ] {
        let both = [
            (1e-6, "readings-below-noise"),
            (1e3, "reading-beyond-gauges"),
        ];
        // In a calibration, S can be in any unit, so only readings below the noise are an error.
        let asked = if folder == "bridge" { 1 } else { 2 };
        for (factor, code) in &both[..asked] {
            let factor = *factor;
            let to = copy_example("strain", folder);
            edit(&to, strain, |t| scale_table(t, None, factor));
            asks(&to, &[command, job], code);
        }
    }
    let to = copy_example("no_strain", "frame");
    edit(&to, "strain_wired.csv", |t| scale_table(t, None, 1e9));
    refuses(&to, &["reconcile", "reconcile.toml"], "strain_wired.csv");
    for factor in [1e4, 1e9] {
        let to = copy_example("any_signal", "bridge");
        edit(&to, "strain.csv", |t| scale_table(t, None, factor));
        for command in ["calibrate", "check"] {
            let (exit, codes, errors) = run_command(&to, &[command, "calibrate.toml"]);
            assert_eq!(exit, 0, "{command}: {codes:?}\n{errors}");
        }
    }
    let to = copy_example("fleet", "fleet");
    let records = [
        "A_2026-05-01.csv",
        "A_2026-05-02.csv",
        "B_2026-05-01.csv",
        "B_2026-05-02.csv",
    ];
    for record in records {
        edit(&to, record, |t| scale_table(t, None, 1e3));
    }
    let fleet = [["fleet", "fleet.toml"].as_slice(), &records].concat();
    for vehicle in ["A", "B"] {
        asks(
            &to,
            &fleet,
            &format!("reading-beyond-gauges {vehicle} P01,"),
        );
    }
    // The finding names the first record of each vehicle.
    let (_, findings, _) = run_command(&to, &fleet);
    for first in [records[0], records[2]] {
        let named = format!("the first {first}: ");
        assert!(findings.iter().any(|f| f.contains(&named)), "{findings:?}");
    }
}

#[test]
fn a_load_or_a_payload_that_nothing_weighs_is_a_fault_of_its_line() {
    for (folder, job, file, column) in [
        ("frame", "reconcile.toml", "runs.csv", "N.FZ"),
        ("frame", "reconcile.toml", "runs.csv", "payload_mass"),
        ("frame", "reconcile.toml", "runs.csv", "payload_x"),
        ("frame", "payload.toml", "runs.csv", "N.FZ"),
        ("frame", "payload.toml", "runs.csv", "payload_x"),
        ("frame", "ballast.toml", "empty.csv", "N.FZ"),
        ("bridge", "calibrate.toml", "runs.csv", "west"),
    ] {
        for number in ["1e308", "-1e200"] {
            let line = if file == "empty.csv" { 2 } else { 3 };
            let to = copy_example("runs", folder);
            edit(&to, file, |t| with_number(t, line, column, number));
            let command = job.strip_suffix(".toml").unwrap();
            refuses(&to, &[command, job], &format!("{file}:{line}: {column}: "));
        }
    }
    let to = copy_example("factor", "bridge");
    edit(&to, "calibrate.toml", |t| {
        t.replace("terms = { west = 1,", "terms = { west = 1e308,")
    });
    refuses(&to, &["calibrate", "calibrate.toml"], "combination.terms");
    let to = copy_example("noise_of_job", "bridge");
    edit(&to, "calibrate.toml", |t| {
        t.replace("noise_microstrain = 0.05", "noise_microstrain = 1e300")
    });
    let (exit, _, errors) = run_command(&to, &["calibrate", "calibrate.toml"]);
    assert!(exit == 2 && errors.contains("1e300"), "{errors}");
    assert!(!errors.contains("0000000"), "{errors}");
}

#[test]
fn wheel_forces_in_another_unit_are_asked_for() {
    let to = copy_example("ballast", "frame");
    edit(&to, "empty.csv", |t| scale_table(t, None, 1e3));
    asks(
        &to,
        &["ballast", "ballast.toml"],
        "ballast-beyond-model empty ",
    );
    let reconcile = ["reconcile", "reconcile.toml"];
    edit(&to, "runs.csv", |t| {
        ["N.FZ", "L.FZ", "R.FZ"]
            .iter()
            .fold(t.to_owned(), |t, c| scale_table(&t, Some(c), 1e3))
    });
    asks(&to, &reconcile, "input-unit N.FZ, L.FZ, R.FZ ");
}

#[test]
fn loads_of_another_unit_give_no_stress_without_an_error() {
    let to = copy_example("respond", "frame");
    let (exit, _, errors) = run_command(&to, &["recover", "recover.toml"]);
    assert_eq!(exit, 0, "{errors}");
    std::fs::copy(to.join("judged.out/loads.csv"), to.join("loads.csv")).unwrap();
    edit(&to, "respond.toml", |t| {
        t.replace("[respond]", "[respond]\nloads = \"loads.csv\"")
    });
    let respond = ["respond", "respond.toml"];
    let (exit, _, errors) = run_command(&to, &respond);
    assert_eq!(exit, 0, "{errors}");
    let table = std::fs::read_to_string(to.join("loads.csv")).unwrap();
    edit(&to, "loads.csv", |t| with_number(t, 3, "L.FZ", "1e308"));
    refuses(&to, &respond, "loads.csv:3: L.FZ: ");
    std::fs::write(to.join("loads.csv"), scale_table(&table, None, 1e3)).unwrap();
    for load in ["N.FZ", "L.FZ", "R.FZ"] {
        asks(&to, &respond, &format!("load-beyond-expected {load} "));
    }
    std::fs::write(to.join("loads.csv"), &table).unwrap();
    edit(&to, "respond.toml", |t| {
        let kilo = "force = \"kN\", moment = \"kN m\"";
        t.replace(kilo, "force = \"N\", moment = \"N m\"")
    });
    asks(&to, &respond, "prediction-poor P01,");
}

#[test]
fn channels_that_read_less_than_their_noise_determine_no_vehicle() {
    let quarter = "quarter_truck";
    let identify = ["identify", "identify.toml"];
    for column in [Some("f_wheel"), None] {
        let factor = if column.is_some() { 1e-3 } else { 1e-6 };
        let to = copy_example("channels", quarter);
        for file in ["data.csv", "holdout.csv"] {
            edit(&to, file, |t| scale_table(t, column, factor));
        }
        for channel in ["f_wheel", "a_wheel"] {
            asks(&to, &identify, &format!("readings-below-noise {channel} "));
        }
    }
    let to = copy_example("noise", quarter);
    let stated = "noise = { acc = 0.02, force = 60.0 }";
    edit(&to, "identify.toml", |t| {
        t.replace(stated, "noise = { acc = 2000.0, force = 6e7 }")
    });
    for channel in ["f_wheel", "a_body", "a_wheel"] {
        asks(&to, &identify, &format!("readings-below-noise {channel} "));
    }
    let to = copy_example("known", quarter);
    edit(&to, "identify.toml", |t| {
        t.replace(stated, &format!("{stated}\nknown = {{ m_b = 1e308 }}"))
    });
    refuses(&to, &identify, "vehicle.known.m_b");
    let to = copy_example("huge_sample", quarter);
    edit(&to, "data.csv", |t| with_number(t, 9, "a_wheel", "1e308"));
    refuses(&to, &identify, "a_wheel");
    let to = copy_example("compared", quarter);
    for file in ["data_worn.csv", "holdout_worn.csv"] {
        edit(&to, file, |t| scale_table(t, Some("f_wheel"), 1e-3));
    }
    asks(
        &to,
        &["reconcile", "reconcile.toml"],
        "readings-below-noise vehicle.data ",
    );
}

#[test]
fn every_command_that_reads_a_job_s_deck_tests_its_modulus() {
    let to = copy_example("modulus", "frame");
    edit(&to, "frame.bdf", |t| {
        t.replace("MAT1,1,2.1+5", "MAT1,1,1.+30")
    });
    for (command, job) in [
        ("modes", "place.toml"),
        ("solve", "place.toml"),
        ("cases", "place.toml"),
        ("ballast", "ballast.toml"),
        ("payload", "payload.toml"),
        ("sensitivity", "place.toml"),
    ] {
        asks(&to, &[command, job], "units-modulus material 1 ");
    }
}

#[test]
fn a_deck_whose_mass_is_more_than_numbers_can_be_is_a_fault_of_every_command() {
    for (name, from, to) in [
        ("thick", "PSHELL,1,1,6.,1,,1", "PSHELL,1,1,1.+308,1,,1"),
        ("dense", "0.3,7.85-9", "0.3,1.+308"),
        ("heavy", "ENDDATA", "CONM2,9001,180,,1.+308\nENDDATA"),
    ] {
        let folder = copy_example(&format!("mass_{name}"), "frame");
        edit(&folder, "frame.bdf", |t| t.replace(from, to));
        let says = "mass: the mass of the model";
        refuses(&folder, &["sensitivity", "recover.toml"], says);
        // `check` writes its report, including the fault.
        let (exit, _, errors) = run_command(&folder, &["check", "recover.toml"]);
        assert_eq!(exit, 2, "{errors}");
        assert!(errors.contains(says), "{errors}");
        let report = std::fs::read_to_string(folder.join("judged.out/report.html")).unwrap();
        assert!(!report.contains("mass inf") && !report.contains("gravity NaN"));
    }
}

#[test]
fn a_support_that_moves_is_refused_where_unit_loads_are_asked() {
    let to = copy_example("moving_support", "frame");
    let held = |by: &str| format!("SPC1,7,123456,1\nSPC,7,2,3,{by}\nENDDATA");
    edit(&to, "frame.bdf", |t| t.replace("ENDDATA", &held("0.01")));
    edit(&to, "recover.toml", |t| {
        t.replace("support = \"free\"", "support = 7")
    });
    for command in ["sensitivity", "recover"] {
        refuses(
            &to,
            &[command, "recover.toml"],
            "model.support: SPC set 7 moves grid 2",
        );
    }
    edit(&to, "frame.bdf", |t| {
        t.replace("SPC,7,2,3,0.01", "SPC,7,2,3,0.0")
    });
    let (exit, _, errors) = run_command(&to, &["sensitivity", "recover.toml"]);
    assert!(exit < 2, "{errors}");
}

#[test]
fn limits_of_a_vehicle_that_leave_no_value_are_faults_and_open_ones_change_nothing() {
    let identify = ["identify", "identify.toml"];
    let stated = "noise = { acc = 0.02, force = 60.0 }";
    let with = |key: &str| {
        let to = copy_example("limits", "quarter_truck");
        edit(&to, "identify.toml", |t| {
            t.replace(stated, &format!("{stated}\n{key}"))
        });
        to
    };
    for limits in [
        "[nan, 1e6]",
        "[0.0, nan]",
        "[1e6, 1e3]",
        "[1e6, 1e6]",
        "[-1e308, 1e308]",
        "[inf, inf]",
        // Negative stiffness is not physical.
        "[-1e7, -1e6]",
    ] {
        let to = with(&format!("bounds = {{ k_s = {limits} }}"));
        refuses(&to, &identify, "vehicle.bounds.k_s: ");
    }
    let to = with("places = { lf = [nan, 0.0] }");
    refuses(&to, &identify, "vehicle.places.lf: ");
    let parameters = |to: &Path| {
        let (exit, _, errors) = run_command(to, &identify);
        let text = std::fs::read(to.join("judged.out/result.json")).unwrap();
        let result: Value = serde_json::from_slice(&text).unwrap();
        assert!(result["parameters"].is_array(), "{errors}");
        (exit, result["parameters"].clone())
    };
    let free = parameters(&copy_example("no_limits", "quarter_truck"));
    for limits in ["[0.0, inf]", "[-inf, inf]", "[-1e9, 1e9]"] {
        let to = with(&format!("bounds = {{ k_s = {limits} }}"));
        assert_eq!(parameters(&to), free, "{limits}");
    }
}

#[test]
fn strain_next_to_a_table_of_loads_is_tested_too() {
    let to = copy_example("beside_loads", "frame");
    let (exit, _, errors) = run_command(&to, &["recover", "recover.toml"]);
    assert_eq!(exit, 0, "{errors}");
    std::fs::copy(to.join("judged.out/loads.csv"), to.join("loads.csv")).unwrap();
    edit(&to, "respond.toml", |t| {
        t.replace("[respond]", "[respond]\nloads = \"loads.csv\"")
    });
    let loads = std::fs::read_to_string(to.join("loads.csv")).unwrap();
    edit(&to, "loads.csv", |t| with_number(t, 3, "L.FZ.high", "-1e6"));
    refuses(&to, &["respond", "respond.toml"], "loads.csv:3: L.FZ.low: ");
    std::fs::write(to.join("loads.csv"), loads).unwrap();
    let strain = std::fs::read_to_string(to.join("strain.csv")).unwrap();
    for (factor, code) in [
        (1e-6, "readings-below-noise"),
        (1e3, "reading-beyond-gauges"),
        (1e9, "reading-impossible"),
    ] {
        std::fs::write(to.join("strain.csv"), scale_table(&strain, None, factor)).unwrap();
        asks(&to, &["respond", "respond.toml"], code);
    }
}

#[test]
fn one_reading_beyond_five_per_cent_is_doubtful_and_one_beyond_twenty_is_no_strain_of_a_metal() {
    for (number, severity) in [
        ("49000", None),
        ("60000", Some("warning")),
        ("210000", Some("error")),
    ] {
        let to = copy_example("one_reading", "frame");
        edit(&to, "strain.csv", |t| with_number(t, 3, "P01", number));
        let (_, codes, errors) = run_command(&to, &["check", "recover.toml"]);
        let found = codes.iter().find(|c| c.contains(" reading-beyond-gauges "));
        let severity_of = |c: &String| c.split(' ').next().map(str::to_owned);
        assert_eq!(
            found.and_then(severity_of).as_deref(),
            severity,
            "{number} {codes:?}\n{errors}"
        );
    }
}

/// Element 19 of the frame ends at x = 1250 mm and has a size of 260 mm. Its plate is 6 mm thick, and P01 is on its
/// face.
#[test]
fn a_point_off_its_element_is_a_warning_beyond_its_tolerance_and_an_error_beyond_its_size() {
    let tolerant = "\n[placement]\nposition_tolerance = 10.0\n";
    for (x, more, severity) in [
        ("1254", "", None),
        ("1270", "", Some("warning")),
        ("1270", tolerant, None),
        ("1600", tolerant, Some("error")),
        ("112500", "", Some("error")),
    ] {
        let to = copy_example("point", "frame");
        edit(&to, "gauges.csv", |t| with_number(t, 2, "x", x));
        edit(&to, "recover.toml", |t| format!("{t}\n# x = {x}\n{more}"));
        let (_, codes, errors) = run_command(&to, &["check", "recover.toml"]);
        let found = codes.iter().find(|c| c.contains(" point-off-element P01"));
        let severity_of = |c: &String| c.split(' ').next().map(str::to_owned);
        assert_eq!(
            found.and_then(severity_of).as_deref(),
            severity,
            "{x} {codes:?}\n{errors}"
        );
    }
}

#[test]
fn ballast_of_a_structure_without_density_is_held_against_its_weight_in_steel() {
    let to = copy_example("ballast_without_density", "frame");
    edit(&to, "frame.bdf", |t| {
        let lumps = "CONM2,9001,180,,1.-4\nCONM2,9002,71,,1.-4\nCONM2,9003,156,,1.-4";
        t.replace("2.1+5,,0.3,7.85-9", &format!("2.1+5,,0.3\n{lumps}"))
    });
    let ballast = ["ballast", "ballast.toml"];
    let (exit, codes, errors) = run_command(&to, &ballast);
    assert_eq!(exit, 0, "{codes:?}\n{errors}");
    edit(&to, "empty.csv", |t| scale_table(t, None, 1e3));
    asks(&to, &ballast, "ballast-beyond-model");
}

#[test]
fn loads_next_to_a_long_record_are_answered_without_a_comparison() {
    let to = copy_example("beside_record", "frame");
    let (exit, _, errors) = run_command(&to, &["recover", "recover.toml"]);
    assert_eq!(exit, 0, "{errors}");
    std::fs::copy(to.join("judged.out/loads.csv"), to.join("loads.csv")).unwrap();
    edit(&to, "respond.toml", |t| {
        t.replace("[respond]", "[respond]\nloads = \"loads.csv\"")
    });
    edit(&to, "strain.csv", |t| {
        let (header, rows) = t.split_once('\n').unwrap();
        let readings = rows.lines().next().unwrap().split_once(',').unwrap().1;
        let mut record = header.replacen("run", "time", 1) + "\n";
        // `check` skips records above 16 MB and does not read them completely.
        for i in 0.. {
            if record.len() > 17 << 20 {
                break;
            }
            record += &format!("{:.2},{readings}\n", f64::from(i) * 0.01);
        }
        record
    });
    let (exit, codes, errors) = run_command(&to, &["respond", "respond.toml"]);
    assert_eq!(exit, 0, "{codes:?}\n{errors}");
    let printed = |c: &String| c.contains(" gauges-not-compared ");
    assert!(codes.iter().any(printed), "{codes:?}");
}

/// A deck in mm and kg with a density in kg/m3, and a deck in inches with weight densities. No job states units.
#[test]
fn a_deck_alone_is_tested_for_its_densities() {
    let deck = |material: &str| {
        format!(
            "SOL 101\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,9.,0.,0.\nGRID,3,,9.,9.,0.\nGRID,4,,0.,9.,0.\n\
             CQUAD4,1,1,1,2,3,4\nPSHELL,1,1,.2,1,,1\n{material}\nSPC1,1,123456,1,4\nFORCE,1,2,,1.,0.,0.,1.\nENDDATA\n"
        )
    };
    let folder = copy_example("deck-alone-densities", "frame");
    for (material, wrong) in [
        ("MAT1,1,70000.,,.33,2700.", true),
        ("MAT1,1,1.0+7,,.33,.1", true),
        ("MAT1,1,70000.,,.33,2.7-9", false),
    ] {
        std::fs::write(folder.join("alone.bdf"), deck(material)).unwrap();
        for arguments in [
            &["check", "alone.bdf"][..],
            &["init", "alone.bdf", "--out", "new"],
        ] {
            let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
                .args(arguments)
                .current_dir(&folder)
                .output()
                .unwrap();
            let printed = [done.stdout, done.stderr].concat();
            let printed = String::from_utf8_lossy(&printed);
            assert_eq!(
                printed.contains("units-density"),
                wrong,
                "{arguments:?} {material}\n{printed}"
            );
            let _ = std::fs::remove_dir_all(folder.join("new"));
        }
    }
}
