//! Days that differ: their order by date, other units, other rates, a vehicle at standstill.

use super::command::{GAUGES, S, findings_of, fleet, folder, table_of};
use super::drawn::Splitmix;
use super::program::JOB;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Writes the job of these tests with the noise of its records.
fn write_noisy_job(name: &str) -> PathBuf {
    let (dir, _) = folder(name);
    let job = JOB.replace("noise_microstrain = 0.001", "noise_microstrain = 1.0");
    std::fs::write(dir.join("job.toml"), job).unwrap();
    dir
}

/// Returns a random number of mean 0 and standard deviation 1: half of the sum of twelve uniform numbers.
fn draw_normal(numbers: &mut Splitmix) -> f64 {
    (0..12).map(|_| 0.5 * numbers.next()).sum()
}

/// Returns the table of a day with noise of 1 microstrain in each reading, changed by `change`.
fn table(day: usize, mut change: impl FnMut(usize, &mut [f64; GAUGES])) -> String {
    let mut numbers = Splitmix(900 + day as u64);
    table_of(1, day, None, |i, y| {
        for v in y.iter_mut() {
            *v += draw_normal(&mut numbers);
        }
        change(i, y);
    })
}

fn write(dir: &Path, name: &str, text: &str) -> String {
    std::fs::write(dir.join(name), text).unwrap();
    name.to_owned()
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("{v}"))
}

fn damages(result: &Value) -> Vec<f64> {
    let loads = result["vehicles"][0]["loads"].as_array().unwrap();
    loads.iter().map(|l| number(&l["damage"])).collect()
}

#[test]
fn days_named_by_day_month_and_year_are_counted_in_the_order_of_the_calendar() {
    let dir = write_noisy_job("calendar");
    let days = [
        "2025-11-30",
        "2025-12-01",
        "2025-12-31",
        "2026-01-02",
        "2026-02-01",
    ];
    let named = [
        "30.11.2025",
        "1.12.2025",
        "31.12.2025",
        "02.01.2026",
        "1.2.2026",
    ];
    let mut files = [Vec::new(), Vec::new()];
    for (i, (iso, name)) in days.iter().zip(named).enumerate() {
        let text = table(i + 1, |_, _| ());
        files[0].push(write(&dir, &format!("A_{iso}.csv"), &text));
        files[1].push(write(&dir, &format!("A_{name}.csv"), &text));
    }
    let (code, right) = fleet(&dir, "iso", &files[0], &[]);
    assert_eq!(code, 0, "{right}");
    let (code, result) = fleet(&dir, "named", &files[1], &[]);
    assert_eq!(code, 0, "{result}");
    let vehicle = &result["vehicles"][0];
    assert_eq!(vehicle["days"], Value::from(named.to_vec()));
    // Cycles that close between days depend on this order.
    assert_eq!(damages(&result), damages(&right));
    for (a, b) in ["cycles", "damage_counted"].iter().map(|k| {
        let of = |r: &Value| r["vehicles"][0]["loads"][0][*k].clone();
        (of(&result), of(&right))
    }) {
        assert_eq!(a, b);
    }
    // The date is ambiguous, with day or month first. The program reads nothing and writes nothing.
    let text = table(1, |_, _| ());
    let two = ["B_05-06-2026.csv", "B_06-05-2026.csv"].map(|n| write(&dir, n, &text));
    let (code, said) = fleet(&dir, "unknown", &two, &[]);
    assert_eq!(code, 2, "{said}");
    assert!(said.to_string().contains("05-06-2026"), "{said}");
    assert!(!dir.join("unknown").join("days").exists());
}

#[test]
fn a_day_in_another_unit_is_read_in_it_where_it_says_so_and_is_an_error_where_not() {
    let dir = write_noisy_job("unit");
    let mut files = Vec::new();
    for day in 1..=4 {
        files.push(write(&dir, &format!("A_{day}.csv"), &table(day, |_, _| ())));
    }
    let (code, right) = fleet(&dir, "right", &files, &[]);
    assert_eq!(code, 0, "{right}");
    let thousandth = |_: usize, y: &mut [f64; GAUGES]| y.iter_mut().for_each(|v| *v *= 1e-3);
    let stated = table(3, thousandth).replace("[um/m]", "[mm/m]");
    write(&dir, "A_3.csv", &stated);
    let (code, result) = fleet(&dir, "stated", &files, &[]);
    assert_eq!(code, 0, "{result}");
    // Six decimals of mm/m resolve a thousandth of a microstrain.
    for (a, b) in damages(&result).iter().zip(damages(&right)) {
        assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
    }
    for (factor, words) in [(1e-3, " times smaller"), (1e3, " times larger")] {
        let unstated = table(3, |_, y| y.iter_mut().for_each(|v| *v *= factor));
        write(&dir, "A_3.csv", &unstated.replace(" [um/m]", ""));
        let (code, result) = fleet(&dir, "unstated", &files, &[]);
        assert_eq!(code, 1, "{result}");
        let found = findings_of(&result, &["error"]);
        let of_unit: Vec<_> = found.iter().filter(|f| f[0] == "fleet-day-unit").collect();
        let [[_, subject, message]] = of_unit.as_slice() else {
            panic!("{found:?}");
        };
        assert_eq!(subject, "A");
        assert!(message.contains("(3)"), "{message}");
        let times = message
            .split_once(words)
            .and_then(|(before, _)| before.rsplit(' ').next()?.parse::<f64>().ok());
        // Loads differ between days. The factor is nearer to a thousand than to a hundred or ten thousand.
        assert!(
            times.is_some_and(|t| (316.0..3162.0).contains(&t)),
            "{message}"
        );
    }
}

/// Returns a day of slow loads of this size, forty seconds, with noise of 1 microstrain in each reading, changed by
/// `change`.
fn slow_day_text(day: usize, size: f64, mut change: impl FnMut(&mut [f64; GAUGES])) -> String {
    let mut numbers = Splitmix(300 + day as u64);
    let mut text = String::from("time");
    (0..GAUGES).for_each(|g| write!(text, ",G{g} [um/m]").unwrap());
    for i in 0..4_000 {
        let t = f64::from(i) * 0.01;
        let f = [(0.2 * t + day as f64).sin(), (0.31 * t).cos()].map(|f| size * f);
        let mut y = S.map(|row| row[0] * f[0] + row[1] * f[1] + draw_normal(&mut numbers));
        change(&mut y);
        write!(text, "\n{t:.2}").unwrap();
        y.iter().for_each(|v| write!(text, ",{v:.6}").unwrap());
    }
    text
}

#[test]
fn a_day_whose_readings_are_all_half_or_twice_as_large_is_told_and_a_rougher_day_is_not() {
    let dir = write_noisy_job("scale");
    let as_it_is = |_: &mut [f64; GAUGES]| ();
    let files: Vec<String> = (1..=5)
        .map(|day| {
            write(
                &dir,
                &format!("A_{day}.csv"),
                &slow_day_text(day, 50.0, as_it_is),
            )
        })
        .collect();
    let told = |third: &str| -> Vec<String> {
        write(&dir, "A_3.csv", third);
        let (_, result) = fleet(&dir, "out", &files, &[]);
        let found = findings_of(&result, &["warning"]).into_iter();
        let found = found.filter(|f| f[0] == "fleet-day-scale");
        found.map(|f| f[2].clone()).collect()
    };
    assert!(told(&slow_day_text(3, 50.0, as_it_is)).is_empty());
    for factor in [0.5, 1.3, 2.0] {
        let found = told(&slow_day_text(3, 50.0, |y| {
            y.iter_mut().for_each(|v| *v *= factor)
        }));
        let [message] = found.as_slice() else {
            panic!("{factor}: {found:?}");
        };
        let before = message.split(" on 3. ").next().unwrap();
        let said: f64 = before.rsplit(' ').next().unwrap().parse().unwrap();
        // Second differences of 4,000 readings determine the noise within 1.5 %, and the median of five gauges within
        // half of it. The limit is three sigma.
        assert!((said / factor - 1.0).abs() < 0.03, "{message}");
    }
    // No finding about noise for three changes. A thousandth is reported as another unit. The second day has twice the
    // loads with normal noise. On the third day, only half of the gauges have more noise.
    let unit = slow_day_text(3, 50.0, |y| y.iter_mut().for_each(|v| *v *= 1e-3));
    assert!(told(&unit).is_empty());
    assert!(told(&slow_day_text(3, 100.0, as_it_is)).is_empty());
    let half = slow_day_text(3, 50.0, |y| y.iter_mut().step_by(2).for_each(|v| *v *= 2.0));
    assert!(told(&half).is_empty());
}

#[test]
fn a_day_that_the_vehicle_stands_names_no_gauge() {
    let dir = write_noisy_job("standing");
    let mut files = Vec::new();
    for day in 1..=5 {
        let mut numbers = Splitmix(day);
        // On day 3 the vehicle is at standstill. The readings are noise, and one gauge with a coarse resolution reads a
        // constant integer.
        let text = match day {
            3 => table(3, |_, y| {
                for v in y.iter_mut() {
                    *v = 0.3 * draw_normal(&mut numbers);
                }
                y[2] = 0.0;
            }),
            _ => table(day as usize, |_, _| ()),
        };
        files.push(write(&dir, &format!("A_{day}.csv"), &text));
    }
    let (_, result) = fleet(&dir, "out", &files, &[]);
    let found = findings_of(&result, &["warning", "error"]);
    let named = ["gauge-silent", "gauge_gain", "fleet-day-unit", "zero_drift"];
    assert!(
        found.iter().all(|f| !named.contains(&f[0].as_str())),
        "{found:?}"
    );
    // A gauge with a number that the others contradict is dead, even at standstill.
    let mut numbers = Splitmix(3);
    let contradicted = table(3, |_, y| {
        for v in y.iter_mut() {
            *v = 0.3 * draw_normal(&mut numbers);
        }
        y[2] = 40.0;
    });
    write(&dir, &files[2], &contradicted);
    let (_, result) = fleet(&dir, "contradicted", &files, &[]);
    let found = findings_of(&result, &["warning"]);
    let dead = found.iter().find(|f| f[0] == "gauge-silent");
    assert_eq!(dead.unwrap_or_else(|| panic!("{found:?}"))[1], "A G2");
    // A gauge that is dead on a day of driving is reported. The finding includes the day at standstill.
    for (day, file) in files.iter().enumerate() {
        if day >= 3 {
            let text = table(day + 1, |_, y| y[2] = 4.0);
            write(&dir, file, &text);
        }
    }
    let (_, result) = fleet(&dir, "dead", &files, &[]);
    let found = findings_of(&result, &["warning"]);
    let dead: Vec<_> = found.iter().filter(|f| f[0] == "gauge-silent").collect();
    let [[_, subject, message]] = dead.as_slice() else {
        panic!("{found:?}");
    };
    assert_eq!(subject, "A G2");
    assert!(message.contains("on 3 of 5 days, the first 3"), "{message}");
}

/// Two days of different size, and the same samples as one record.
#[test]
fn days_and_the_undivided_record_give_the_same_damage_with_model_uncertainty() {
    let dir = write_noisy_job("undivided");
    // The loads, and with them the model error, are three times as large on the second day.
    let day = |day: usize, size: f64| table(day, |_, y| y.iter_mut().for_each(|v| *v *= size));
    let days = [day(1, 1.0), day(2, 3.0)];
    let mut files = vec![write(&dir, "A_1.csv", &days[0])];
    files.push(write(&dir, "A_2.csv", &days[1]));
    let rows = days.iter().flat_map(|text| text.lines().skip(1));
    let mut whole = days[0].lines().next().unwrap().to_owned();
    for (i, row) in rows.enumerate() {
        let (_, readings) = row.split_once(',').unwrap();
        write!(whole, "\n{:.2},{readings}", i as f64 * 0.01).unwrap();
    }
    let whole = [write(&dir, "A_9.csv", &(whole + "\n"))];
    let [(_, days), (_, whole)] = [("days", &files[..]), ("whole", &whole[..])]
        .map(|(out, files)| fleet(&dir, out, files, &[]));
    for load in 0..2 {
        for key in [
            "damage_counted",
            "noise_bias",
            "damage",
            "cycles",
            "max",
            "min",
        ] {
            let [a, b] = [&days, &whole].map(|r| number(&r["vehicles"][0]["loads"][load][key]));
            assert!((a - b).abs() <= 1e-9 * b.abs(), "{load} {key}: {a} {b}");
        }
    }
}

/// With two days, neither is typical. The other gauges show which one is wrong.
#[test]
fn of_two_days_the_spiked_one_is_named() {
    let dir = write_noisy_job("two_days");
    for spiked in [1, 2] {
        let files: Vec<String> = (1..=2)
            .map(|day| {
                let text = table(day, |i, y| {
                    if day == spiked && i % 25 == 7 {
                        y[2] = 1e9;
                    }
                });
                write(&dir, &format!("A_{day}.csv"), &text)
            })
            .collect();
        let (code, result) = fleet(&dir, &format!("spiked_{spiked}"), &files, &[]);
        assert_eq!(code, 1, "{result}");
        let found = findings_of(&result, &["warning", "error"]);
        assert!(found.iter().all(|f| f[0] != "gauge-silent"), "{found:?}");
        let [names, right] = [spiked, 3 - spiked].map(|day| format!("A_{day}.csv"));
        assert!(found.iter().any(|f| f[2].contains(&names)), "{found:?}");
        assert!(found.iter().all(|f| !f[2].contains(&right)), "{found:?}");
    }
}

#[test]
fn days_of_other_rates_and_with_a_renamed_gauge_are_counted_alike() {
    let dir = write_noisy_job("rates");
    let mut files = Vec::new();
    for day in 1..=4 {
        files.push(write(&dir, &format!("A_{day}.csv"), &table(day, |_, _| ())));
    }
    let (_, right) = fleet(&dir, "right", &files, &[]);
    let hours = number(&right["vehicles"][0]["hours"]);
    // The same samples at half the speed.
    let slow: String = table(2, |_, _| ())
        .lines()
        .map(|line| match line.split_once(',') {
            Some((t, rest)) if t != "time" => {
                format!("{:.2},{rest}\n", 2.0 * t.parse::<f64>().unwrap())
            }
            _ => format!("{line}\n"),
        })
        .collect();
    write(&dir, "A_2.csv", &slow);
    let (code, result) = fleet(&dir, "slow", &files, &[]);
    assert_eq!(code, 0, "{result}");
    assert_eq!(damages(&result), damages(&right));
    assert!((number(&result["vehicles"][0]["hours"]) / hours - 1.25).abs() < 1e-9);
    // A gauge with another name is reported as missing. The other gauges determine the loads, here within their noise.
    let renamed = table(3, |_, _| ()).replace("G4 [um/m]", "SG4 [um/m]");
    write(&dir, "A_3.csv", &renamed);
    let (code, result) = fleet(&dir, "renamed", &files, &[]);
    assert_eq!(code, 0, "{result}");
    let found = findings_of(&result, &["warning"]);
    for (code, subject) in [
        ("gauge-without-strain", "G4"),
        ("strain-without-gauge", "SG4"),
    ] {
        assert!(
            found.iter().any(|f| f[0] == code && f[1].contains(subject)),
            "{code}: {found:?}"
        );
    }
    for ((a, b), l) in damages(&result).iter().zip(damages(&right)).zip(0..) {
        let load = &result["vehicles"][0]["loads"][l];
        let sigma = number(&load["sigma_noise"]).hypot(number(&load["sigma_bias"]));
        assert!((a - b).abs() < 4.0 * sigma, "{a} {b} {sigma}");
    }
}
