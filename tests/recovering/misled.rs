//! Input that looks right but is wrong: a stuck channel, a run that no file contains.

use super::{as_is, codes, load, recover, table};

#[test]
fn a_channel_stuck_at_one_value_counts_as_one_that_is_left_out() {
    let stuck = table("time", 400, |_, g, v| {
        if g == 2 { "3.0".into() } else { v.to_string() }
    });
    let left_out = "[[correction]]\ngauge = \"G3\"\nignore = true\n";
    let (code, printed, without, _) = recover("left-out", &stuck, left_out);
    assert_eq!(code, 0, "{printed}");
    let (code, printed, r, _) = recover("stuck", &stuck, "");
    assert_eq!(code, 0, "{printed}");
    let findings = r["findings"].as_array().unwrap();
    let names = |f: &serde_json::Value| f["code"] == "gauge-silent" && f["subject"] == "G3";
    assert!(findings.iter().any(names), "{findings:?}");
    assert!(r["damage"][0]["damage"].as_f64().unwrap() > 0.0);
    assert_eq!(r["damage"], without["damage"]);
}

#[test]
fn a_channel_that_dies_within_a_record_counts_as_blank_from_there_on() {
    let died = |value: &'static str| {
        table("time", 400, move |i, g, v| {
            if g == 2 && i >= 150 {
                value.into()
            } else {
                v.to_string()
            }
        })
    };
    let (code, printed, blank, _) = recover("died-blank", &died(""), "");
    assert_eq!(code, 0, "{printed}");
    // With G3, sigma of A in one sample is .73 of the noise. Without G3 it is .90.
    let (_, _, clean, _) = recover("died-not", &table("time", 400, as_is), "");
    let width = |r: &serde_json::Value| {
        let of = |key: &str| r["damage"][0][key].as_f64().unwrap();
        (of("damage_high") - of("damage_low")) / of("damage")
    };
    assert!(
        width(&blank) > 1.05 * width(&clean),
        "{} {}",
        width(&blank),
        width(&clean)
    );
    for value in ["0", "-37.5"] {
        let (code, printed, r, _) = recover("died", &died(value), "");
        assert_eq!(code, 0, "{printed}");
        let findings = r["findings"].as_array().unwrap();
        let names = |f: &serde_json::Value| {
            let message = f["message"].as_str().unwrap();
            f["code"] == "gauge-silent"
                && f["subject"] == "G3"
                && message.contains("a constant reading from t = 1.500000 s to t = 3.990000 s")
        };
        assert!(findings.iter().any(names), "{findings:?}");
        assert!(r["damage"][0]["damage"].as_f64().unwrap() > 0.0);
        assert_eq!(r["damage"], blank["damage"]);
        assert_eq!(r["loads"], blank["loads"]);
    }
}

#[test]
fn a_truck_that_stops_has_no_stuck_channels() {
    // Rounded readings, and loads that are constant from sample 150 on.
    let still = |_: usize, g: usize| super::strain(250.0, 130.0)[g].round().to_string();
    let text = table("time", 400, |i, g, v| {
        if i >= 150 { still(i, g) } else { v.to_string() }
    });
    let (_, printed, r, _) = recover("stopped", &text, "");
    assert!(!codes(&r).contains(&"gauge-silent".to_owned()), "{printed}");
}

#[test]
fn a_truck_that_stands_still_has_no_stuck_channels() {
    // Rounded readings of a constant load: every channel has one value.
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
    let (_, printed, r, _) = recover("parked", &text, "");
    assert!(!codes(&r).contains(&"gauge-silent".to_owned()), "{printed}");
}

#[test]
fn a_held_out_run_that_no_file_has_is_a_fault_of_every_command_that_reads_runs() {
    let runs = table("run", 6, as_is);
    let (code, printed, _, dir) = recover("held", &runs, "hold_out = [\"R99\"]\n");
    assert_eq!(code, 2, "{printed}");
    assert!(
        printed.contains("`strain.csv` does not contain run `R99`"),
        "{printed}"
    );
    let (code, printed, r, _) = recover("held-right", &runs, "hold_out = [\"R5\"]\n");
    assert_eq!(code, 0, "{printed}");
    assert!(load(&r, "R5", "A")[1] > 0.0);
    let checked = std::process::Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["check", &dir.join("job.toml").display().to_string()])
        .output()
        .unwrap();
    assert_eq!(checked.status.code(), Some(2));
}

#[test]
fn a_gap_affects_only_its_samples_and_loads_that_no_sample_determines_are_an_error() {
    // From sample 200 on, only one gauge reads for a while, which determines neither load. From 300 on, 30 lines are
    // missing.
    let lost = |i: usize, g: usize, v: f64| match (i, g) {
        (200..=219, 1..) => String::new(),
        _ => v.to_string(),
    };
    let text = table("time", 501, lost);
    let cut = |(i, _): &(usize, &str)| !(301..331).contains(i);
    let lines: Vec<&str> = text.lines().enumerate().filter(cut).map(|l| l.1).collect();
    let (code, errors, result, dir) = recover("gaps", &(lines.join("\n") + "\n"), "");
    assert_eq!(code, 0, "{errors}");
    let found = codes(&result);
    for code in ["samples-with-gaps", "record-gaps"] {
        assert!(found.contains(&code.to_owned()), "{code}: {found:?}");
    }
    assert_eq!(result["gaps"], 50);
    let csv = std::fs::read_to_string(dir.join("job.out/loads.csv")).unwrap();
    let blank = csv.lines().filter(|l| l.contains(",,")).count();
    assert_eq!(blank, 50, "{csv}");
    // Every gauge reads in some samples, but no two gauges read in the same one.
    let in_turn = |i: usize, g: usize, v: f64| match i % 4 == g {
        true => v.to_string(),
        false => String::new(),
    };
    let (code, _, result, _) = recover("in-turn", &table("time", 400, in_turn), "");
    assert_eq!(code, 1, "{result}");
    assert!(
        codes(&result).contains(&"loads-without-values".to_owned()),
        "{result}"
    );
}
