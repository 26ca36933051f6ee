//! Gauges and days that are partly wrong: excluded samples, sums with a warning, and the reported gauge.

use super::command::{GAUGES, S, SAMPLES, findings_of, fleet, folder, table_of};
use super::program::{JOB, scratch};
use serde_json::Value;
use std::path::Path;

fn write(dir: &Path, name: &str, text: String) {
    std::fs::write(dir.join(name), text).unwrap();
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("{v}"))
}

/// Returns the damage of both loads of a vehicle, and its sigma from the error of S.
fn loads(result: &Value, vehicle: usize) -> [[f64; 2]; 2] {
    let of = |l: usize| {
        let load = &result["vehicles"][vehicle]["loads"][l];
        ["damage", "sigma_s"].map(|k| number(&load[k]))
    };
    [of(0), of(1)]
}

#[test]
fn a_gauge_that_dies_within_a_day_is_left_out_from_there_on() {
    let (dir, files) = folder("dies");
    let (code, whole) = fleet(&dir, "before", &files, &[]);
    assert_eq!(code, 0, "{whole}");
    let before = loads(&whole, 1);
    // From sample 500 on, the gauge gives zero, another value, or nothing. In the last case it recovers and is valid
    // again.
    for (out, value, to) in [
        ("zero", 0.0, SAMPLES),
        ("other", -42.0, SAMPLES),
        ("nothing", f64::NAN, SAMPLES),
        ("back", 13.0, 1100),
    ] {
        for day in 1..=20 {
            let text = table_of(1, day, None, |i, y| {
                if (500..to).contains(&i) {
                    y[0] = value;
                }
            });
            write(&dir, &format!("T1_{day}.csv"), text);
        }
        let (code, result) = fleet(&dir, out, &files, &[]);
        assert_eq!(code, 0, "{out}: {result}");
        let after = loads(&result, 1);
        for ([a, _], [b, _]) in before.iter().zip(&after) {
            assert!((a / b - 1.0).abs() < 1e-3, "{out}: {a} {b}");
        }
        // This gauge has the largest readings of load A, so the other gauges determine that load less accurately.
        let [a, b] = [before, after].map(|l| l[0][1]);
        assert!(b > 1.01 * a, "{out}: {a} {b}");
        assert_eq!(
            result["vehicles"][1]["hours"],
            whole["vehicles"][1]["hours"]
        );
        let gauge = &result["vehicles"][1]["gauges"][0];
        assert_eq!(gauge["dead_days"].as_array().unwrap().len(), 20);
        let part = &gauge["dead_parts"][0];
        assert_eq!(part["day"], "1");
        for (key, sample) in [("from", 500), ("to", to)] {
            let hours = sample as f64 / 100.0 / 3600.0;
            assert!(
                (number(&part[key]) / hours - 1.0).abs() < 1e-6,
                "{out}: {part}"
            );
        }
        let found = findings_of(&result, &["warning", "error"]);
        let dead = found.iter().find(|f| f[0] == "gauge-silent");
        let [_, subject, message] = dead.unwrap_or_else(|| panic!("{found:?}"));
        assert_eq!(subject, "T1 G0");
        assert!(
            message.contains("on 20 of 20 days, the first 1 from hour"),
            "{message}"
        );
        let page = std::fs::read_to_string(dir.join(out).join("report.html")).unwrap();
        assert!(page.contains("1 from hour 0.001"), "{out}");
    }
}

#[test]
fn a_vehicle_that_stands_for_half_a_day_has_no_dead_gauge() {
    let (dir, files) = folder("stands");
    let mut last = [0.0; GAUGES];
    let text = table_of(1, 4, None, |i, y| {
        if i >= 500 {
            *y = last.map(f64::round);
        } else {
            last = *y;
        }
    });
    write(&dir, "T1_4.csv", text);
    let (_, result) = fleet(&dir, "out", &files, &[]);
    let found = findings_of(&result, &["warning", "error"]);
    assert!(found.iter().all(|f| f[0] != "gauge-silent"), "{found:?}");
}

/// The first test of the gauges uses only the first second of a record.
#[test]
fn who_stands_at_first_and_a_gauge_that_wakes_late_are_at_work_afterwards() {
    let (dir, files) = folder("wakes");
    let (_, whole) = fleet(&dir, "before", &files, &[]);
    let standing = S.map(|row| row[0] * 3.0 - row[1] * 2.0);
    let stands = table_of(1, 4, None, |i, y| {
        if i < 600 {
            *y = standing;
        }
    });
    write(&dir, "T1_4.csv", stands);
    let wakes = table_of(2, 4, None, |i, y| y[0] = if i < 600 { 5.0 } else { y[0] });
    write(&dir, "T2_4.csv", wakes);
    let (code, result) = fleet(&dir, "out", &files, &[]);
    assert_eq!(code, 0, "{result}");
    let found = findings_of(&result, &["warning", "error"]);
    assert!(
        found
            .iter()
            .all(|f| f[1].starts_with("T2 ") || f[0] == "samples-with-gaps"),
        "{found:?}"
    );
    let parts = &result["vehicles"][2]["gauges"][0]["dead_parts"];
    assert_eq!(parts.as_array().unwrap().len(), 1, "{parts}");
    assert_eq!(number(&parts[0]["from"]), 0.0);
    assert!(
        (number(&parts[0]["to"]) - 6.0 / 3600.0).abs() < 1e-9,
        "{parts}"
    );
    for ([a, _], [b, _]) in loads(&whole, 2).iter().zip(loads(&result, 2)) {
        assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
    }
}

#[test]
fn damage_of_days_that_the_loads_do_not_explain_is_told_with_its_share() {
    let (dir, files) = folder("doubt");
    write(&dir, "T1_9.csv", table_of(1, 9, None, |_, y| y[2] = -y[2]));
    let (code, result) = fleet(&dir, "out", &files, &[]);
    assert_eq!(code, 1, "{result}");
    let vehicle = &result["vehicles"][1];
    assert_eq!(vehicle["doubtful_days"], serde_json::json!(["9"]));
    assert_eq!(
        result["vehicles"][0]["doubtful_days"],
        serde_json::json!([])
    );
    let found = findings_of(&result, &["error"]);
    let told = found.iter().find(|f| f[0] == "damage-in-doubt").unwrap();
    assert_eq!(told[1], "T1");
    let others: Vec<String> = files.iter().filter(|f| *f != "T1_9.csv").cloned().collect();
    let (_, without) = fleet(&dir, "without", &others, &[]);
    for l in 0..2 {
        let load = &vehicle["loads"][l];
        let damage = |r: &Value| number(&r["vehicles"][1]["loads"][l]["damage"]);
        let share = 1.0 - damage(&without) / damage(&result);
        assert!(share > 1e-6, "{share}");
        assert!((number(&load["doubtful_share"]) - share).abs() < 1e-9);
        let words = format!("{} {:.1} %", load["load"].as_str().unwrap(), 100.0 * share);
        assert!(told[2].contains(&words), "{words}: {}", told[2]);
    }
}

/// Only one gauge reads the second load, and it dies in the middle.
#[test]
fn a_load_that_is_known_in_a_part_of_the_hours_has_the_damage_of_that_part() {
    let dir = scratch("part");
    std::fs::write(dir.join("job.toml"), JOB).unwrap();
    write(
        &dir,
        "S.csv",
        "gauge,A.FZ,B.FZ\nG0,10,0\nG1,-8,0\nG2,5,0\nG3,0,7\n".into(),
    );
    let record = |dead: &str| {
        let mut text = "time,G0,G1,G2,G3\n".to_owned();
        for i in 0..1200 {
            let turn = std::f64::consts::TAU * f64::from(i) / 40.0;
            let (a, b) = (5.0 * turn.cos(), 4.0 * turn.sin());
            let last = match i >= 600 {
                true => dead.to_owned(),
                false => format!("{:.6}", 7.0 * b),
            };
            let time = f64::from(i) * 0.01;
            let [x, y, z] = [10.0, -8.0, 5.0].map(|s| s * a);
            text += &format!("{time:.2},{x:.6},{y:.6},{z:.6},{last}\n");
        }
        text
    };
    let file = ["T1_1.csv".to_owned()];
    let mut all = Vec::new();
    for (out, dead) in [("nothing", ""), ("stuck", "12.5")] {
        write(&dir, "T1_1.csv", record(dead));
        let (code, result) = fleet(&dir, out, &file, &[]);
        assert_eq!(code, 0, "{result}");
        let load = |l: usize| &result["vehicles"][0]["loads"][l];
        let whole = number(&result["vehicles"][0]["hours"]);
        assert_eq!(number(&load(0)["hours"]), whole);
        assert!((number(&load(1)["hours"]) / whole - 0.5).abs() < 1e-9);
        // Fifteen periods with a range of 8 kN.
        let damage = number(&load(1)["damage"]);
        assert!(
            (damage / (15.0 * 8.0_f64.powi(5)) - 1.0).abs() < 0.05,
            "{damage}"
        );
        // A single vehicle equals the mean of all vehicles, for each load by its hours.
        for l in 0..2 {
            assert!((number(&load(l)["relative"]) - 1.0).abs() < 1e-9);
            assert!(number(&load(l)["damage_low"]) < number(&load(l)["damage_high"]));
        }
        let found = findings_of(&result, &["warning"]);
        let part = found.iter().find(|f| f[0] == "load-known-in-part");
        assert_eq!(part.unwrap_or_else(|| panic!("{found:?}"))[1], "T1 B.FZ");
        let dead = found.iter().find(|f| f[0] == "gauge-silent");
        assert_eq!(dead.unwrap_or_else(|| panic!("{found:?}"))[1], "T1 G3");
        all.push(damage);
    }
    assert_eq!(all[0], all[1]);
}

#[test]
fn a_gauge_that_is_missing_is_told_with_its_vehicles() {
    let (dir, files) = folder("missing");
    let missing = |result: &Value| {
        let found = findings_of(result, &["warning"]);
        let [[_, subject, message]] = found
            .iter()
            .filter(|f| f[0] == "gauge-without-strain")
            .collect::<Vec<_>>()[..]
        else {
            panic!("{found:?}");
        };
        (subject.clone(), message.clone())
    };
    write(&dir, "T1_5.csv", table_of(1, 5, Some(4), |_, _| ()));
    let (_, result) = fleet(&dir, "one", &files, &[]);
    let (subject, message) = missing(&result);
    assert_eq!(subject, "T1 G4");
    assert!(
        message.starts_with("1 of 20 records, the first T1_5.csv"),
        "{message}"
    );
    write(&dir, "T2_7.csv", table_of(2, 7, Some(4), |_, _| ()));
    let (_, result) = fleet(&dir, "two", &files, &[]);
    let (subject, message) = missing(&result);
    assert_eq!(subject, "G4");
    assert!(
        message.starts_with("2 of 60 records (T1, T2), the first T1_5.csv"),
        "{message}"
    );
}
