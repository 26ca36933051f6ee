//! Unusual input: times out of order, truncated numbers, contradictory decks.

use super::copies::{copy_example, edit};
use std::path::Path;
use std::process::Command;

/// Returns exit code and all output of a call in a folder.
fn call(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let printed = [done.stdout, done.stderr].concat();
    // Further lines of a finding are indented.
    let printed = String::from_utf8_lossy(&printed).replace("\n    ", " ");
    (done.status.code().unwrap_or(-1), printed)
}

#[test]
fn samples_out_of_order_are_refused_by_respond_too() {
    let dir = copy_example("respond_times", "frame");
    edit(&dir, "respond.toml", |t| {
        t.replace("[respond]", "[respond]\nloads = \"loads.csv\"")
    });
    let table = |key: &str, times: [&str; 4]| {
        let rows = times.map(|t| format!("{t},1,2,3,0,0,0\n")).concat();
        let head = "N.FZ,L.FZ,R.FZ,payload.FZ,payload.MX,payload.MY";
        std::fs::write(dir.join("loads.csv"), format!("{key},{head}\n{rows}")).unwrap();
    };
    let respond = ["respond", "respond.toml"];
    table("time", ["0.0", "0.1", "0.2", "0.3"]);
    let (code, printed) = call(&dir, &respond);
    assert_eq!(code, 0, "{printed}");
    for (times, line) in [
        (["0.0", "0.2", "0.1", "0.3"], 4),
        (["0.0", "0.1", "0.1", "0.3"], 4),
        (["0.1", "0.0", "0.2", "0.3"], 3),
        (["0.0", "0.1", "later", "0.3"], 4),
    ] {
        table("time", times);
        for command in [respond, ["check", "respond.toml"]] {
            let (code, printed) = call(&dir, &command);
            assert_eq!(code, 2, "{times:?}: {printed}");
            let place = format!("loads.csv:{line}: time: ");
            assert!(printed.contains(&place), "{times:?}: {printed}");
        }
    }
    // Run names may have any order.
    table("run", ["9", "7", "8", "1"]);
    let (code, printed) = call(&dir, &respond);
    assert_eq!(code, 0, "{printed}");
}

#[test]
fn a_last_number_without_the_point_that_all_others_have_is_an_error() {
    let dir = copy_example("cut_point", "frame");
    let whole = std::fs::read_to_string(dir.join("strain.csv")).unwrap();
    let cut = whole.trim_end().rfind('.').unwrap();
    // The truncated last number is still a valid integer.
    std::fs::write(dir.join("strain.csv"), &whole[..cut]).unwrap();
    for command in ["recover", "check"] {
        let (code, printed) = call(&dir, &[command, "recover.toml"]);
        assert_eq!(code, 1, "{printed}");
        assert!(printed.contains("error [table-may-be-cut]"), "{printed}");
    }
}

#[test]
fn check_of_a_deck_reports_the_findings_of_solve_on_supports_and_shapes() {
    let dir = copy_example("strange_deck", "frame");
    let hexa = |order: [u32; 8]| {
        let ids = order.map(|i| (9000 + i).to_string());
        let mut text = String::new();
        for (i, [x, y, z]) in [
            [0, 0, 0],
            [9, 0, 0],
            [9, 9, 0],
            [0, 9, 0],
            [0, 0, 9],
            [9, 0, 9],
            [9, 9, 9],
            [0, 9, 9],
        ]
        .into_iter()
        .enumerate()
        {
            text += &format!("GRID,{},,{x}.,{y}.,{z}.\n", 9001 + i);
        }
        format!(
            "SOL 101\nCEND\nSPC = 4\nBEGIN BULK\n{text}CHEXA,1,1,{},\n,{},{}\nPSOLID,1,1\nMAT1,1,210000.,,.3,7.85-9\n\
             SPC,4,9001,123456,0.\n",
            ids[..6].join(","),
            ids[6],
            ids[7]
        )
    };
    let checked = |text: &str| {
        std::fs::write(dir.join("cube.bdf"), format!("{text}ENDDATA\n")).unwrap();
        call(&dir, &["check", "cube.bdf"])
    };
    let right = hexa([1, 2, 3, 4, 5, 6, 7, 8]);
    let (code, printed) = checked(&right);
    assert_eq!(code, 0, "{printed}");
    let (code, printed) = checked(&format!("{right}SPC,4,9001,1,0.5\n"));
    assert!(
        code == 1 && printed.contains("[contradicting-spc]"),
        "{printed}"
    );
    let (code, printed) = checked(&hexa([5, 6, 7, 8, 1, 2, 3, 4]));
    assert!(
        code == 0 && printed.contains("[inverted-solid]"),
        "{printed}"
    );
}

/// Returns the table with changed fields. `change` gets line (the header is 0), column and field.
fn fields(text: &str, change: impl Fn(usize, usize, &str) -> String) -> String {
    let line = |(i, line): (usize, &str)| {
        let fields = line.split(',').enumerate().map(|(c, f)| change(i, c, f));
        fields.collect::<Vec<_>>().join(",") + "\n"
    };
    text.lines().enumerate().map(line).collect()
}

#[test]
fn a_zero_or_held_out_file_that_is_the_strain_file_itself_is_refused() {
    let dir = copy_example("own_record", "quarter_truck");
    edit(&dir, "identify.toml", |t| {
        t.replace("hold_out = \"holdout.csv\"", "hold_out = \"data.csv\"")
    });
    for command in ["identify", "check"] {
        let (code, printed) = call(&dir, &[command, "identify.toml"]);
        assert!(
            code == 2 && printed.contains("vehicle.hold_out: ") && printed.contains("held out"),
            "{printed}"
        );
    }
    for (key, wrong) in [
        ("zero", "differences from their mean"),
        ("hold_out", "no run would remain to be held out"),
    ] {
        let dir = copy_example(&format!("own_{key}"), "frame");
        edit(&dir, "recover.toml", |t| {
            let line = format!("{key} = \"strain.csv\"\nnoise_microstrain");
            t.replace("noise_microstrain", &line)
        });
        for command in ["recover", "check"] {
            let (code, printed) = call(&dir, &[command, "recover.toml"]);
            assert_eq!(code, 2, "{printed}");
            assert!(
                printed.contains(&format!("measured.{key}: ")) && printed.contains(wrong),
                "{printed}"
            );
        }
    }
}

#[test]
fn blank_readings_and_runs_without_a_measurement_are_reported() {
    let dir = copy_example("blank_runs", "frame");
    let asked = |found: &[&str]| {
        for command in ["recover", "check"] {
            let (code, printed) = call(&dir, &[command, "recover.toml"]);
            assert_eq!(code, 0, "{printed}");
            for code in [
                "readings-missing",
                "readings-all-equal",
                "readings-repeated",
            ] {
                let is_said = printed.contains(&format!("warning [{code}]"));
                assert_eq!(
                    is_said,
                    found.contains(&code),
                    "{command} {code}: {printed}"
                );
            }
        }
    };
    asked(&[]);
    let whole = std::fs::read_to_string(dir.join("strain.csv")).unwrap();
    let change = |change: &dyn Fn(usize, usize, &str) -> String| {
        std::fs::write(dir.join("strain.csv"), fields(&whole, change)).unwrap();
    };
    let blank = |i: usize, c: usize| i == 2 && c == 3;
    change(&|i, c, f| if blank(i, c) { "" } else { f }.to_owned());
    asked(&["readings-missing"]);
    let (_, printed) = call(&dir, &["recover", "recover.toml"]);
    assert!(
        printed.contains("[readings-missing] P03 in R02"),
        "{printed}"
    );
    change(&|i, c, f| if i == 2 && c > 0 { "0" } else { f }.to_owned());
    asked(&["readings-all-equal"]);
    let first: Vec<&str> = whole.lines().nth(1).unwrap().split(',').collect();
    change(&|i, c, f| if i == 2 && c > 0 { first[c] } else { f }.to_owned());
    let (_, printed) = call(&dir, &["recover", "recover.toml"]);
    assert!(
        printed.contains("[readings-repeated] R01 and R02"),
        "{printed}"
    );
    // If a logger gives only two different numbers, equal runs are normal.
    let coarse = |f: &str| if f.starts_with('-') { "-10" } else { "10" };
    change(&|i, c, f| {
        let read = if i == 2 && c > 0 { first[c] } else { f };
        if i > 0 && c > 0 { coarse(read) } else { f }.to_owned()
    });
    let (_, printed) = call(&dir, &["check", "recover.toml"]);
    assert!(!printed.contains("readings-repeated"), "{printed}");
    // A gauge that the job ignores is not reported as missing.
    change(&|i, c, f| if i > 0 && c == 3 { "" } else { f }.to_owned());
    edit(&dir, "recover.toml", |t| {
        format!("{t}\n[[correction]]\ngauge = \"P03\"\nignore = true\n")
    });
    asked(&[]);
}

#[test]
fn a_record_with_a_constant_part_is_reported_as_standstill_or_no_measurement() {
    let dir = copy_example("still_record", "fleet");
    let file = dir.join("A_2026-05-01.csv");
    let whole = std::fs::read_to_string(&file).unwrap();
    let printed = |text: &str| {
        std::fs::write(&file, text).unwrap();
        let (code, printed) = call(&dir, &["recover", "fleet.toml"]);
        assert_eq!(code, 0, "{printed}");
        printed
    };
    assert!(!printed(&whole).contains("record-constant"));
    // From t = 14.95 s to 17.40 s at 20 Hz: zeros that a logger inserts, and values that a frozen logger repeats.
    let stuck = |i: usize| (300..350).contains(&i);
    let zeros = fields(&whole, |i, c, f| {
        if stuck(i) && c > 0 { "0" } else { f }.to_owned()
    });
    let lines: Vec<&str> = whole.lines().collect();
    let last: Vec<&str> = lines[300].split(',').collect();
    let repeated = fields(&whole, |i, c, f| {
        if stuck(i) && c > 0 { last[c] } else { f }.to_owned()
    });
    for text in [zeros, repeated] {
        let printed = printed(&text);
        assert!(
            printed.contains("warning [record-constant]")
                && printed.contains("From t = 14.950000 s to t = 17.400000 s"),
            "{printed}"
        );
    }
}

#[test]
fn noise_that_the_job_does_not_state_is_reported_as_assumed() {
    let dir = copy_example("no_noise", "frame");
    let (_, printed) = call(&dir, &["recover", "recover.toml"]);
    assert!(!printed.contains("noise-assumed"), "{printed}");
    edit(&dir, "recover.toml", |t| {
        t.replace("noise_microstrain = 0.5\n", "")
    });
    for command in ["recover", "check"] {
        let (code, printed) = call(&dir, &[command, "recover.toml"]);
        assert!(
            code == 0 && printed.contains("[noise-assumed]"),
            "{printed}"
        );
    }
}

#[test]
fn a_runs_file_of_other_runs_is_refused_by_payload_and_places_that_are_assumed_are_reported() {
    let dir = copy_example("other_runs", "frame");
    let runs = std::fs::read_to_string(dir.join("runs.csv")).unwrap();
    let payload = ["payload", "payload.toml"];
    std::fs::write(dir.join("runs.csv"), runs.replace("\nR", "\nQ")).unwrap();
    let (code, printed) = call(&dir, &payload);
    assert!(
        code == 2 && printed.contains("runs.csv:1: run: no row for any run of the strain file"),
        "{printed}"
    );
    edit(&dir, "payload.toml", |t| {
        t.replace("position = \"free\"", "position = \"known\"")
    });
    std::fs::write(dir.join("runs.csv"), &runs).unwrap();
    let (_, printed) = call(&dir, &payload);
    assert!(!printed.contains("payload-place-assumed"), "{printed}");
    let unplaced = fields(&runs, |i, c, f| {
        if i == 3 && (c == 2 || c == 3) { "" } else { f }.to_owned()
    });
    std::fs::write(dir.join("runs.csv"), unplaced).unwrap();
    let (_, printed) = call(&dir, &payload);
    assert!(printed.contains("[payload-place-assumed] R03"), "{printed}");
}

/// On Linux, every write to this device fails.
#[test]
fn an_answer_that_does_not_get_to_standard_output_is_no_success() {
    let Ok(full) = std::fs::File::options().write(true).open("/dev/full") else {
        return;
    };
    let dir = copy_example("full_output", "frame");
    for arguments in [
        &["check", "recover.toml"][..],
        &["recover", "recover.toml", "--json"],
        &["schema"],
    ] {
        let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .args(arguments)
            .current_dir(&dir)
            .stdout(full.try_clone().unwrap())
            .output()
            .unwrap();
        let printed = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{arguments:?}: {printed}");
        assert!(
            printed.contains("standard output cannot be written"),
            "{printed}"
        );
    }
}

/// A batch system terminates the command while it writes, as Ctrl-C does.
#[cfg(unix)]
#[test]
fn a_stopped_command_leaves_no_incomplete_files() {
    let dir = copy_example("told_to_end", "fleet");
    let whole = std::fs::read_to_string(dir.join("A_2026-05-01.csv")).unwrap();
    let (header, rows) = whole.split_once('\n').unwrap();
    let readings: Vec<&str> = rows.lines().map(|l| l.split_once(',').unwrap().1).collect();
    let out = dir.join("out");
    let mut ended = false;
    // Enough samples that the signal arrives during the write.
    for times in [1000, 4000, 16000] {
        let samples = (0..readings.len() * times)
            .map(|i| format!("{:.2},{}\n", 0.05 * i as f64, readings[i % readings.len()]));
        let record = format!("{header}\n{}", samples.collect::<String>());
        std::fs::write(dir.join("A_2026-05-01.csv"), record).unwrap();
        let mut running = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .args(["recover", "fleet.toml", "--out", "out", "-q"])
            .current_dir(&dir)
            .spawn()
            .unwrap();
        let files = || std::fs::read_dir(&out).map_or(0, Iterator::count);
        while files() == 0 && running.try_wait().unwrap().is_none() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let id = running.id().to_string();
        let _ = Command::new("kill").args(["-TERM", &id]).status();
        let status = running.wait().unwrap();
        if status.code() == Some(130) {
            assert_eq!(files(), 0, "files are left behind");
            ended = true;
            break;
        }
        assert_eq!(status.code(), Some(0));
        std::fs::remove_dir_all(&out).unwrap();
    }
    assert!(ended, "it was never met while it wrote");
}

#[test]
fn a_long_chain_of_load_cards_is_solved_and_a_circle_of_them_is_named() {
    const CARDS: usize = 20_000;
    let dir = copy_example("load_chain", "frame");
    let deck = |last: usize| {
        let mut text = "SOL 101\nCEND\nSPC=1\nLOAD=1\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,100.,0.,0.\nCROD,1,1,1,2\n\
                        PROD,1,1,10.\nMAT1,1,200000.,,.3,7.85-9\nSPC1,1,123456,1\nSPC1,1,23456,2\n"
            .to_owned();
        for i in 1..CARDS {
            let next = if i + 1 == CARDS { last } else { i + 1 };
            text += &format!("LOAD,{i},1.,1.,{next}\n");
        }
        text + &format!("FORCE,{CARDS},2,,100.,1.,0.,0.\nENDDATA\n")
    };
    std::fs::write(dir.join("chain.bdf"), deck(CARDS)).unwrap();
    let (code, printed) = call(&dir, &["solve", "chain.bdf", "--out", "out"]);
    assert_eq!(code, 0, "{printed}");
    let text = std::fs::read_to_string(dir.join("out/result.json")).unwrap();
    let result: serde_json::Value = serde_json::from_str(&text).unwrap();
    // The force at the end of the chain, which the support carries.
    let force = result["reactions"][0]["total"][0].as_f64().unwrap();
    assert!((force + 100.0).abs() < 1e-6, "{force}");
    std::fs::write(dir.join("circle.bdf"), deck(5)).unwrap();
    for command in ["solve", "check"] {
        let (code, printed) = call(&dir, &[command, "circle.bdf", "--out", "out2"]);
        assert!(code == 2 && printed.contains("in a circle"), "{printed}");
    }
}

#[test]
fn what_follows_plus_and_minus_in_words_is_half_of_the_interval_in_the_table() {
    let dir = copy_example("half_widths", "frame");
    let (code, printed) = call(&dir, &["recover", "recover.toml", "--out", "out"]);
    assert_eq!(code, 0, "{printed}");
    let table = std::fs::read_to_string(dir.join("out/loads.csv")).unwrap();
    let mut rows = table.lines();
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> = rows
        .map(|r| r.split(',').skip(1).map(|v| v.parse().unwrap()).collect())
        .collect();
    let mut compared = 0;
    for (l, load) in header.iter().skip(1).step_by(3).enumerate() {
        let half = |row: &Vec<f64>| (row[3 * l + 2] - row[3 * l + 1]) / 2.0;
        let widest = rows.iter().map(half).fold(0.0, f64::max);
        let words = printed.split_whitespace().skip_while(|w| w != load);
        let mut after = words.skip_while(|w| *w != "±").skip(1);
        let shown: f64 = after.next().unwrap().parse().unwrap();
        // The output has two digits.
        assert!(
            (shown / widest - 1.0).abs() < 0.05,
            "{load}: {shown} {widest}"
        );
        compared += 1;
    }
    assert_eq!(compared, 7, "{printed}");
}
