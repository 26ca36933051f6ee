//! Input that looks right and isn't: a channel that is stuck, a run that no file has.

use super::{as_is, codes, load, recover, table};

#[test]
fn a_channel_stuck_at_one_value_counts_as_one_that_is_left_out() {
    let stuck = table("time", 400, |_, g, v| {
        if g == 2 { "3.0".into() } else { v.to_string() }
    });
    let left_out = "[[correction]]\ngauge = \"G3\"\nignore = true\n";
    let (code, said, without, _) = recover("left-out", &stuck, left_out);
    assert_eq!(code, 0, "{said}");
    let (code, said, r, _) = recover("stuck", &stuck, "");
    assert_eq!(code, 0, "{said}");
    let findings = r["findings"].as_array().unwrap();
    let names = |f: &serde_json::Value| f["code"] == "gauge-silent" && f["subject"] == "G3";
    assert!(findings.iter().any(names), "{findings:?}");
    assert!(r["damage"][0]["damage"].as_f64().unwrap() > 0.0);
    assert_eq!(r["damage"], without["damage"]);
}

#[test]
fn a_truck_that_stands_still_has_no_stuck_channels() {
    // Rounded readings of a load that doesn't change: every channel gives one value.
    let parked = table("time", 1, as_is);
    let first = parked
        .lines()
        .nth(1)
        .unwrap()
        .split_once(',')
        .unwrap()
        .1
        .to_owned();
    let mut text = parked.lines().next().unwrap().to_owned() + "\n";
    for i in 0..400 {
        text += &format!("{},{first}\n", f64::from(i) * 0.01);
    }
    let (_, said, r, _) = recover("parked", &text, "");
    assert!(!codes(&r).contains(&"gauge-silent".to_owned()), "{said}");
}

#[test]
fn a_held_out_run_that_no_file_has_is_a_fault_of_every_command_that_reads_runs() {
    let runs = table("run", 6, as_is);
    let (code, said, _, dir) = recover("held", &runs, "hold_out = [\"R99\"]\n");
    assert_eq!(code, 2, "{said}");
    assert!(said.contains("`strain.csv` has no run `R99`"), "{said}");
    let (code, said, r, _) = recover("held-right", &runs, "hold_out = [\"R5\"]\n");
    assert_eq!(code, 0, "{said}");
    assert!(load(&r, "R5", "A")[1] > 0.0);
    let checked = std::process::Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["check", &dir.join("job.toml").display().to_string()])
        .output()
        .unwrap();
    assert_eq!(checked.status.code(), Some(2));
}
