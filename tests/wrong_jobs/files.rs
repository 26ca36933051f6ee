//! Jobs of `examples/` whose files are cut, replaced or of a header alone.

use super::copies::{copied, edit};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Exit code and standard error of a call in a folder.
fn call(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(arguments)
        .arg("--no-cache")
        .current_dir(folder)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&done.stderr).into_owned();
    (done.status.code().unwrap_or(-1), error)
}

#[test]
fn no_output_is_written_over_what_the_command_has_read() {
    let dir = copied("own_inputs", "fleet");
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
            let (code, said) = call(&dir, &[command, "fleet.toml", "--out", out]);
            assert_eq!(code, 2, "{said}");
            assert!(said.contains(name) && said.contains("--out"), "{said}");
        }
        assert_eq!(std::fs::read(dir.join(name)).unwrap(), before);
        assert_eq!(count(), files, "nothing is left behind");
        let (code, said) = call(&dir, &[command, "fleet.toml", "--out", "elsewhere"]);
        assert_eq!(code, 0, "{said}");
        std::fs::remove_dir_all(dir.join("elsewhere")).unwrap();
    }
}

#[test]
fn a_folder_of_two_commands_is_verified_by_the_files_of_the_last() {
    let dir = copied("two_commands", "frame");
    for command in ["sensitivity", "recover"] {
        let (code, said) = call(&dir, &[command, "recover.toml"]);
        assert_eq!(code, 0, "{said}");
    }
    let (code, said) = call(&dir, &["verify", "recover.out"]);
    assert_eq!(code, 0, "{said}");
    std::fs::remove_file(dir.join("recover.out/loads.csv")).unwrap();
    let (code, said) = call(&dir, &["verify", "recover.out"]);
    assert_eq!(code, 1, "{said}");
    // What it would replace is what it verifies.
    let (code, said) = call(&dir, &["verify", "recover.out", "--out", "recover.out"]);
    assert_eq!(code, 2, "{said}");
}

#[test]
fn a_table_whose_last_number_may_be_cut_is_said_and_a_record_is_read_without_it() {
    let dir = copied("cut_record", "fleet");
    let record = dir.join("A_2026-05-01.csv");
    let whole = std::fs::read(&record).unwrap();
    let samples = || -> u64 {
        let text = std::fs::read_to_string(dir.join("out/result.json")).unwrap();
        let result: Value = serde_json::from_str(&text).unwrap();
        result["samples"].as_u64().unwrap()
    };
    let recover = ["recover", "fleet.toml", "--out", "out"];
    let (code, said) = call(&dir, &recover);
    assert_eq!(code, 0, "{said}");
    assert!(!said.contains("table-may-be-cut"), "{said}");
    let all = samples();
    for less in [2, 3, 6] {
        std::fs::write(&record, &whole[..whole.len() - less]).unwrap();
        let (_, said) = call(&dir, &recover);
        assert!(said.contains("table-may-be-cut"), "{less}: {said}");
        assert_eq!(samples(), all - 1, "{less}");
        let (_, said) = call(
            &dir,
            &["fleet", "fleet.toml", "A_2026-05-01.csv", "--out", "f"],
        );
        assert!(said.contains("table-may-be-cut"), "{less}: {said}");
    }
    // The end of the line alone: its numbers are whole.
    std::fs::write(&record, &whole[..whole.len() - 1]).unwrap();
    let (_, said) = call(&dir, &recover);
    assert!(!said.contains("table-may-be-cut"), "{said}");
    assert_eq!(samples(), all);
    let dir = copied("cut_runs", "frame");
    let strain = std::fs::read(dir.join("strain.csv")).unwrap();
    std::fs::write(dir.join("strain.csv"), &strain[..strain.len() - 2]).unwrap();
    let (code, said) = call(&dir, &["recover", "recover.toml"]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("table-may-be-cut"), "{said}");
}

#[test]
fn steps_of_angles_below_a_tenth_of_a_degree_are_refused_at_their_line() {
    let dir = copied("angles", "frame");
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
        let (code, said) = call(&dir, &["place", "place.toml"]);
        assert_eq!(code, 2, "{said}");
        assert!(
            said.contains(&format!("place.toml:{line}: candidates.angle_step_deg")),
            "{said}"
        );
    }
}

#[test]
fn fewer_gauges_than_loads_are_not_told_that_they_stand_too_close() {
    let dir = copied("few_gauges", "frame");
    edit(&dir, "place.toml", |t| {
        t.replace("gauges = 12", "gauges = 5")
    });
    edit(&dir, "place.toml", |t| {
        t.replace("spacing = 100.0", "spacing = 0.001")
    });
    let (code, said) = call(&dir, &["place", "place.toml"]);
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("loads-not-separable"), "{said}");
    assert!(!said.contains("do not fit"), "{said}");
}

#[test]
fn a_table_of_a_header_alone_is_refused_by_every_command_that_reads_it() {
    let dir = copied("no_rows", "frame");
    let cut = |name: &str| {
        let text = std::fs::read_to_string(dir.join(name)).unwrap();
        let header = text.lines().next().unwrap().to_owned();
        std::fs::write(dir.join(name), header + "\n").unwrap();
    };
    let refused = |command: &str, job: &str, name: &str| {
        let (code, said) = call(&dir, &[command, job, "--out", "out"]);
        assert_eq!(code, 2, "{command} {job}: {said}");
        assert!(
            said.contains(name) && said.contains("a header and no rows"),
            "{command} {job}: {said}"
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
    let dir = copied("named_results", "frame");
    let (code, said) = call(&dir, &["solve", "place.toml", "--out", "solved"]);
    assert_eq!(code, 0, "{said}");
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
            let (code, said) = call(&dir, &[command, job, "--out", "out"]);
            // The run that writes the results of `cases` is still to come.
            let expected = if (command, name) == ("cases", "nope.op2") {
                0
            } else {
                2
            };
            assert_eq!(code, expected, "{command} {name}: {said}");
            assert!(expected == 0 || said.contains(name), "{command}: {said}");
        }
    }
}
