//! Runs in several files, and in spreadsheets.

use super::{as_is, load, loads, recover, table};
use serde_json::Value;
use std::fmt::Write;
use std::process::Command;

/// Returns the runs `from .. to` with another zero of every gauge, and one run without load before and after them.
fn with_own_zero(from: usize, to: usize, offset: f64, zeros: [&str; 2]) -> String {
    let plain = table("run", to, |_, g, v| {
        (v + offset * (1.0 + g as f64)).to_string()
    });
    let mut lines = plain.lines();
    let header = lines.next().unwrap();
    let empty = |name: &str| {
        let readings = [1.0, 2.0, 3.0, 4.0].map(|k| (offset * k).to_string());
        format!("{name},{}\n", readings.join(","))
    };
    let rows: String = lines.skip(from).map(|l| format!("{l}\n")).collect();
    format!("{header}\n{}{rows}{}", empty(zeros[0]), empty(zeros[1]))
}

#[test]
fn runs_held_out_in_a_file_of_their_own_have_zeros_of_their_own() {
    let mut runs = "run,A,B\n".to_owned();
    for i in 0..12 {
        let [a, b] = loads(i);
        let _ = writeln!(runs, "R{i},{a},{b}");
    }
    for zero in ["Z1", "Z2", "Z3", "Z4"] {
        let _ = writeln!(runs, "{zero},0,0");
    }
    let more = |zeros: &[&str]| {
        format!(
            "hold_out = \"held.csv\"\nzero_runs = {zeros:?}\n[runs]\nfile = \"runs.csv\"\n\
             units = {{ force = \"N\" }}\nnoise = {{ force = 0.5 }}\n"
        )
    };
    let strain = with_own_zero(0, 9, 300.0, ["Z1", "Z2"]);
    let reconcile = |name: &str, zeros: &[&str], held: &str| {
        // Creates the job. The test then writes the file with held-out runs.
        let (_, _, _, dir) = recover(name, &strain, &more(zeros));
        std::fs::write(dir.join("runs.csv"), &runs).unwrap();
        std::fs::write(dir.join("held.csv"), held).unwrap();
        let job = dir.join("job.toml");
        let out = dir.join("reconciled");
        let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .arg("reconcile")
            .arg(job)
            .arg("--out")
            .arg(&out)
            .output()
            .unwrap();
        let printed = String::from_utf8_lossy(&done.stderr).into_owned();
        let text = std::fs::read_to_string(out.join("result.json"));
        let result = text.map_or(Value::Null, |t| serde_json::from_str(&t).unwrap());
        (done.status.code(), printed, result)
    };
    // The logger was switched off between the files, so every zero differs.
    let all = ["Z1", "Z2", "Z3", "Z4"];
    let (code, printed, result) = reconcile(
        "held-zero",
        &all,
        &with_own_zero(9, 12, -700.0, ["Z3", "Z4"]),
    );
    assert_eq!(code, Some(0), "{printed}");
    assert_eq!(result["verdict"], "none");
    // Readings have an error of half a microstrain. The other zero would give a thousand times as much.
    let gap = result["gap"]["before"].as_f64().unwrap();
    assert!(gap < 5e-3, "{gap}");
    let none = table("run", 12, as_is);
    let (code, printed, _) = reconcile("held-without-zero", &all[..2], &none);
    assert_eq!(code, Some(2), "{printed}");
    assert!(
        printed.contains("`held.csv` contains none of these runs: add a run without load"),
        "{printed}"
    );
    let unknown = with_own_zero(9, 12, -700.0, ["Z3", "other"]);
    let (code, printed, _) = reconcile("held-unknown-zero", &all, &unknown);
    assert_eq!(code, Some(2), "{printed}");
    assert!(printed.contains("has a run `Z4`"), "{printed}");
}

#[cfg(feature = "xlsx")]
#[test]
fn a_refused_spreadsheet_of_several_sheets_names_the_sheet_that_was_read() {
    let mut book = rust_xlsxwriter::Workbook::new();
    for (name, head) in [("Notes", "remark"), ("Runs", "run"), ("Old", "run")] {
        let sheet = book.add_worksheet().set_name(name).unwrap();
        sheet.write_string(0, 0, head).unwrap();
        sheet.write_string(0, 1, "G1").unwrap();
        sheet.write_string(1, 0, "R1").unwrap();
        sheet.write_number(1, 1, 2.0).unwrap();
    }
    let bytes = book.save_to_buffer().unwrap();
    let (_, _, _, dir) = recover("runs-sheets", &table("run", 12, as_is), "");
    std::fs::write(dir.join("strain.xlsx"), &bytes).unwrap();
    let job = std::fs::read_to_string(dir.join("job.toml")).unwrap();
    let job = job.replace("strain.csv", "strain.xlsx");
    std::fs::write(dir.join("sheets.toml"), job).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["recover", dir.join("sheets.toml").to_str().unwrap()])
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{printed}");
    for word in ["first sheet", "`Notes`", "`Runs`", "`Old`"] {
        assert!(printed.contains(word), "{word}: {printed}");
    }
}

#[cfg(feature = "xlsx")]
#[test]
fn a_spreadsheet_of_runs_is_read_as_the_same_table_in_text() {
    let text = table("run", 12, as_is);
    let (code, printed, from_text, dir) = recover("runs-text", &text, "");
    assert_eq!(code, 0, "{printed}");
    let mut book = rust_xlsxwriter::Workbook::new();
    let sheet = book.add_worksheet();
    for (r, line) in text.lines().enumerate() {
        for (c, field) in line.split(',').enumerate() {
            let (r, c) = (r as u32, c as u16);
            match field.parse::<f64>() {
                Ok(v) => sheet.write_number(r, c, v).unwrap(),
                Err(_) => sheet.write_string(r, c, field).unwrap(),
            };
        }
    }
    let bytes = book.save_to_buffer().unwrap();
    std::fs::write(dir.join("strain.xlsx"), &bytes).unwrap();
    let job = std::fs::read_to_string(dir.join("job.toml")).unwrap();
    std::fs::write(
        dir.join("sheet.toml"),
        job.replace("strain.csv", "strain.xlsx"),
    )
    .unwrap();
    let run = |command: &str| {
        Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .args([command, dir.join("sheet.toml").to_str().unwrap()])
            .output()
            .unwrap()
    };
    for command in ["recover", "check"] {
        let done = run(command);
        let printed = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(0), "{command}: {printed}");
    }
    let result = std::fs::read(dir.join("sheet.out/result.json")).unwrap();
    let from_sheet: Value = serde_json::from_slice(&result).unwrap();
    assert_eq!(from_sheet["loads"], from_text["loads"]);
    // Half of the file, and a file with a directory that claims an impossible size.
    std::fs::write(dir.join("strain.xlsx"), &bytes[..bytes.len() / 2]).unwrap();
    assert_eq!(run("recover").status.code(), Some(2));
    let mut bomb = bytes;
    let list = bomb.windows(4).position(|w| w == b"PK\x01\x02").unwrap();
    bomb[list + 24..list + 28].copy_from_slice(&u32::MAX.to_le_bytes());
    std::fs::write(dir.join("strain.xlsx"), &bomb).unwrap();
    let done = run("recover");
    let printed = String::from_utf8_lossy(&done.stderr);
    assert!(
        done.status.code() == Some(2) && printed.contains("unpacked"),
        "{printed}"
    );
}

/// Returns the table of twelve runs with readings in these units. The units are in the header or in a row below it.
fn in_units(units: [(&str, f64); 4], below: bool) -> String {
    let text = table("run", 12, |_, g, v| (v * units[g].1).to_string());
    let rows = text.split_once('\n').unwrap().1;
    let word = |g: usize| units[g].0;
    match below {
        true => format!(
            "run,G1,G2,G3,G4\n,{},{},{},{}\n{rows}",
            word(0),
            word(1),
            word(2),
            word(3)
        ),
        false => format!(
            "run,G1 [{}],G2 ({}),G3 [{}],G4\n{rows}",
            word(0),
            word(1),
            word(2)
        ),
    }
}

#[test]
fn units_of_run_tables_are_read_as_those_of_records() {
    let (code, printed, plain, _) = recover("units-plain", &table("run", 12, as_is), "");
    assert_eq!(code, 0, "{printed}");
    let units = [("um/m", 1.0), ("m/m", 1e-6), ("mm/m", 1e-3), ("µm/m", 1.0)];
    for (name, below) in [("units-row", true), ("units-header", false)] {
        let (code, printed, result, _) = recover(name, &in_units(units, below), "");
        assert_eq!(code, 0, "{printed}");
        for run in ["R0", "R11"] {
            for l in ["A", "B"] {
                let [a, b] = [&plain, &result].map(|r| load(r, run, l)[0]);
                // Division and multiplication change the last digit of a reading.
                assert!((a - b).abs() < 1e-9 * a.abs(), "{name} {run} {l}: {a} {b}");
            }
        }
    }
    // A unit that is not strain is a fault with gauge, unit and remedy. Columns that are not gauges may have any unit.
    let volts = [("um/m", 1.0), ("mV/V", 1.0), ("um/m", 1.0), ("um/m", 1.0)];
    for below in [true, false] {
        let (code, printed, _, _) = recover("units-volts", &in_units(volts, below), "");
        assert_eq!(code, 2, "{printed}");
        assert!(
            printed.contains("G2") && printed.contains("`mV/V` is not a unit of strain"),
            "{printed}"
        );
    }
    let text = table("run", 12, as_is).replace("G4\n", "G4,temperature [°C]\n");
    let (head, rows) = text.split_once('\n').unwrap();
    let rows: String = rows.lines().map(|l| format!("{l},21.5\n")).collect();
    let (code, printed, result, _) = recover("units-other", &format!("{head}\n{rows}"), "");
    assert_eq!(code, 0, "{printed}");
    assert_eq!(load(&result, "R3", "A"), load(&plain, "R3", "A"));
}

#[test]
fn a_rosette_of_a_given_s_reads_by_its_legs() {
    let strain = table("run", 8, as_is);
    let (exit, printed, single, dir) = recover("rosette", &strain, "");
    assert_eq!(exit, 0, "{printed}");
    for file in ["S.csv", "strain.csv"] {
        let text = std::fs::read_to_string(dir.join(file)).unwrap();
        let legs = [("G1", "R.a"), ("G2", "R.b"), ("G3", "R.c")];
        let text = legs.iter().fold(text, |t, (g, leg)| t.replace(g, leg));
        std::fs::write(dir.join(file), text).unwrap();
    }
    let job = std::fs::read_to_string(dir.join("job.toml")).unwrap();
    let gauges = "[[gauge]]\nname = \"G4\"\n[[gauge]]\nname = \"R\"\nrosette = \"rectangular\"\n";
    std::fs::write(dir.join("job.toml"), format!("{job}{gauges}")).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .arg("recover")
        .arg(dir.join("job.toml"))
        .arg("--out")
        .arg(dir.join("legs"))
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(0), "{printed}");
    let text = std::fs::read_to_string(dir.join("legs/result.json")).unwrap();
    let legs: Value = serde_json::from_str(&text).unwrap();
    for run in 0..8 {
        for name in ["A", "B"] {
            let [own, own_sigma] = load(&legs, &format!("R{run}"), name);
            let [value, sigma] = load(&single, &format!("R{run}"), name);
            // The gauges are in another order, which changes only rounding.
            assert!(
                (own - value).abs() < 1e-9 * value.abs().max(1.0),
                "{run} {name}"
            );
            assert!((own_sigma - sigma).abs() < 1e-9 * sigma, "{run} {name}");
        }
    }
}
