//! `fleet` as a user runs it: records of three vehicles in small tables, with a given S.

use super::drawn::Splitmix;
use super::program::{self, JOB, scratch};
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};

pub const GAUGES: usize = 5;
/// Microstrain per kN.
pub const S: [[f64; 2]; GAUGES] = [
    [10.0, 1.0],
    [-8.0, 3.0],
    [2.0, 9.0],
    [1.0, -11.0],
    [6.0, 6.0],
];
pub const SAMPLES: usize = 1200;

/// Returns the loads of a day in kN: waves whose size depends on vehicle and day.
fn loads(vehicle: usize, day: usize) -> Vec<[f64; 2]> {
    let mut numbers = Splitmix((vehicle * 100 + day) as u64);
    let (mut a, mut b) = ([0.0; 2], [0.0; 2]);
    let size = 10.0 * (1.0 + vehicle as f64);
    (0..SAMPLES)
        .map(|_| {
            for w in [&mut a, &mut b] {
                *w = [1.9 * w[0] - 0.96 * w[1] + 0.1 * numbers.next(), w[0]];
            }
            [size * a[0], size * (0.5 * a[0] + b[0])]
        })
        .collect()
}

/// Returns the table of a day. One gauge may be dead or missing.
fn table(vehicle: usize, day: usize, left_out: Option<usize>, dead: Option<usize>) -> String {
    table_of(vehicle, day, left_out, |_, readings| {
        if let Some(g) = dead {
            readings[g] = 7.0;
        }
    })
}

/// Returns the table of a day. `change` gets the sample and its readings, and may change them.
pub fn table_of(
    vehicle: usize,
    day: usize,
    left_out: Option<usize>,
    mut change: impl FnMut(usize, &mut [f64; GAUGES]),
) -> String {
    let mut text = String::from("time");
    let kept: Vec<usize> = (0..GAUGES).filter(|g| Some(*g) != left_out).collect();
    kept.iter()
        .for_each(|g| write!(text, ",G{g} [um/m]").unwrap());
    text.push('\n');
    for (i, f) in loads(vehicle, day).iter().enumerate() {
        write!(text, "{:.2}", i as f64 * 0.01).unwrap();
        let mut readings = S.map(|row| row[0] * f[0] + row[1] * f[1]);
        change(i, &mut readings);
        for g in &kept {
            write!(text, ",{:.6}", readings[*g]).unwrap();
        }
        text.push('\n');
    }
    text
}

/// Creates a folder with a job and sixty records of three vehicles.
pub fn folder(name: &str) -> (PathBuf, Vec<String>) {
    let dir = scratch(name);
    std::fs::write(dir.join("job.toml"), JOB).unwrap();
    let mut s = String::from("gauge,A.FZ,B.FZ\n");
    for (g, row) in S.iter().enumerate() {
        writeln!(s, "G{g},{},{}", row[0], row[1]).unwrap();
    }
    std::fs::write(dir.join("S.csv"), s).unwrap();
    let mut files = Vec::new();
    for vehicle in 0..3 {
        for day in 1..=20 {
            let file = format!("T{vehicle}_{day}.csv");
            std::fs::write(dir.join(&file), table(vehicle, day, None, None)).unwrap();
            files.push(file);
        }
    }
    (dir, files)
}

pub fn fleet(dir: &Path, out: &str, files: &[String], more: &[&str]) -> (i32, Value) {
    program::fleet(dir, out, files, more)
}

fn csv(dir: &Path, out: &str) -> String {
    std::fs::read_to_string(dir.join(out).join("fleet.csv")).unwrap()
}

/// Returns code, subject and message of the findings of some severities.
pub fn findings_of(result: &Value, severities: &[&str]) -> Vec<[String; 3]> {
    let list = result["findings"].as_array().unwrap();
    let of = |f: &&Value| severities.contains(&f["severity"].as_str().unwrap());
    let words = |f: &Value| ["code", "subject", "message"].map(|k| f[k].as_str().unwrap().into());
    list.iter().filter(of).map(words).collect()
}

#[test]
fn one_run_threads_shards_and_a_merge_of_what_is_kept_write_the_same_bytes() {
    let (dir, files) = folder("same");
    let (code, result) = fleet(&dir, "all", &files, &[]);
    assert_eq!(code, 0, "{result}");
    assert!(
        findings_of(&result, &["warning", "error"]).is_empty(),
        "{result}"
    );
    assert!(!result["files"].as_array().unwrap().is_empty());
    for file in result["files"].as_array().unwrap() {
        assert_eq!(file["findings"], Value::Array(vec![]), "{file}");
    }
    let all = csv(&dir, "all");
    let mut rows = all.lines();
    assert_eq!(
        rows.next(),
        Some("vehicle,files,hours,load,max,min,damage,damage_low,damage_high")
    );
    assert_eq!(rows.count(), 6);
    // The largest load of each vehicle, from the loads that generate the strain.
    assert!(!result["vehicles"].as_array().unwrap().is_empty());
    for (v, vehicle) in result["vehicles"].as_array().unwrap().iter().enumerate() {
        assert_eq!(vehicle["files"], 20);
        for l in 0..2 {
            let largest = (1..=20)
                .flat_map(|d| loads(v, d))
                .map(|f| f[l])
                .fold(f64::MIN, f64::max);
            let got = vehicle["loads"][l]["max"].as_f64().unwrap();
            // Strain is written with six decimals.
            assert!((got - largest).abs() < 1e-4, "{v} {l}: {got} {largest}");
        }
    }
    let (code, _) = fleet(&dir, "one", &files, &["--threads", "1"]);
    assert_eq!((code, csv(&dir, "one")), (0, all.clone()));
    // Four shards into one folder with files in another order, followed by a merge.
    let turned: Vec<String> = files.iter().rev().cloned().collect();
    for n in [3, 1, 4, 2] {
        let (code, part) = fleet(&dir, "shards", &turned, &["--shard", &format!("{n}/4")]);
        assert_eq!((code, part["files"].as_array().unwrap().len()), (0, 15));
    }
    let (code, merged) = fleet(&dir, "shards", &[], &[]);
    assert_eq!((code, csv(&dir, "shards")), (0, all.clone()));
    assert_eq!(merged["files"].as_array().unwrap().len(), 60);
    // A second run gives equal results. Records with stored results are not decoded.
    let (code, _) = fleet(&dir, "all", &files, &[]);
    assert_eq!((code, csv(&dir, "all")), (0, all));
    assert_eq!(std::fs::read_dir(dir.join("all/days")).unwrap().count(), 60);
    // Another job has other results.
    std::fs::write(dir.join("job.toml"), JOB.replace("0.02", "0.03")).unwrap();
    let (code, said) = fleet(&dir, "all", &[], &[]);
    assert_eq!(code, 2, "{said}");
}

#[test]
fn what_is_broken_is_said_and_nothing_else_is_lost() {
    let (dir, mut files) = folder("broken");
    let whole = fleet(&dir, "before", &files, &[]).1;
    // The faults: a record cut within a line, a missing gauge, a gauge dead from day 15 on. Also a second copy, a name
    // without vehicle and day, and a missing file.
    let text = std::fs::read_to_string(dir.join("T0_3.csv")).unwrap();
    std::fs::write(
        dir.join("T0_3.csv"),
        &text[..text[..text.len() / 2].rfind('\n').unwrap() + 6],
    )
    .unwrap();
    std::fs::write(dir.join("T1_5.csv"), table(1, 5, Some(4), None)).unwrap();
    for day in 15..=20 {
        std::fs::write(
            dir.join(format!("T2_{day}.csv")),
            table(2, day, None, Some(1)),
        )
        .unwrap();
    }
    std::fs::copy(dir.join("T1_7.csv"), dir.join("T1_7b.csv")).unwrap();
    std::fs::copy(dir.join("T1_8.csv"), dir.join("notes.csv")).unwrap();
    files.extend([
        "T1_7b.csv".to_owned(),
        "notes.csv".to_owned(),
        "T9_1.csv".to_owned(),
    ]);
    let (code, result) = fleet(&dir, "after", &files, &[]);
    assert_eq!(code, 1, "{result}");
    let status = |path: &str| {
        let list = result["files"].as_array().unwrap();
        list.iter().find(|f| f["path"] == path).unwrap()["status"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    for (path, expected) in [
        ("T0_3.csv", "failed"),
        ("T1_5.csv", "done"),
        ("T2_16.csv", "done"),
        ("T1_7.csv", "done"),
        ("T1_7b.csv", "copy"),
        ("notes.csv", "failed"),
        ("T9_1.csv", "failed"),
    ] {
        assert_eq!(status(path), expected, "{path}");
    }
    let has = |code: &str, subject: &str| {
        let list = result["findings"].as_array().unwrap();
        list.iter()
            .any(|f| f["code"] == code && f["subject"].as_str().unwrap().contains(subject))
    };
    assert!(has("gauge-without-strain", "G4"));
    assert!(has("fleet-second-copy", "T1_7b.csv"));
    assert!(has("gauge-silent", "T2 G1"));
    let gauge = &result["vehicles"][2]["gauges"][1];
    assert_eq!(gauge["dead_days"][0], "15");
    // The loads from the remaining gauges are equal within rounding. The vehicle with a cut record has one day less.
    for v in 1..3 {
        for l in 0..2 {
            let [a, b] =
                [&whole, &result].map(|r| r["vehicles"][v]["loads"][l]["damage"].as_f64().unwrap());
            assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
        }
    }
    assert_eq!(result["vehicles"][0]["files"], 19);
}

/// Changes one stored result.
fn spoil(dir: &Path, out: &str, change: impl Fn(String) -> String) {
    let mut kept: Vec<PathBuf> = std::fs::read_dir(dir.join(out).join("days"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "json"))
        .collect();
    kept.sort();
    let text = std::fs::read_to_string(&kept[0]).unwrap();
    let other = change(text.clone());
    assert_ne!(text, other);
    std::fs::write(&kept[0], other).unwrap();
}

#[test]
fn a_merge_knows_which_parts_are_missing() {
    let (dir, files) = folder("parts");
    let (code, _) = fleet(&dir, "out", &files, &["--shard", "1/2"]);
    assert_eq!(code, 0);
    let (code, result) = fleet(&dir, "out", &[], &[]);
    assert_eq!(code, 1, "{result}");
    let errors = findings_of(&result, &["error"]);
    let [[name, subject, message]] = errors.as_slice() else {
        panic!("{errors:?}");
    };
    assert_eq!(name, "fleet-records-missing");
    // Every second record, in the order of the names.
    assert!(subject.starts_with("T0_10.csv"), "{subject}");
    assert!(
        message.contains("Of 60 requested records")
            && message.contains(" 30 have")
            && message.contains("shard 2/2"),
        "{message}"
    );
    let (code, _) = fleet(&dir, "out", &files, &["--shard", "2/2"]);
    assert_eq!(code, 0);
    let (code, result) = fleet(&dir, "out", &[], &[]);
    assert_eq!(code, 0, "{result}");
}

#[test]
fn a_kept_result_that_was_cut_or_changed_is_an_error_of_the_merge_and_done_anew_by_a_run() {
    let (dir, files) = folder("spoilt");
    let (code, whole) = fleet(&dir, "out", &files, &[]);
    assert_eq!(code, 0, "{whole}");
    let changes: [fn(String) -> String; 2] = [
        |text| text[..500].to_owned(),
        |text| text.replacen("\"value\":", "\"value\":9", 1),
    ];
    for change in changes {
        spoil(&dir, "out", change);
        let (code, result) = fleet(&dir, "out", &[], &[]);
        assert_eq!(code, 1, "{result}");
        let errors = findings_of(&result, &["error"]);
        assert!(
            errors
                .iter()
                .any(|f| f[0] == "fleet-result-damaged" && f[1].contains("days")),
            "{errors:?}"
        );
        let (code, again) = fleet(&dir, "out", &files, &[]);
        assert_eq!(code, 0, "{again}");
        assert_eq!(again["vehicles"], whole["vehicles"]);
        assert_eq!(fleet(&dir, "out", &[], &[]).0, 0);
    }
}

#[test]
fn a_blank_hour_is_no_hour_of_work() {
    let (dir, files) = folder("blank");
    let text = table_of(0, 1, None, |i, y| {
        if i >= SAMPLES / 2 {
            y.fill(f64::NAN);
        }
    });
    std::fs::write(dir.join("T0_1.csv"), text).unwrap();
    let (_, result) = fleet(&dir, "out", &files[..1], &[]);
    let hours = result["vehicles"][0]["hours"].as_f64().unwrap();
    // Half of the samples, at 100 Hz.
    let expected = (SAMPLES / 2) as f64 / 100.0 / 3600.0;
    assert!((hours / expected - 1.0).abs() < 1e-9, "{hours} {expected}");
}

#[test]
fn a_knee_that_says_nothing_or_can_not_be_is_a_fault_at_its_line() {
    let (dir, files) = folder("knee");
    for (key, field) in [
        ("slope_below_knee = 9.0", "fleet.slope_below_knee"),
        ("knee_range = 1e308", "fleet.knee_range"),
    ] {
        std::fs::write(dir.join("job.toml"), format!("{JOB}{key}\n")).unwrap();
        let (code, said) = fleet(&dir, "out", &files[..1], &[]);
        assert_eq!(code, 2, "{said}");
        let fault = &said["faults"][0];
        assert_eq!(fault["field"], field, "{said}");
        assert_eq!(fault["line"], JOB.lines().count() + 1, "{said}");
    }
}

#[test]
fn a_record_that_has_the_name_of_an_output_is_not_written_over() {
    let (dir, files) = folder("own");
    std::fs::rename(dir.join(&files[0]), dir.join("fleet.csv")).unwrap();
    let job = JOB.replace("{vehicle}_{day}.csv", "{vehicle}e{day}.csv");
    std::fs::write(dir.join("job.toml"), job).unwrap();
    let before = std::fs::read(dir.join("fleet.csv")).unwrap();
    let (code, said) = fleet(&dir, ".", &["fleet.csv".to_owned()], &[]);
    assert_eq!(code, 2, "{said}");
    let fault = &said["faults"][0];
    assert_eq!(fault["field"], "output", "{said}");
    assert!(
        fault["file"].as_str().unwrap().ends_with("fleet.csv")
            && fault["remedy"].to_string().contains("--out"),
        "{said}"
    );
    assert_eq!(std::fs::read(dir.join("fleet.csv")).unwrap(), before);
}

#[test]
fn what_fleet_can_not_do_is_said() {
    let (dir, files) = folder("refused");
    let (code, said) = fleet(&dir, "nothing", &[], &[]);
    assert_eq!(code, 2, "{said}");
    for shard in ["0/4", "5/4", "x"] {
        assert_eq!(
            fleet(&dir, "shard", &files, &["--shard", shard]).0,
            2,
            "{shard}"
        );
    }
    std::fs::write(dir.join("job.toml"), JOB.replace("{day}", "{tag}")).unwrap();
    let (code, said) = fleet(&dir, "form", &files, &[]);
    assert_eq!(code, 2);
    assert!(said.to_string().contains("fleet.file_name"), "{said}");
}

#[test]
fn a_record_whose_strain_the_loads_do_not_explain_is_an_error_that_names_it() {
    let (dir, files) = folder("unexplained");
    let write = |name: &str, text: String| std::fs::write(dir.join(name), text).unwrap();
    // A gauge with reversed polarity, two exchanged gauges, a spike of one sample, a channel that ends at 40
    // microstrain.
    write("T1_5.csv", table_of(1, 5, None, |_, y| y[2] = -y[2]));
    write("T1_9.csv", table_of(1, 9, None, |_, y| y.swap(0, 1)));
    let spike = |i: usize, y: &mut [f64; GAUGES]| y[3] += if i == 701 { 3000.0 } else { 0.0 };
    write("T0_4.csv", table_of(0, 4, None, spike));
    write(
        "T2_7.csv",
        table_of(2, 7, None, |_, y| y[0] = y[0].clamp(-40.0, 40.0)),
    );
    let (code, result) = fleet(&dir, "out", &files, &[]);
    assert_eq!(code, 1, "{result}");
    let errors = findings_of(&result, &["error"]);
    let has = |code: &str, subject: &str, words: &str| {
        let like = |f: &&[String; 3]| f[0] == code && f[1] == subject && f[2].contains(words);
        assert!(
            errors.iter().any(|f| like(&f)),
            "{code} {subject} {words}: {errors:?}"
        );
    };
    has("strain-not-explained", "T0", "T0_4.csv (t = 7.01)");
    has(
        "strain-not-explained",
        "T1",
        "2 of 20 records, the first T1_5.csv",
    );
    has("strain-not-explained", "T2", "T2_7.csv");
    has("input-sign-reversed", "T1 G2", "T1_5.csv");
    let all = findings_of(&result, &["warning", "error"]);
    let suspects = |f: &&[String; 3]| f[0] == "gauge-suspect" && f[1] == "T0 G3";
    assert_eq!(all.iter().filter(suspects).count(), 1, "{all:?}");
    // Each finding is at its record and at no other.
    let wrong = ["T0_4.csv", "T1_5.csv", "T1_9.csv", "T2_7.csv"];
    assert!(!result["files"].as_array().unwrap().is_empty());
    for file in result["files"].as_array().unwrap() {
        let found = file["findings"].as_array().unwrap();
        let error = found.iter().any(|f| f["code"] == "strain-not-explained");
        assert_eq!(
            error,
            wrong.contains(&file["path"].as_str().unwrap()),
            "{file}"
        );
        assert_eq!(found.is_empty(), !error, "{file}");
    }
    // The result does not depend on the number of threads, nor on the use of stored results.
    for (out, files, more) in [
        ("one", &files[..], &["--threads", "1"][..]),
        ("out", &files[..], &[]),
        ("out", &[], &[]),
    ] {
        let (code, again) = fleet(&dir, out, files, more);
        assert_eq!(code, 1);
        assert_eq!(again["findings"], result["findings"]);
        assert_eq!(again["files"], result["files"]);
        assert_eq!(again["vehicles"], result["vehicles"]);
    }
}

#[test]
fn right_records_with_the_stated_noise_have_no_finding() {
    let (dir, files) = folder("noisy");
    let job = JOB.replace("noise_microstrain = 0.001", "noise_microstrain = 1.0");
    std::fs::write(dir.join("job.toml"), job).unwrap();
    let mut numbers = Splitmix(5);
    for (vehicle, day) in (0..3).flat_map(|v| (1..=20).map(move |d| (v, d))) {
        // Uniform random numbers with standard deviation 1.
        let text = table_of(vehicle, day, None, |_, y| {
            y.iter_mut()
                .for_each(|y| *y += 3.0_f64.sqrt() * numbers.next());
        });
        std::fs::write(dir.join(format!("T{vehicle}_{day}.csv")), text).unwrap();
    }
    let (code, result) = fleet(&dir, "out", &files, &[]);
    assert_eq!(code, 0, "{result}");
    let found = findings_of(&result, &["warning", "error"]);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn a_gauge_that_is_stuck_on_every_day_is_told_with_all_its_days() {
    let (dir, files) = folder("stuck");
    for day in 1..=20 {
        let text = table(2, day, None, Some(1));
        std::fs::write(dir.join(format!("T2_{day}.csv")), text).unwrap();
    }
    let (code, result) = fleet(&dir, "out", &files, &[]);
    assert_eq!(code, 0, "{result}");
    let found = findings_of(&result, &["warning"]);
    let [[code, subject, message]] = found.as_slice() else {
        panic!("{found:?}");
    };
    assert_eq!((code.as_str(), subject.as_str()), ("gauge-silent", "T2 G1"));
    assert!(message.contains("20 of 20 days"), "{message}");
    let gauges = result["vehicles"][2]["gauges"].as_array().unwrap();
    assert_eq!(gauges.len(), GAUGES);
    assert_eq!(gauges[1]["dead_days"].as_array().unwrap().len(), 20);
}

#[test]
fn a_gap_is_a_warning_and_loads_that_no_sample_tells_are_an_error() {
    let (dir, files) = folder("gaps");
    // As in `recover`: for a while only one gauge reads, which determines neither load. Later, 30 lines are missing.
    let lost = table_of(1, 4, None, |i, y| {
        if (200..220).contains(&i) {
            y[1..].fill(f64::NAN);
        }
    });
    let cut = |(i, _): &(usize, &str)| !(301..331).contains(i);
    let lines: Vec<&str> = lost.lines().enumerate().filter(cut).map(|l| l.1).collect();
    std::fs::write(dir.join("T1_4.csv"), lines.join("\n") + "\n").unwrap();
    let (code, result) = fleet(&dir, "out", &files, &[]);
    assert_eq!(code, 0, "{result}");
    let mut found = findings_of(&result, &["warning", "error"]);
    found.sort();
    let [[gaps, _, lines], [samples, _, said]] = found.as_slice() else {
        panic!("{found:?}");
    };
    assert_eq!(
        [gaps.as_str(), samples.as_str()],
        ["record-gaps", "samples-with-gaps"]
    );
    assert!(
        lines.contains("T1_4.csv: 30 samples are missing in 1 gaps"),
        "{lines}"
    );
    assert!(
        said.contains("In 50 of 1200 samples")
            && said.contains("At least 50 of these samples have a blank load"),
        "{said}"
    );
    // Every gauge reads in some samples, but no two gauges read in the same one.
    let in_turn = table_of(2, 3, None, |i, y| {
        y.iter_mut()
            .enumerate()
            .filter(|(g, _)| i % GAUGES != *g)
            .for_each(|(_, y)| *y = f64::NAN);
    });
    std::fs::write(dir.join("T2_3.csv"), in_turn).unwrap();
    let (code, result) = fleet(&dir, "out", &files, &[]);
    assert_eq!(code, 1, "{result}");
    let errors = findings_of(&result, &["error"]);
    assert!(
        errors
            .iter()
            .any(|f| f[0] == "loads-without-values" && f[1].starts_with("T2")),
        "{errors:?}"
    );
}

/// The zero of G2 drifts by 12 microstrain over every record of T1, with peaks of hundreds of microstrain. Over the
/// tested samples its mean is 6.
#[test]
fn a_drift_hidden_by_peaks_is_found_in_every_record_with_its_mean() {
    let (dir, files) = folder("drift");
    let job = JOB.replace("noise_microstrain = 0.001", "noise_microstrain = 1.0");
    std::fs::write(dir.join("job.toml"), job).unwrap();
    let mut numbers = Splitmix(5);
    let mut peak = 0.0_f64;
    for (vehicle, day) in (0..3).flat_map(|v| (1..=20).map(move |d| (v, d))) {
        let text = table_of(vehicle, day, None, |i, y| {
            // Uniform random numbers with standard deviation 1.
            y.iter_mut()
                .for_each(|y| *y += 3.0_f64.sqrt() * numbers.next());
            peak = peak.max(y[2].abs());
            if vehicle == 1 {
                y[2] += 12.0 * i as f64 / SAMPLES as f64;
            }
        });
        std::fs::write(dir.join(format!("T{vehicle}_{day}.csv")), text).unwrap();
    }
    assert!(peak > 300.0, "{peak}");
    let (_, result) = fleet(&dir, "out", &files, &[]);
    let found = findings_of(&result, &["warning", "error"]);
    let suspects: Vec<&[String; 3]> = found.iter().filter(|f| f[0] == "gauge-suspect").collect();
    let [[_, subject, message]] = suspects.as_slice() else {
        panic!("{found:?}");
    };
    assert_eq!(subject, "T1 G2");
    assert!(message.contains("20 of 20 records"), "{message}");
    let size = message.split_once("deviates by ").unwrap().1;
    let size: f64 = size.split(' ').next().unwrap().parse().unwrap();
    // 170 samples with noise 1, and a drift that is estimated as a constant. The standard error of its mean is a few
    // tenths.
    assert!(
        message.contains("microstrain from") && (size - 6.0).abs() < 1.0,
        "{message}"
    );
    // No other vehicle has a finding.
    assert!(!found.is_empty());
    assert!(found.iter().all(|f| f[1].starts_with("T1")), "{found:?}");
}

#[test]
fn a_gauge_named_with_what_looks_like_a_unit_is_read_as_any_other() {
    let (dir, files) = folder("labels");
    let files = files[..2].to_vec();
    let (code, plain) = fleet(&dir, "plain", &files, &[]);
    assert_eq!(code, 0, "{plain}");
    let s = std::fs::read_to_string(dir.join("S.csv")).unwrap();
    std::fs::write(dir.join("S.csv"), s.replace("G0,", "G0 (left),")).unwrap();
    for (file, header) in files.iter().zip(["G0 (left)", "G0 (left) (um/m)"]) {
        let text = std::fs::read_to_string(dir.join(file)).unwrap();
        std::fs::write(dir.join(file), text.replace("G0 [um/m]", header)).unwrap();
    }
    let (code, named) = fleet(&dir, "named", &files, &[]);
    assert_eq!(code, 0, "{named}");
    assert!(
        findings_of(&named, &["warning"])
            .iter()
            .all(|f| f[0] != "gauge-without-strain"),
        "{named}"
    );
    // Equal except for the digests, because the record files differ.
    let loads = |r: &Value| {
        let mut loads = r["vehicles"][0]["loads"].clone();
        for load in loads.as_array_mut().unwrap() {
            load["max_at"]["sha256"].take();
            load["min_at"]["sha256"].take();
        }
        loads
    };
    assert!(!loads(&plain).as_array().unwrap().is_empty());
    assert_eq!(loads(&named), loads(&plain));
}

#[test]
fn a_gauge_that_is_ignored_needs_neither_a_zero_nor_a_unit_of_strain() {
    let (dir, files) = folder("ignored");
    let files = files[..1].to_vec();
    let names = (1..GAUGES).map(|g| format!(",G{g}")).collect::<String>();
    let zeros = ",0".repeat(GAUGES - 1);
    std::fs::write(
        dir.join("zero.csv"),
        format!("time,G0 [mV/V]{names}\n0,1{zeros}\n0.01,2{zeros}\n"),
    )
    .unwrap();
    let job = JOB.replace("[measured]\n", "[measured]\nzero = \"zero.csv\"\n");
    let ignored = "[[correction]]\ngauge = \"G0\"\nignore = true\n";
    std::fs::write(dir.join("job.toml"), job + ignored).unwrap();
    let text = std::fs::read_to_string(dir.join(&files[0])).unwrap();
    std::fs::write(dir.join(&files[0]), text.replace("G0 [um/m]", "G0 [mV/V]")).unwrap();
    let (code, result) = fleet(&dir, "out", &files, &[]);
    assert_eq!(code, 0, "{result}");
}
