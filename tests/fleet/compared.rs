//! Comparison of damage with a reference day, a target and a mission, the origin of its numbers, and gauges over
//! several days. The damage of the waves is known in closed form.

use super::drawn::Splitmix;
use super::program::{self, JOB, scratch};
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

const GAUGES: usize = 6;
/// Microstrain per kN.
const S: [[f64; 2]; GAUGES] = [
    [10.0, 1.0],
    [-8.0, 3.0],
    [2.0, 9.0],
    [1.0, -11.0],
    [6.0, 6.0],
    [4.0, -5.0],
];
/// Samples per period. Peak and valley are samples.
const PERIOD: usize = 40;
/// Periods of a record.
const PERIODS: usize = 30;
const SLOPE: i32 = 5;

/// Returns a record at 100 Hz. Load A is a cosine of this amplitude, load B has 0.7 of the amplitude and twice the
/// frequency. `change` may change the readings.
fn record(amplitude: f64, periods: usize, change: impl Fn(usize, &mut [f64; GAUGES])) -> String {
    let mut text = String::from("time");
    (0..GAUGES).for_each(|g| write!(text, ",G{g} [um/m]").unwrap());
    text.push('\n');
    for i in 0..=periods * PERIOD {
        let turn = std::f64::consts::TAU * i as f64 / PERIOD as f64;
        let f = [amplitude * turn.cos(), 0.7 * amplitude * (2.0 * turn).cos()];
        let mut y = S.map(|row| row[0] * f[0] + row[1] * f[1]);
        change(i, &mut y);
        write!(text, "{:.2}", i as f64 * 0.01).unwrap();
        y.iter().for_each(|v| write!(text, ",{v:.6}").unwrap());
        text.push('\n');
    }
    text
}

/// Returns the damage from peak to peak. A period is a cycle with twice the amplitude as range.
fn damage(amplitude: f64, periods: usize) -> f64 {
    periods as f64 * (2.0 * amplitude).powi(SLOPE)
}

/// Returns the duration in hours. A sample lasts a hundredth of a second.
fn hours(periods: usize) -> f64 {
    (periods * PERIOD + 1) as f64 * 0.01 / 3600.0
}

fn folder(name: &str, job: &str, records: &[(&str, String)]) -> PathBuf {
    let dir = scratch(&format!("compared_{name}"));
    std::fs::write(dir.join("job.toml"), format!("{JOB}{job}")).unwrap();
    let mut s = String::from("gauge,A.FZ,B.FZ\n");
    for (g, row) in S.iter().enumerate() {
        writeln!(s, "G{g},{},{}", row[0], row[1]).unwrap();
    }
    std::fs::write(dir.join("S.csv"), s).unwrap();
    for (file, text) in records {
        std::fs::write(dir.join(file), text).unwrap();
    }
    dir
}

fn fleet(dir: &Path, files: &[&str], more: &[&str]) -> (i32, Value) {
    program::fleet(dir, "out", files, more)
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("{v}"))
}

/// Fails if two numbers differ by more than 1e-3.
///
/// The program adds the stated noise of 1e-4 kN twice and three times to estimate its bias. This changes ranges of 4 kN
/// and more by about 3e-5, and the fifth power by 2e-4.
fn is_close(a: f64, b: f64) {
    assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
}

fn keep_readings(_: usize, _: &mut [f64; GAUGES]) {}

#[test]
fn a_factor_on_every_load_is_that_factor_to_the_slope_and_the_error_of_s_leaves_the_ratio() {
    let job = "reference = { vehicle = \"T1\", day = \"1\" }\ntarget = { \"A.FZ\" = 1e6 }\n";
    let records = [
        ("T1_1.csv", record(4.0, PERIODS, keep_readings)),
        ("T2_1.csv", record(6.0, PERIODS, keep_readings)),
        ("T3_1.csv", record(4.01, PERIODS, keep_readings)),
        ("T3_2.csv", record(6.0, PERIODS, |_, y| y[4] = 7.0)),
    ];
    let dir = folder("factor", job, &records);
    let files = records.each_ref().map(|r| r.0);
    let (code, result) = fleet(&dir, &files, &[]);
    assert_eq!(code, 0, "{result}");
    assert_eq!(result["reference"]["path"], "T1_1.csv");
    let load = |v: usize, l: usize| &result["vehicles"][v]["loads"][l];
    let ratio = |v, l| ["value", "low", "high"].map(|k| number(&load(v, l)["to_reference"][k]));
    for l in 0..2 {
        // The reference day has the ratio one without uncertainty.
        assert!(ratio(0, l).iter().all(|r| (r - 1.0).abs() < 1e-9));
        let [value, low, high] = ratio(1, l);
        is_close(value, 1.5_f64.powi(SLOPE));
        assert!(low <= value && value <= high);
        // An error of S of 2 % at every gauge gives several per cent of the damage. It cancels in the ratio.
        let own = load(1, l);
        let width = number(&own["damage_high"]) / number(&own["damage_low"]);
        assert!(width > 1.05, "{width}");
        assert!(high / low < 1.001, "{low} {high}");
        // With fewer gauges on one day, the additional uncertainty is not common to both days.
        let [_, low, high] = ratio(2, l);
        assert!(high / low > 1.001, "{low} {high}");
    }
    is_close(
        number(&load(0, 0)["to_target"]["value"]),
        damage(4.0, PERIODS) / 1e6,
    );
    let share = &load(1, 0)["to_target"];
    is_close(
        number(&share["high"]),
        number(&load(1, 0)["damage_high"]) / 1e6,
    );
    assert!(load(1, 1)["to_target"].is_null());
    let table = std::fs::read_to_string(dir.join("out/fleet_relative.csv")).unwrap();
    assert_eq!(table.lines().count(), 7);
    // The known columns come first, and there are no others.
    let table = std::fs::read_to_string(dir.join("out/fleet.csv")).unwrap();
    assert!(table.starts_with("vehicle,files,hours,load,max,min,damage,damage_low,damage_high\n"));
}

#[test]
fn sums_of_loads_are_counted_like_loads() {
    let job = "target = { total = 1e6 }\n[[combination]]\nname = \"total\"\nterms = { \"A.FZ\" = 1.0, \"B.FZ\" = 1.0 }\n\
               [[combination]]\nname = \"twice\"\nterms = { \"A.FZ\" = 2.0 }\n";
    let dir = folder(
        "sums",
        job,
        &[("T1_1.csv", record(4.0, PERIODS, keep_readings))],
    );
    let (code, result) = fleet(&dir, &["T1_1.csv"], &[]);
    assert_eq!(code, 0, "{result}");
    let load = |l: usize| &result["vehicles"][0]["loads"][l];
    assert_eq!(load(2)["load"], "total", "{result}");
    // From 1.7 of the amplitude down to the lowest sample, up to -0.3, down and up again.
    let turn = |i: usize| std::f64::consts::TAU * i as f64 / PERIOD as f64;
    let sum = |i: usize| 4.0 * (turn(i).cos() + 0.7 * (2.0 * turn(i)).cos());
    let lowest = (0..PERIOD).map(sum).fold(f64::INFINITY, f64::min);
    let period = (sum(0) - lowest).powi(SLOPE) + (sum(PERIOD / 2) - lowest).powi(SLOPE);
    is_close(number(&load(2)["damage"]), PERIODS as f64 * period);
    is_close(number(&load(2)["max"]), sum(0));
    is_close(number(&load(2)["min"]), lowest);
    is_close(
        number(&load(2)["to_target"]["value"]),
        PERIODS as f64 * period / 1e6,
    );
    // Twice a load is the same load in a smaller unit. Damage and its relative uncertainty scale accordingly.
    let power = 2_f64.powi(SLOPE);
    for key in ["damage", "damage_low", "damage_high"] {
        is_close(number(&load(3)[key]), power * number(&load(0)[key]));
    }
    let table = std::fs::read_to_string(dir.join("out/fleet.csv")).unwrap();
    assert!(table.contains("\nT1,1,") && table.contains(",total,"));
    // A sum of a load that S lacks is a fault of the job.
    let job = "[[combination]]\nname = \"total\"\nterms = { \"C.FZ\" = 1.0 }\n";
    let dir = folder(
        "no_sum",
        job,
        &[("T1_1.csv", record(4.0, 1, keep_readings))],
    );
    let (code, said) = fleet(&dir, &["T1_1.csv"], &[]);
    assert_eq!(code, 2, "{said}");
}

#[test]
fn a_mission_is_the_damage_an_hour_of_its_kinds_by_their_shares() {
    let job = "mission_hours = 1000\n\
               [[fleet.mission]]\nname = \"road\"\nshare = 0.75\ndays = [\"road*\"]\n\
               [[fleet.mission]]\nname = \"yard\"\nshare = 0.25\ndays = [\"yard1\"]\nvehicles = [\"T*\"]\n";
    let records = [
        ("T1_road1.csv", record(2.0, 20, keep_readings)),
        ("T1_road2.csv", record(2.0, 40, keep_readings)),
        ("T2_road1.csv", record(3.0, 30, keep_readings)),
        ("T2_yard1.csv", record(5.0, 25, keep_readings)),
        ("T2_other.csv", record(9.0, 20, keep_readings)),
    ];
    let dir = folder("mission", job, &records);
    let files = records.each_ref().map(|r| r.0);
    let (code, result) = fleet(&dir, &files, &[]);
    assert_eq!(code, 0, "{result}");
    let mission = &result["mission"];
    assert!(
        mission["statement"]
            .as_str()
            .unwrap()
            .contains("extrapolation")
    );
    assert_eq!(
        (&mission["kinds"][0]["files"], &mission["kinds"][1]["files"]),
        (&3.into(), &1.into())
    );
    let road = (damage(2.0, 60) + damage(3.0, 30)) / (hours(20) + hours(40) + hours(30));
    let yard = damage(5.0, 25) / hours(25);
    let load = &mission["loads"][0];
    is_close(
        number(&load["damage"]),
        1000.0 * (0.75 * road + 0.25 * yard),
    );
    is_close(number(&load["by_kind"][0]), road);
    is_close(number(&load["by_kind"][1]), yard);
    // Load B has two cycles per period, 0.7 times as large.
    let of_b = 2.0 * 0.7_f64.powi(SLOPE);
    is_close(
        number(&mission["loads"][1]["damage"]),
        of_b * number(&load["damage"]),
    );
    // The error of S is equal on all days. The relative uncertainty of the mission therefore equals that of one day.
    let own = &result["vehicles"][0]["loads"][0];
    let share = |v: &Value| number(&v["sigma_s"]) / number(&v["damage"]);
    is_close(share(load), share(own));
    assert!(number(&load["damage_low"]) < number(&load["damage"]));
    // With one day of yard, the scatter between such days is unknown.
    assert!(load["sigma_days"].is_null());
    assert!(dir.join("out/fleet_mission.csv").exists());
}

#[test]
fn days_that_are_not_there_and_shares_that_are_not_one_are_faults() {
    let records = [("T1_1.csv", record(4.0, 20, keep_readings))];
    let kind = |name: &str, share: f64, days: &str| {
        format!("[[fleet.mission]]\nname = \"{name}\"\nshare = {share}\ndays = [\"{days}\"]\n")
    };
    for (job, code, word) in [
        (
            "reference = { vehicle = \"T1\", day = \"2\" }\n".to_owned(),
            1,
            "fleet.reference",
        ),
        (
            kind("a", 0.5, "1") + &kind("b", 0.5, "2"),
            1,
            "fleet.mission",
        ),
        (
            kind("a", 0.5, "1") + &kind("b", 0.4, "2"),
            2,
            "shares sum to 0.9",
        ),
        (
            kind("a", 0.5, "1") + &kind("b", 0.5, "*"),
            2,
            "belongs to the kinds",
        ),
        (
            kind("a", 0.5, "1") + &kind("a", 0.5, "2"),
            2,
            "occurs twice",
        ),
        ("target = { \"C.FZ\" = 1.0 }\n".to_owned(), 2, "C.FZ"),
        ("target = { \"A.FZ\" = 0.0 }\n".to_owned(), 2, "above 0"),
    ] {
        let dir = folder("absent", &job, &records);
        let (got, said) = fleet(&dir, &["T1_1.csv"], &[]);
        assert_eq!(got, code, "{job}: {said}");
        assert!(said.to_string().contains(word), "{job}: {said}");
        if code == 1 {
            // The request covers the whole folder, so a missing record named in the job is a fault.
            assert_eq!(fleet(&dir, &[], &[]).0, 2, "{job}");
            // Another shard may contain the record.
            assert_eq!(
                fleet(&dir, &["T1_1.csv"], &["--shard", "1/2"]).0,
                0,
                "{job}"
            );
        }
    }
}

#[test]
fn extremes_have_their_time_and_every_day_its_record() {
    let spike = |at: usize, size: f64| {
        move |i: usize, y: &mut [f64; GAUGES]| {
            // Adds a wave of load A only, with a quarter of a period, which the loads explain.
            if (at..at + 10).contains(&i) {
                let more = size * (std::f64::consts::PI * (i - at) as f64 / 10.0).sin();
                y.iter_mut().zip(S).for_each(|(y, s)| *y += s[0] * more);
            }
        }
    };
    // Samples 415 and 395 to 405 are peaks of the wave anyway. The sum has its peak where the cosine is 1.
    let records = [
        ("T1_9.csv", record(4.0, PERIODS, spike(435, 6.0))),
        ("T1_10.csv", record(4.0, PERIODS, spike(455, -6.0))),
    ];
    let dir = folder("times", "", &records);
    let (code, result) = fleet(&dir, &["T1_9.csv", "T1_10.csv"], &[]);
    assert_eq!(code, 0, "{result}");
    let v = &result["vehicles"][0];
    let load = &v["loads"][0];
    for (end, path, day, seconds) in [
        // The peak is at sample 440, in the middle of the half wave. The valley is at sample 460.
        ("max_at", "T1_9.csv", "9", 4.4),
        ("min_at", "T1_10.csv", "10", 4.6),
    ] {
        let at = &load[end];
        assert_eq!((&at["path"], &at["day"]), (&path.into(), &day.into()));
        assert!((number(&at["seconds"]) - seconds).abs() < 1e-9, "{at}");
        let file = result["files"]
            .as_array()
            .unwrap()
            .iter()
            .find(|f| f["path"] == path);
        assert_eq!(file.unwrap()["sha256"], at["sha256"]);
    }
    assert!(
        (number(&load["max"]) - 10.0).abs() < 1e-4 && (number(&load["min"]) + 10.0).abs() < 1e-4
    );
    let page = std::fs::read_to_string(dir.join("out/report.html")).unwrap();
    assert!(!v["records"].as_array().unwrap().is_empty());
    for record in v["records"].as_array().unwrap() {
        let path = record["path"].as_str().unwrap();
        let sha256 = record["sha256"].as_str().unwrap();
        assert_eq!(sha256.len(), 64);
        assert!(page.contains(&format!("href=\"../{path}\"")), "{path}");
        assert!(page.contains(sha256), "{sha256}");
    }
    assert!(page.contains("9, 4.400 s"));
}

/// Samples of a record.
const SAMPLES: usize = PERIODS * PERIOD + 1;

/// Returns the `i`th of uniform random numbers between -1 and 1.
fn uniform_number(i: usize) -> f64 {
    Splitmix((i as u64).wrapping_mul(Splitmix::STEP)).next()
}

/// Returns subject and message of the findings with this code.
fn findings_by_code(result: &Value, code: &str) -> Vec<[String; 2]> {
    let list = result["findings"].as_array().unwrap();
    let of = list.iter().filter(|f| f["code"] == code);
    of.map(|f| ["subject", "message"].map(|k| f[k].as_str().unwrap().into()))
        .collect()
}

#[test]
fn a_zero_that_moves_over_the_days_and_exchanged_channels_are_named_with_their_days() {
    let names: Vec<(String, String)> = (1..=2)
        .flat_map(|v| (1..=12_u32).map(move |d| (v, d)))
        .map(|(v, d)| {
            // A correct gauge has noise too, equal in each run of the test.
            let text = record(4.0 + f64::from(d % 3), PERIODS, |i, y| {
                for (g, y) in y.iter_mut().enumerate() {
                    *y += 1.7 * uniform_number(((v * 100 + d) as usize * SAMPLES + i) * GAUGES + g);
                }
                match (v, d) {
                    (1, _) => y[2] += 1.5 * f64::from(d),
                    (_, 9..=10) => y.swap(0, 3),
                    _ => {}
                }
            });
            (format!("T{v}_{d}.csv"), text)
        })
        .collect();
    let records: Vec<(&str, String)> = names.iter().map(|n| (n.0.as_str(), n.1.clone())).collect();
    let dir = folder("health", "", &records);
    let job = std::fs::read_to_string(dir.join("job.toml")).unwrap();
    let job = job.replace("noise_microstrain = 0.001", "noise_microstrain = 1.0");
    std::fs::write(dir.join("job.toml"), job).unwrap();
    let files: Vec<&str> = records.iter().map(|r| r.0).collect();
    let (_, result) = fleet(&dir, &files, &[]);
    let drifts = findings_by_code(&result, "zero_drift");
    let [[subject, message]] = drifts.as_slice() else {
        panic!("{drifts:?}");
    };
    assert_eq!(subject, "T1 G2");
    // Eleven days at 1.5. S and noise give the mean of 75 samples an error of a few tenths.
    let moved = message.split_once("drifts by ").unwrap().1;
    let moved: f64 = moved.split(' ').next().unwrap().parse().unwrap();
    assert!((moved - 16.5).abs() < 1.0, "{message}");
    assert!(message.contains("from 1 to 12"), "{message}");
    let swaps = findings_by_code(&result, "inputs-exchanged");
    let [[subject, message]] = swaps.as_slice() else {
        panic!("{swaps:?}");
    };
    assert_eq!(subject, "T2 G0, G3");
    // The finding names the first record by date, not by name.
    assert!(
        message.contains("2 of 12 records, the first T2_9.csv"),
        "{message}"
    );
}

/// T1 has G0 and G3 exchanged from day 7 on. T2 has G1 with a gain of .7 from day 7 on.
#[test]
fn a_gain_that_changed_is_told_and_exchanged_gauges_have_one_name() {
    let names: Vec<(String, String)> = (1..=2)
        .flat_map(|v| (1..=12_u32).map(move |d| (v, d)))
        .map(|(v, d)| {
            // All records differ, because a copy does not count.
            let size = 4.0 + f64::from(d % 3) + 0.01 * f64::from(12 * v + d);
            let text = record(size, PERIODS, |_, y| match (v, d) {
                (1, 7..) => y.swap(0, 3),
                (2, 7..) => y[1] *= 0.7,
                _ => {}
            });
            (format!("T{v}_{d}.csv"), text)
        })
        .collect();
    let records: Vec<(&str, String)> = names.iter().map(|n| (n.0.as_str(), n.1.clone())).collect();
    let dir = folder("one_name", "", &records);
    let files: Vec<&str> = records.iter().map(|r| r.0).collect();
    let (_, result) = fleet(&dir, &files, &[]);
    let swaps = findings_by_code(&result, "inputs-exchanged");
    assert_eq!(swaps.len(), 1, "{swaps:?}");
    assert_eq!(swaps[0][0], "T1 G0, G3");
    let gains = findings_by_code(&result, "gauge_gain");
    assert!(gains.iter().all(|f| f[0].starts_with("T2")), "{gains:?}");
    let own = gains.iter().find(|f| f[0] == "T2 G1");
    let [_, message] = own.unwrap_or_else(|| panic!("{gains:?}"));
    assert!(
        message.contains("is 1.00 before 7 and 0.70 from that day on"),
        "{message}"
    );
}

/// Days with one load that rises to a value and does not return. Apart from half a cycle of each day, all cycles are
/// between days.
#[test]
fn what_closes_between_the_days_of_a_mission_is_bounded() {
    let job =
        "mission_hours = 10\n[[fleet.mission]]\nname = \"all\"\nshare = 1.0\nvehicles = [\"T1\"]\n";
    let records: Vec<(String, String)> = (1..=12)
        .map(|d| {
            // All records differ, because a copy does not count. The largest is the last.
            let size = 4.0 - 1e-4 * f64::from(12 - d);
            (format!("T1_{d}.csv"), record(size, 1, keep_readings))
        })
        .collect();
    let records: Vec<(&str, String)> = records.iter().map(|r| (&*r.0, r.1.clone())).collect();
    let dir = folder("between", job, &records);
    let files: Vec<&str> = records.iter().map(|r| r.0).collect();
    let (code, result) = fleet(&dir, &files, &[]);
    assert_eq!(code, 0, "{result}");
    let mission = &result["mission"];
    assert!(
        mission["statement"]
            .as_str()
            .unwrap()
            .contains("between days")
    );
    // The number of days in ten hours, each with half a cycle of the largest range.
    let days = 10.0 / hours(1);
    let at_most = number(&mission["loads"][0]["between_days_at_most"]);
    is_close(at_most, days * 0.5 * 8.0_f64.powi(SLOPE));
    // The damage of all days in sequence is at most their sum plus this bound.
    let load = &result["vehicles"][0]["loads"][0];
    let single: f64 = load["by_day"].as_array().unwrap().iter().map(number).sum();
    let bound = 12.0 * at_most / days;
    let joined = number(&load["damage_counted"]);
    assert!(
        joined <= 1.001 * (single + bound),
        "{joined} {single} {bound}"
    );
    let table = std::fs::read_to_string(dir.join("out/fleet_mission.csv")).unwrap();
    assert!(table.starts_with("load,hours,damage,damage_low,damage_high,between_days_at_most\n"));
}

/// Writes the list of `sha256sum` for the records of a result.
fn list_digests(dir: &Path, result: &Value) {
    let files = result["files"].as_array().unwrap();
    let line = |f: &Value| ["sha256", "path"].map(|k| f[k].as_str().unwrap().to_owned());
    let lines = files.iter().map(|f| line(f).join("  ") + "\n");
    std::fs::write(dir.join("digests.txt"), lines.collect::<String>()).unwrap();
}

#[test]
fn what_damage_is_held_against_is_changed_without_a_record() {
    let records = [
        ("T1_1.csv", record(4.0, PERIODS, keep_readings)),
        ("T1_2.csv", record(5.0, PERIODS, keep_readings)),
        ("T2_1.csv", record(6.0, PERIODS, keep_readings)),
    ];
    let dir = folder("changed", "", &records);
    let files = records.each_ref().map(|r| r.0);
    let (code, result) = fleet(&dir, &files, &[]);
    assert_eq!(code, 0, "{result}");
    list_digests(&dir, &result);
    let kinds = |share: f64, days: &str| {
        format!("[[fleet.mission]]\nname = \"{days}\"\nshare = {share}\ndays = [\"{days}\"]\n")
    };
    let mission =
        |a: f64| "mission_hours = 50\n".to_owned() + &kinds(a, "1") + &kinds(1.0 - a, "2");
    let tables = ["fleet.csv", "fleet_relative.csv", "fleet_mission.csv"];
    for (i, job) in [
        "reference = { vehicle = \"T1\", day = \"1\" }\n".to_owned(),
        "reference = { vehicle = \"T2\", day = \"1\" }\n".to_owned(),
        "target = { \"A.FZ\" = 1e6 }\n".to_owned(),
        mission(0.5),
        mission(0.25) + "# Of other commands.\n[respond]\nhottest = 3\n",
    ]
    .iter()
    .enumerate()
    {
        std::fs::write(dir.join("job.toml"), format!("title = \"{i}\"\n{JOB}{job}")).unwrap();
        let fresh = format!("fresh{i}");
        let (code, anew) = program::fleet(&dir, &fresh, &files, &[]);
        assert_eq!(code, 0, "{job}: {anew}");
        // The records are not available, only their stored results.
        let away = dir.join("away");
        std::fs::create_dir_all(&away).unwrap();
        for f in files {
            std::fs::rename(dir.join(f), away.join(f)).unwrap();
        }
        for (files, more) in [(&files[..], &["--digests", "digests.txt"][..]), (&[], &[])] {
            let (code, kept) = fleet(&dir, files, more);
            assert_eq!(code, 0, "{job}: {kept}");
            assert_eq!(kept["vehicles"], anew["vehicles"], "{job}");
            assert_eq!(kept["mission"], anew["mission"], "{job}");
            for table in tables {
                let [a, b] =
                    ["out", &fresh].map(|out| std::fs::read(dir.join(out).join(table)).ok());
                assert_eq!(a, b, "{job}: {table}");
            }
        }
        for f in files {
            std::fs::rename(away.join(f), dir.join(f)).unwrap();
        }
    }
    // A different slope needs another count of the record.
    std::fs::write(dir.join("job.toml"), format!("{JOB}[recover]\nslope = 4\n")).unwrap();
    assert_eq!(fleet(&dir, &[], &[]).0, 2);
}

#[test]
fn a_record_that_was_replaced_counts_as_it_is_now() {
    let names: Vec<String> = (1..=8).map(|v| format!("T{v}_1.csv")).collect();
    let files: Vec<&str> = names.iter().map(String::as_str).collect();
    let dir = folder("replaced", "", &[]);
    for amplitude in [4.0, 6.0] {
        // All records differ, because a copy of the bytes of another vehicle does not count.
        for (i, file) in (1..).zip(&files) {
            let text = record(amplitude + 0.01 * f64::from(i), PERIODS, keep_readings);
            std::fs::write(dir.join(file), text).unwrap();
        }
        for files in [&files[..], &[]] {
            let (code, result) = fleet(&dir, files, &[]);
            assert_eq!(code, 0, "{result}");
            assert_eq!(result["files"].as_array().unwrap().len(), 8, "{result}");
            let is_new = amplitude > 5.0 && !files.is_empty();
            let told = findings_by_code(&result, "fleet-record-replaced");
            assert_eq!(told.len(), usize::from(is_new), "{result}");
            for (i, v) in (1..).zip(result["vehicles"].as_array().unwrap()) {
                let expected = damage(amplitude + 0.01 * f64::from(i), PERIODS);
                is_close(number(&v["loads"][0]["damage"]), expected);
            }
        }
    }
}

#[test]
fn a_digest_of_another_state_of_the_record_is_not_taken() {
    let dir = folder("stale", "", &[("T1_1.csv", record(4.0, 30, keep_readings))]);
    let path = dir.join("T1_1.csv");
    let more = ["--digests", "digests.txt"];
    let (_, first) = fleet(&dir, &["T1_1.csv"], &[]);
    list_digests(&dir, &first);
    // A longer record.
    std::fs::write(&path, record(4.0, 40, keep_readings)).unwrap();
    let (code, second) = fleet(&dir, &["T1_1.csv"], &more);
    assert_eq!(code, 0, "{second}");
    assert_ne!(second["files"][0]["sha256"], first["files"][0]["sha256"]);
    is_close(
        number(&second["vehicles"][0]["loads"][0]["damage"]),
        damage(4.0, 40),
    );
    list_digests(&dir, &second);
    // A later record of equal length with two exchanged gauges.
    let text = record(4.0, 40, keep_readings);
    let other = text.replacen("G0 [um/m],G1 [um/m]", "G1 [um/m],G0 [um/m]", 1);
    assert!(other != text && other.len() == text.len());
    std::fs::write(&path, other).unwrap();
    let later = std::time::SystemTime::now() + std::time::Duration::from_secs(10);
    let file = std::fs::File::options().write(true).open(&path).unwrap();
    file.set_modified(later).unwrap();
    let (_, third) = fleet(&dir, &["T1_1.csv"], &more);
    assert_ne!(third["files"][0]["sha256"], second["files"][0]["sha256"]);
}

#[test]
fn shares_may_be_rounded_to_three_digits_and_no_further() {
    let dir = folder(
        "shares",
        "",
        &[("T1_1.csv", record(4.0, 20, keep_readings))],
    );
    for (share, n, is_refused) in [
        ("0.333", 3, false),
        ("0.167", 6, false),
        ("0.083", 12, false),
        ("0.33", 3, true),
        ("0.475", 2, true),
        // Each share is correct within rounding for a fortieth, but their sum is wrong by two per cent.
        ("0.0245", 40, true),
    ] {
        let kind = |i: usize| {
            format!("[[fleet.mission]]\nname = \"{i}\"\nshare = {share}\ndays = [\"{i}\"]\n")
        };
        let job = JOB.to_owned() + &(1..=n).map(kind).collect::<String>();
        std::fs::write(dir.join("job.toml"), job).unwrap();
        let (code, said) = fleet(&dir, &["T1_1.csv"], &[]);
        // The other kinds have no day.
        assert_eq!(code, if is_refused { 2 } else { 1 }, "{share}: {said}");
        let is_said = said.to_string().contains("shares sum");
        assert_eq!(is_said, is_refused, "{share}: {said}");
    }
}

#[test]
fn a_fault_of_a_kind_stands_at_its_line_whatever_is_wrong_with_those_before() {
    let nameless = "[[fleet.mission]]\nshare = 0.4\ndays = [\"3\"]\n";
    let kind = "[[fleet.mission]]\nname = \"a\"\nshare = 0.3\ndays = [\"1\"]\n";
    let dir = folder("lines", &format!("{nameless}{kind}{kind}"), &[]);
    let (code, said) = fleet(&dir, &["T1_1.csv"], &[]);
    assert_eq!(code, 2, "{said}");
    let faults = said["faults"].as_array().unwrap();
    let twice = |f: &&Value| f["wrong"].to_string().contains("occurs twice");
    let line = JOB.lines().count() + 3 + 4 + 1;
    assert_eq!(faults.iter().find(twice).unwrap()["line"], line, "{said}");
}

#[test]
fn what_failed_is_tried_again() {
    // Another build may support a format that this build lacks. A second run of the same build gives the same answer.
    let dir = folder(
        "failed",
        "",
        &[("T1_1.csv", "time,X\n0,1\n1,2\n".to_owned())],
    );
    for _ in 0..2 {
        let (code, result) = fleet(&dir, &["T1_1.csv"], &[]);
        assert_eq!(code, 1, "{result}");
        assert_eq!(result["files"][0]["status"], "failed", "{result}");
        let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
            .current_dir(&dir)
            .args(["fleet", "job.toml", "T1_1.csv", "--out", "out"])
            .output()
            .unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert!(
            said.contains("0 results stored by an earlier run"),
            "{said}"
        );
    }
}

#[test]
fn a_copy_under_the_name_of_another_vehicle_is_an_error() {
    let records = [
        ("A_3.csv", record(4.0, PERIODS, keep_readings)),
        ("Z_2.csv", record(5.0, PERIODS, keep_readings)),
        ("Z_3.csv", record(4.0, PERIODS, keep_readings)),
    ];
    let dir = folder("foreign", "", &records);
    let (code, result) = fleet(&dir, &records.each_ref().map(|r| r.0), &[]);
    assert_eq!(code, 1, "{result}");
    let of_another = findings_by_code(&result, "fleet-copy-of-another");
    let [[subject, message]] = of_another.as_slice() else {
        panic!("{of_another:?}");
    };
    assert_eq!(subject, "Z_3.csv");
    assert!(
        message.contains("A_3.csv, which is used for A: the record of Z is missing"),
        "{message}"
    );
}

#[test]
fn two_records_of_one_day_are_an_error_and_a_copy_is_not() {
    let records = [
        ("T1_1_am.csv", record(4.0, PERIODS, keep_readings)),
        ("T1_1_pm.csv", record(6.0, PERIODS, keep_readings)),
        ("T1_2_am.csv", record(5.0, PERIODS, keep_readings)),
        ("T1_2_pm.csv", record(5.0, PERIODS, keep_readings)),
    ];
    let dir = folder("twice", "", &records);
    let job = JOB.replace("{vehicle}_{day}", "{vehicle}_{day}_{any}");
    std::fs::write(dir.join("job.toml"), &job).unwrap();
    let files = records.each_ref().map(|r| r.0);
    let (code, result) = fleet(&dir, &files, &[]);
    assert_eq!(code, 1, "{result}");
    let subjects = |code| {
        findings_by_code(&result, code)
            .into_iter()
            .map(|f| f[0].clone())
    };
    assert!(subjects("fleet-day-twice").eq(["T1_1_pm.csv"]), "{result}");
    assert!(
        subjects("fleet-second-copy").eq(["T1_2_pm.csv"]),
        "{result}"
    );
    assert_eq!(fleet(&dir, &files[2..], &[]).0, 0);
    // If the records of a day have different names, both count.
    std::fs::write(dir.join("job.toml"), JOB).unwrap();
    let (code, result) = fleet(&dir, &files[..2], &[]);
    assert_eq!((code, &result["vehicles"][0]["files"]), (0, &2.into()));
}
