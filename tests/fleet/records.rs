//! Records named by folder, pattern, list, standard input and folders of a data lake. The results equal those of
//! records named one by one.

use super::command::folder;
use super::program::{self, JOB};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

fn csv(dir: &Path, out: &str) -> String {
    std::fs::read_to_string(dir.join(out).join("fleet.csv")).unwrap()
}

#[test]
fn a_folder_a_pattern_a_list_and_standard_input_name_the_same_records() {
    let (dir, files) = folder("named");
    let some: Vec<&String> = files.iter().take(4).collect();
    std::fs::create_dir_all(dir.join("data/deeper")).unwrap();
    for (i, f) in some.iter().enumerate() {
        let to = ["data", "data/deeper"][i % 2];
        std::fs::copy(dir.join(f), dir.join(to).join(f)).unwrap();
    }
    let one_by_one = [
        "data/T0_1.csv",
        "data/deeper/T0_2.csv",
        "data/T0_3.csv",
        "data/deeper/T0_4.csv",
    ];
    let (code, result) = program::fleet(&dir, "all", &one_by_one, &[]);
    assert_eq!(code, 0, "{result}");
    let wanted = csv(&dir, "all");
    assert!(
        wanted.lines().nth(1).unwrap().starts_with("T0,4,"),
        "{wanted}"
    );

    std::fs::write(dir.join("list.txt"), one_by_one.join("\r\n")).unwrap();
    for (out, named) in [
        ("folder", vec!["data"]),
        ("pattern", vec!["data/**/*.csv"]),
        ("list", vec!["--files", "list.txt"]),
        ("both", vec!["data/T0_1.csv", "--files", "list.txt"]),
    ] {
        let (code, result) = program::fleet(&dir, out, &named, &[]);
        assert_eq!(
            (code, csv(&dir, out)),
            (0, wanted.clone()),
            "{out}: {result}"
        );
    }
    let mut child = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .current_dir(&dir)
        .args(["fleet", "job.toml", "--files", "-", "--out", "input"])
        .stdin(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    input.write_all(one_by_one.join("\n").as_bytes()).unwrap();
    drop(input);
    assert!(child.wait().unwrap().success());
    assert_eq!(csv(&dir, "input"), wanted);

    // A request that matches no record is not a request to merge the stored results.
    std::fs::write(dir.join("empty.txt"), "\n").unwrap();
    for named in [
        vec!["--files", "empty.txt"],
        vec!["--files", "missing.txt"],
        vec!["nothing/*.csv"],
        vec!["all"],
    ] {
        let (code, said) = program::fleet(&dir, "all", &named, &[]);
        assert_eq!(code, 2, "{named:?}: {said}");
        assert_eq!(csv(&dir, "all"), wanted, "{named:?}");
    }
}

#[test]
fn vehicle_and_day_may_be_folders() {
    let (dir, files) = folder("hive");
    program::fleet(&dir, "plain", &files[..3], &[]);
    let lake = JOB.replace(
        "{vehicle}_{day}.csv",
        "vehicle={vehicle}/day={day}/{any}.csv",
    );
    assert_ne!(lake, JOB);
    std::fs::write(dir.join("job.toml"), lake).unwrap();
    for (i, f) in files[..3].iter().enumerate() {
        let to = dir.join(format!("lake/vehicle=T0/day={}", i + 1));
        std::fs::create_dir_all(&to).unwrap();
        std::fs::copy(dir.join(f), to.join("part-0.csv")).unwrap();
    }
    let (code, result) = program::fleet(&dir, "hive", &["lake"], &[]);
    assert_eq!(code, 0, "{result}");
    assert_eq!(result["files"][1]["day"], "2");
    assert_eq!(csv(&dir, "hive"), csv(&dir, "plain"));
}

#[test]
fn loads_beyond_the_calibration_are_an_error() {
    let (dir, files) = folder("beyond_calibration");
    let job = std::fs::read_to_string(dir.join("job.toml")).unwrap();
    let range = "per = { force = \"kN\" }\nrange = { \"A.FZ\" = [0.0, 0.001] }";
    let job = job.replace("per = { force = \"kN\" }", range);
    std::fs::write(dir.join("job.toml"), job).unwrap();
    let (code, result) = program::fleet(&dir, "all", &files[..2], &[]);
    assert_eq!(code, 1, "{result}");
    let list = result["findings"].as_array().unwrap();
    let found = list
        .iter()
        .find(|f| f["code"] == "loads-outside-calibration");
    let found = found.unwrap_or_else(|| panic!("{result}"));
    assert_eq!(
        (found["severity"].as_str(), found["subject"].as_str()),
        (Some("error"), Some("T0 A.FZ"))
    );
}
