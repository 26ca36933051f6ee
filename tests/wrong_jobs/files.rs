//! Jobs of `examples/` with files that are cut, replaced or have only a header.

use super::copies::{copy_example, edit};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Returns exit code and standard error of a call in a folder.
fn call(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .arg("--no-cache")
        .current_dir(folder)
        .output()
        .unwrap();
    // Further lines of a finding are indented.
    let error = String::from_utf8_lossy(&done.stderr).replace("\n    ", " ");
    (done.status.code().unwrap_or(-1), error)
}

#[test]
fn no_output_is_written_over_what_the_command_has_read() {
    let dir = copy_example("own_inputs", "fleet");
    std::fs::rename(dir.join("s_wheels.csv"), dir.join("sensitivity.csv")).unwrap();
    std::fs::rename(dir.join("A_2026-05-01.csv"), dir.join("loads.csv")).unwrap();
    edit(&dir, "fleet.toml", |t| {
        t.replace("s_wheels.csv", "sensitivity.csv")
    });
    edit(&dir, "fleet.toml", |t| {
        t.replace("A_2026-05-01.csv", "loads.csv")
    });
    for (command, name) in [("sensitivity", "sensitivity.csv"), ("recover", "loads.csv")] {
        let before = std::fs::read(dir.join(name)).unwrap();
        let count = || std::fs::read_dir(&dir).unwrap().count();
        let files = count();
        for out in [".", "../own_inputs"] {
            let (code, printed) = call(&dir, &[command, "fleet.toml", "--out", out]);
            assert_eq!(code, 2, "{printed}");
            assert!(
                printed.contains(name) && printed.contains("--out"),
                "{printed}"
            );
        }
        assert_eq!(std::fs::read(dir.join(name)).unwrap(), before);
        assert_eq!(count(), files, "nothing is left behind");
        let (code, printed) = call(&dir, &[command, "fleet.toml", "--out", "elsewhere"]);
        assert_eq!(code, 0, "{printed}");
        std::fs::remove_dir_all(dir.join("elsewhere")).unwrap();
    }
}

#[test]
fn a_file_that_no_command_wrote_is_refused_before_anything_is_computed_and_stays() {
    let dir = copy_example("own_files", "frame");
    let mine = "a table of my own";
    for (command, name) in [
        ("sensitivity", "sensitivity.csv"),
        ("place", "gluing_sheet.md"),
        ("recover", "report.html"),
        ("solve", "results.op2"),
        ("check", "result.json"),
    ] {
        let out = dir.join("out");
        let _ = std::fs::remove_dir_all(&out);
        std::fs::create_dir_all(&out).unwrap();
        std::fs::write(out.join(name), mine).unwrap();
        let (code, printed) = call(&dir, &[command, "recover.toml", "--out", "out"]);
        assert_eq!(code, 2, "{command}: {printed}");
        assert!(
            printed.contains(name) && printed.contains("--out"),
            "{printed}"
        );
        assert_eq!(std::fs::read_to_string(out.join(name)).unwrap(), mine);
        assert_eq!(std::fs::read_dir(&out).unwrap().count(), 1, "{command}");
    }
    // Some file names depend on the answer. The command tests for these files as soon as it has the answer.
    let out = dir.join("late");
    std::fs::create_dir_all(&out).unwrap();
    std::fs::write(out.join("loads.xlsx"), mine).unwrap();
    let (code, printed) = call(&dir, &["recover", "recover.toml", "--out", "late"]);
    assert_eq!(code, 2, "{printed}");
    assert!(printed.contains("loads.xlsx"), "{printed}");
    assert_eq!(
        std::fs::read_to_string(out.join("loads.xlsx")).unwrap(),
        mine
    );
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 1);
    // `demo` must not overwrite a job either.
    let (code, printed) = call(&dir, &["demo", "."]);
    assert_eq!(code, 2, "{printed}");
    let place = std::fs::read_to_string(dir.join("place.toml")).unwrap();
    assert!(place.contains("Three-wheeled carrier"));
}

#[test]
fn a_command_overwrites_its_own_files_and_reports_files_of_others() {
    let dir = copy_example("own_again", "frame");
    let files = |out: &str| -> Vec<String> {
        let entries = std::fs::read_dir(dir.join(out)).unwrap();
        let mut names: Vec<String> = entries
            .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    };
    for _ in 0..2 {
        let (code, printed) = call(&dir, &["sensitivity", "recover.toml"]);
        assert_eq!(code, 0, "{printed}");
    }
    let before = std::fs::read(dir.join("recover.out/sensitivity.csv")).unwrap();
    let (code, printed) = call(&dir, &["recover", "recover.toml"]);
    assert_eq!(code, 0, "{printed}");
    assert!(
        printed.contains(
            "also contains files of `sensitivity` (sensitivity.csv, sensitivity.report.html, sensitivity.result.json)"
        ),
        "{printed}"
    );
    let after = std::fs::read(dir.join("recover.out/sensitivity.csv")).unwrap();
    assert_eq!(before, after);
    let (code, printed) = call(&dir, &["recover", "recover.toml", "--out", "alone"]);
    assert_eq!(code, 0, "{printed}");
    assert!(!printed.contains("also contains"), "{printed}");
    // Two commands at the same time keep the entries of each other.
    let run = |command: &str| {
        Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .args([command, "recover.toml", "--no-cache", "--out", "both"])
            .current_dir(&dir)
            .spawn()
            .unwrap()
    };
    for mut child in ["sensitivity", "recover", "cases"].map(run) {
        assert_eq!(child.wait().unwrap().code(), Some(0));
    }
    let list = std::fs::read_to_string(dir.join("both/.strainbridge")).unwrap();
    for name in files("both").iter().filter(|n| *n != ".strainbridge") {
        let is_listed = list
            .lines()
            .any(|l| l.split('\t').nth(1) == Some(name.as_str()));
        assert!(is_listed, "{name} in {list}");
    }
}

#[test]
fn a_folder_of_two_commands_is_verified_by_the_files_of_the_last() {
    let dir = copy_example("two_commands", "frame");
    for command in ["sensitivity", "recover"] {
        let (code, printed) = call(&dir, &[command, "recover.toml"]);
        assert_eq!(code, 0, "{printed}");
    }
    let (code, printed) = call(&dir, &["verify", "recover.out"]);
    assert_eq!(code, 0, "{printed}");
    std::fs::remove_file(dir.join("recover.out/loads.csv")).unwrap();
    let (code, printed) = call(&dir, &["verify", "recover.out"]);
    assert_eq!(code, 1, "{printed}");
    // The command would replace the files that it verifies.
    let (code, printed) = call(&dir, &["verify", "recover.out", "--out", "recover.out"]);
    assert_eq!(code, 2, "{printed}");
}

#[test]
fn a_folder_of_a_fleet_is_verified_from_its_records() {
    let dir = copy_example("verified_fleet", "fleet");
    let days = ["A_2026-05-01.csv", "A_2026-05-02.csv", "B_2026-05-01.csv"];
    let mut fleet = vec!["fleet", "fleet.toml"];
    fleet.extend(days);
    let (code, printed) = call(&dir, &fleet);
    assert_eq!(code, 0, "{printed}");
    let (code, printed) = call(&dir, &["verify", "fleet.out"]);
    assert_eq!(code, 0, "{printed}");
    let record = std::fs::read_to_string(dir.join(days[0])).unwrap();
    let last = record.trim_end().rfind('\n').unwrap();
    std::fs::write(dir.join(days[0]), &record[..=last]).unwrap();
    let (code, printed) = call(&dir, &["verify", "fleet.out"]);
    assert_eq!(code, 1, "{printed}");
    std::fs::remove_file(dir.join(days[0])).unwrap();
    let (code, printed) = call(&dir, &["verify", "fleet.out"]);
    assert_ne!(code, 0, "{printed}");
}

#[test]
fn a_table_whose_last_number_may_be_cut_is_reported_and_a_record_is_read_without_it() {
    let dir = copy_example("cut_record", "fleet");
    let record = dir.join("A_2026-05-01.csv");
    let whole = std::fs::read(&record).unwrap();
    let samples = || -> u64 {
        let text = std::fs::read_to_string(dir.join("out/result.json")).unwrap();
        let result: Value = serde_json::from_str(&text).unwrap();
        result["samples"].as_u64().unwrap()
    };
    let recover = ["recover", "fleet.toml", "--out", "out"];
    let (code, printed) = call(&dir, &recover);
    assert_eq!(code, 0, "{printed}");
    assert!(!printed.contains("table-may-be-cut"), "{printed}");
    let all = samples();
    for less in [2, 3, 6] {
        std::fs::write(&record, &whole[..whole.len() - less]).unwrap();
        let (_, printed) = call(&dir, &recover);
        assert!(printed.contains("table-may-be-cut"), "{less}: {printed}");
        assert_eq!(samples(), all - 1, "{less}");
        let (_, printed) = call(
            &dir,
            &["fleet", "fleet.toml", "A_2026-05-01.csv", "--out", "f"],
        );
        assert!(printed.contains("table-may-be-cut"), "{less}: {printed}");
    }
    // Without the last line end, the numbers are still complete.
    std::fs::write(&record, &whole[..whole.len() - 1]).unwrap();
    let (_, printed) = call(&dir, &recover);
    assert!(!printed.contains("table-may-be-cut"), "{printed}");
    assert_eq!(samples(), all);
    let dir = copy_example("cut_runs", "frame");
    let strain = std::fs::read(dir.join("strain.csv")).unwrap();
    std::fs::write(dir.join("strain.csv"), &strain[..strain.len() - 2]).unwrap();
    // All numbers of the table have two decimals, but the last number has one.
    for command in ["recover", "check"] {
        let (code, printed) = call(&dir, &[command, "recover.toml"]);
        assert_eq!(code, 1, "{printed}");
        assert!(printed.contains("error [table-may-be-cut]"), "{printed}");
    }
    // If the number of decimals varies, as in numbers typed by hand, it shows nothing.
    let text = String::from_utf8(strain).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let written = format!("{header}\n{}", rows.replace("0,", ","));
    std::fs::write(dir.join("strain.csv"), &written[..written.len() - 2]).unwrap();
    let (code, printed) = call(&dir, &["recover", "recover.toml"]);
    assert_eq!(code, 0, "{printed}");
    assert!(printed.contains("warning [table-may-be-cut]"), "{printed}");
}

#[test]
fn a_record_whose_rate_changes_gets_a_finding_and_keeps_its_samples() {
    let dir = copy_example("rate_changes", "fleet");
    let samples = |out: &str| -> u64 {
        let text = std::fs::read_to_string(dir.join(out).join("result.json")).unwrap();
        let result: Value = serde_json::from_str(&text).unwrap();
        result["samples"].as_u64().unwrap()
    };
    let (code, printed) = call(&dir, &["recover", "fleet.toml", "--out", "whole"]);
    assert_eq!(code, 0, "{printed}");
    // 20 Hz. The second half has only every other sample, and it ends with the last sample.
    let half = (samples("whole") / 2) as usize;
    edit(&dir, "A_2026-05-01.csv", |t| {
        let lines: Vec<&str> = t.lines().collect();
        let last = lines.len() - 1;
        let kept = lines.iter().enumerate();
        let kept = kept.filter(|(i, _)| *i <= half || (last - i).is_multiple_of(2));
        kept.map(|(_, l)| format!("{l}\n")).collect()
    });
    let (_, printed) = call(&dir, &["recover", "fleet.toml", "--out", "changed"]);
    assert!(printed.contains("The sample rate changes at"), "{printed}");
    assert!(printed.contains("from 20 Hz to 10 Hz"), "{printed}");
    assert!(!printed.contains("record-gaps"), "{printed}");
    assert_eq!(samples("changed"), samples("whole"));
}

#[test]
fn a_record_of_no_number_is_refused_without_one() {
    let dir = copy_example("no_number", "fleet");
    edit(&dir, "A_2026-05-01.csv", |t| {
        let lines = t.lines().enumerate().map(|(i, line)| match i {
            0 => format!("{line}\n"),
            _ => {
                let (time, rest) = line.split_once(',').unwrap();
                let fields = rest.split(',').map(|_| ",1e300");
                format!("{time}{}\n", fields.collect::<String>())
            }
        });
        lines.collect()
    });
    let (code, printed) = call(&dir, &["recover", "fleet.toml", "--out", "out"]);
    assert_eq!(code, 1, "{printed}");
    for word in ["NaN", "inf "] {
        assert!(!printed.contains(word), "{printed}");
    }
    // One run without any reading.
    let dir = copy_example("no_reading", "frame");
    edit(&dir, "strain.csv", |t| {
        let lines = t.lines().map(|line| match line.split_once(',') {
            Some(("R03", rest)) => {
                let fields = rest.split(',').map(|_| ",1e300");
                format!("R03{}\n", fields.collect::<String>())
            }
            _ => format!("{line}\n"),
        });
        lines.collect()
    });
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["recover", "recover.toml", "--no-cache"])
        .current_dir(&dir)
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&done.stdout);
    assert_eq!(done.status.code(), Some(1), "{printed}");
    assert!(printed.contains("run not solvable (R03)"), "{printed}");
    let loads = std::fs::read_to_string(dir.join("recover.out/loads.csv")).unwrap();
    let row = loads.lines().find(|l| l.starts_with("R03,")).unwrap();
    assert!(row["R03".len()..].chars().all(|c| c == ','), "{row}");
    assert!(
        !printed.contains("NaN") && !printed.contains("inf "),
        "{printed}"
    );
}

#[test]
fn names_of_a_megabyte_and_columns_without_number_are_not_repeated_in_messages() {
    let dir = copy_example("long_names", "frame");
    let name = "n".repeat(1_000_000);
    edit(&dir, "strain.csv", |t| t.replacen("P01", &name, 1));
    for command in ["recover", "check"] {
        let (_, printed) = call(&dir, &[command, "recover.toml", "--out", "out"]);
        assert!(printed.contains("strain-without-gauge"), "{command}");
        assert!(printed.len() < 20_000, "{command}: {} bytes", printed.len());
    }
    let dir = copy_example("many_columns", "frame");
    edit(&dir, "strain.csv", |t| {
        let lines = t.lines().enumerate().map(|(i, line)| {
            let more = (0..20_000).map(|c| match i {
                0 => format!(",unknown{c}"),
                _ => ",0".to_owned(),
            });
            format!("{line}{}\n", more.collect::<String>())
        });
        lines.collect()
    });
    let (_, printed) = call(&dir, &["recover", "recover.toml", "--out", "out"]);
    assert!(printed.contains("and 19992 more"), "{printed}");
    assert!(printed.len() < 20_000, "{} bytes", printed.len());
}

#[test]
fn steps_of_angles_below_a_tenth_of_a_degree_are_refused_at_their_line() {
    let dir = copy_example("angles", "frame");
    for step in ["1e-9", "0.05"] {
        let job = dir.join("place.toml");
        let text = std::fs::read_to_string(&job).unwrap();
        let line = 1 + text
            .lines()
            .position(|l| l.starts_with("angle_step_deg"))
            .unwrap();
        let from = text.lines().nth(line - 1).unwrap();
        edit(&dir, "place.toml", |t| {
            t.replace(from, &format!("angle_step_deg = {step}"))
        });
        let (code, printed) = call(&dir, &["place", "place.toml"]);
        assert_eq!(code, 2, "{printed}");
        assert!(
            printed.contains(&format!("place.toml:{line}: candidates.angle_step_deg")),
            "{printed}"
        );
    }
}

#[test]
fn fewer_gauges_than_loads_are_not_reported_as_too_close() {
    let dir = copy_example("few_gauges", "frame");
    edit(&dir, "place.toml", |t| {
        t.replace("gauges = 12", "gauges = 5")
    });
    edit(&dir, "place.toml", |t| {
        t.replace("spacing = 100.0", "spacing = 0.001")
    });
    let (code, printed) = call(&dir, &["place", "place.toml"]);
    assert_eq!(code, 1, "{printed}");
    assert!(printed.contains("loads-not-separable"), "{printed}");
    assert!(!printed.contains("do not fit"), "{printed}");
}

#[test]
fn a_table_of_a_header_alone_is_refused_by_every_command_that_reads_it() {
    let dir = copy_example("no_rows", "frame");
    let cut = |name: &str| {
        let text = std::fs::read_to_string(dir.join(name)).unwrap();
        let header = text.lines().next().unwrap().to_owned();
        std::fs::write(dir.join(name), header + "\n").unwrap();
    };
    let refused = |command: &str, job: &str, name: &str| {
        let (code, printed) = call(&dir, &[command, job, "--out", "out"]);
        assert_eq!(code, 2, "{command} {job}: {printed}");
        assert!(
            printed.contains(name) && printed.contains("a header and no rows"),
            "{command} {job}: {printed}"
        );
    };
    cut("runs.csv");
    for (command, job) in [
        ("payload", "payload.toml"),
        ("study", "study.toml"),
        ("check", "payload.toml"),
    ] {
        refused(command, job, "runs.csv");
    }
    cut("gauges.csv");
    for command in ["check", "solve", "cases", "sensitivity", "modes", "recover"] {
        refused(command, "recover.toml", "gauges.csv");
    }
}

#[test]
fn results_that_a_job_names_are_opened_by_those_that_have_no_use_for_them() {
    let dir = copy_example("named_results", "frame");
    let (code, printed) = call(&dir, &["solve", "place.toml", "--out", "solved"]);
    assert_eq!(code, 0, "{printed}");
    let whole = std::fs::read(dir.join("solved/results.op2")).unwrap();
    std::fs::write(dir.join("cut.op2"), &whole[..whole.len() * 3 / 5]).unwrap();
    for name in ["cut.op2", "nope.op2"] {
        for job in ["place.toml", "ballast.toml"] {
            std::fs::copy(
                Path::new(env!("CARGO_MANIFEST_DIR"))
                    .join("examples/frame")
                    .join(job),
                dir.join(job),
            )
            .unwrap();
            let deck = "deck = \"frame.bdf\"\n";
            edit(&dir, job, |t| {
                t.replace(deck, &format!("{deck}results = [\"{name}\"]\n"))
            });
        }
        for (command, job) in [
            ("solve", "place.toml"),
            ("modes", "place.toml"),
            ("cases", "place.toml"),
            ("ballast", "ballast.toml"),
        ] {
            let (code, printed) = call(&dir, &[command, job, "--out", "out"]);
            // The results for `cases` come from a later run.
            let expected = if (command, name) == ("cases", "nope.op2") {
                0
            } else {
                2
            };
            assert_eq!(code, expected, "{command} {name}: {printed}");
            assert!(
                expected == 0 || printed.contains(name),
                "{command}: {printed}"
            );
        }
    }
}
