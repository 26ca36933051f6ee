//! `[compare]`, load columns of `[runs]` and `[[section]]`: compares recovered with recorded loads, and computes damage
//! by section.

use super::{S, as_is, codes, recover as by_command, strain, table};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write;
use strainbridge::host::context::InMemory;
use strainbridge::host::fault::Faults;
use strainbridge::{Context, Job, recover};

/// Stated noise of a reading, microstrain.
const NOISE: f64 = 0.3;
/// Sample rate of the strain record in Hz, and time of its first sample in s.
const RATE: f64 = 100.0;
const START: f64 = 5.0;

/// Returns the loads at a time of the clock of the strain record. They are sums of sines whose periods have no common
/// multiple.
fn loads_at(t: f64) -> [f64; 2] {
    let sum = |frequencies: [f64; 3]| -> f64 {
        let sines = frequencies.iter().zip([100.0, 70.0, 40.0]);
        sines.map(|(f, a)| a * (TAU * f * t).sin()).sum()
    };
    [300.0 + sum([0.31, 1.13, 2.71]), sum([0.47, 1.61, 2.23])]
}

/// Returns a strain record with `n` samples of these loads. `error` is added to each reading.
fn record(
    n: usize,
    start: f64,
    loads: impl Fn(f64) -> [f64; 2],
    mut error: impl FnMut() -> f64,
) -> String {
    let mut text = "time,G1,G2,G3,G4\n".to_owned();
    for i in 0..n {
        let t = start + i as f64 / RATE;
        let [a, b] = loads(t);
        let _ = write!(text, "{t:.4}");
        for v in strain(a, b) {
            let _ = write!(text, ",{:.9}", v + error());
        }
        text.push('\n');
    }
    text
}

fn files(strain: String, more: &str) -> InMemory {
    let mut s = "gauge,A.FZ,B.FZ\n".to_owned();
    for (g, row) in S.iter().enumerate() {
        let _ = writeln!(s, "G{},{},{}", g + 1, row[0], row[1]);
    }
    let job = format!(
        "units = \"m-kg-s\"\n[sensitivity]\nfile = \"S.csv\"\n\
         [measured]\nstrain = \"strain.csv\"\nnoise_microstrain = {NOISE}\n{more}"
    );
    InMemory::default()
        .with_file("job.toml", job)
        .with_file("S.csv", s)
        .with_file("strain.csv", strain)
}

/// Returns the answer of a job, as in `result.json`, and its findings.
fn answer(files: &InMemory) -> Result<(Value, Vec<(String, String)>), Faults> {
    let job = Job::read("job.toml", files)?;
    let outcome = recover(&job, &Context::new(files))?;
    let findings = outcome.findings.iter();
    let findings = findings.map(|f| (f.code.to_owned(), f.subject.clone()));
    let findings = findings.collect();
    Ok((serde_json::to_value(&outcome.answer).unwrap(), findings))
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or(f64::NAN)
}

fn of_load<'a>(answer: &'a Value, key: &str, load: &str) -> &'a Value {
    let list = answer[key].as_array().unwrap();
    list.iter().find(|c| c["load"] == load).unwrap()
}

/// Returns a generator of normal random numbers. Each one is a sum of twelve uniform numbers.
fn normal_numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut even = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    move || (0..12).map(|_| even()).sum::<f64>() - 6.0
}

/// Returns a table of loads recorded at 128 Hz. Its clock is `shift` behind that of the strain record. Load A has the
/// mean error `off`.
fn format_load_record(shift: f64, off: f64, seconds: f64) -> String {
    let mut text = "time [s],A.FZ [kN],Kraft B\n".to_owned();
    for i in 0..(seconds * 128.0) as usize {
        let t = i as f64 / 128.0;
        let [a, b] = loads_at(t + shift);
        let _ = writeln!(text, "{t:.7},{:.9},{:.6}", (a + off) / 1000.0, b);
    }
    text
}

#[test]
fn a_shift_of_a_fraction_of_a_sample_and_an_offset_are_found_in_a_record() {
    let more = "[compare]\nfile = \"wft.csv\"\ncolumns = { \"B.FZ\" = \"Kraft B\" }\n";
    // The shift is 234.56 samples of the strain record.
    let shift = START + 2.3456;
    let strain = record(6000, START, loads_at, || 0.0);
    let wft = format_load_record(shift, 2.0, 40.0);
    let (found, findings) =
        answer(&files(strain.clone(), more).with_file("wft.csv", wft.clone())).unwrap();
    let estimated = &found["comparison_shift"];
    // The cubic between samples has the relative error 3/128 (2 pi f / rate)^4. At 128 Hz that is 4e-4 of the fastest
    // sine, or 1e-5 s for its slope.
    assert!(
        (number(&estimated["shift_s"]) - shift).abs() < 2e-5,
        "{estimated}"
    );
    assert!(number(&estimated["half_width_s"]) < 1e-4, "{estimated}");
    let a = of_load(&found, "comparison", "A.FZ");
    let b = of_load(&found, "comparison", "B.FZ");
    // The compared samples start at 2.3456 s. They end with the recorded samples, 40 s less one sample later.
    let n = (234.56_f64 + (40.0 * 128.0 - 1.0) / 128.0 * RATE).floor() - 234.0;
    assert_eq!((number(&a["n"]), number(&b["n"])), (n, n));
    assert_eq!(a["unit"], "N");
    for (v, expected) in [(&a["bias"], -2.0), (&a["rms"], 2.0), (&b["bias"], 0.0)] {
        assert!((number(v) - expected).abs() < 5e-3, "{a} {b}");
    }
    // By hand, sigma is .2 N for load B. It is .23 N for load A: .3 microstrain over the norm of its column without the
    // part along B. The offset of 2 N is therefore outside the interval.
    assert_eq!(
        (number(&a["share_within"]), number(&b["share_within"])),
        (0.0, 1.0)
    );
    let outside: Vec<_> = findings
        .iter()
        .filter(|f| f.0 == "recorded-loads-outside-intervals")
        .collect();
    assert_eq!(outside.len(), 1);
    assert_eq!(outside[0].1, "load `A.FZ`");
    // An offset changes no range of a cycle. Both records miss the peaks between samples, and their damage differs only
    // to second order.
    for load in [a, b] {
        assert!((number(&load["damage_ratio"]) - 1.0).abs() < 0.01, "{load}");
        let [low, high] = ["damage_ratio_low", "damage_ratio_high"].map(|k| number(&load[k]));
        assert!(low < 1.0 && high > 1.0, "{load}");
    }
    // The program uses a stated shift without an estimate.
    let stated = format!("{more}shift_s = {shift}\n");
    let (as_stated, _) = answer(&files(strain, &stated).with_file("wft.csv", wft)).unwrap();
    assert_eq!(as_stated["comparison_shift"]["shift_s"], shift);
    assert!(as_stated["comparison_shift"]["half_width_s"].is_null());
    let a = of_load(&as_stated, "comparison", "A.FZ");
    assert!((number(&a["rms"]) - 2.0).abs() < 5e-3, "{a}");
}

#[test]
fn noise_as_stated_leaves_19_of_20_samples_inside_the_interval() {
    let more =
        "[compare]\nfile = \"wft.csv\"\ncolumns = { \"B.FZ\" = \"Kraft B\" }\nshift_s = 5.0\n";
    let mut noise = normal_numbers(7);
    let strain = record(5000, START, loads_at, || NOISE * noise());
    let wft = format_load_record(START, 0.0, 60.0);
    let (found, findings) = answer(&files(strain, more).with_file("wft.csv", wft)).unwrap();
    for load in ["A.FZ", "B.FZ"] {
        let load = of_load(&found, "comparison", load);
        assert_eq!(load["n"], 5000);
        // Three standard deviations of a share of 5,000 samples, plus 0.1 % for the interpolation of the recorded
        // loads.
        assert!(
            (number(&load["share_within"]) - 0.95).abs() < 0.0103,
            "{load}"
        );
        assert!(
            number(&load["damage_ratio_low"]) < 1.0 && number(&load["damage_ratio_high"]) > 1.0
        );
    }
    let outside = findings
        .iter()
        .any(|f| f.0 == "recorded-loads-outside-intervals");
    assert!(!outside, "{findings:?}");
}

#[test]
fn runs_are_compared_by_name_and_loads_that_nobody_recorded_are_not() {
    let loads = |i: usize| loads_at(0.37 * i as f64);
    let mut strains = "run,G1,G2,G3,G4\n".to_owned();
    let mut runs = "run,B.FZ,A.FZ\n".to_owned();
    for i in 0..12 {
        let [a, b] = loads(i);
        let [g1, g2, g3, g4] = strain(a, b);
        let _ = writeln!(strains, "R{i},{g1},{g2},{g3},{g4}");
        // Load B has no record in the last two runs. The rows are in reverse order.
        let j = 11 - i;
        let [a, b] = loads(j);
        let b = if j > 9 { String::new() } else { b.to_string() };
        let _ = writeln!(runs, "R{j},{b},{}", a + 3.0);
    }
    let more = "[runs]\nfile = \"runs.csv\"\nunits = { force = \"N\" }\n";
    let in_compare = "[compare]\nfile = \"runs.csv\"\nunits = { force = \"N\" }\n";
    for more in [more, in_compare] {
        let (found, findings) =
            answer(&files(strains.clone(), more).with_file("runs.csv", runs.clone())).unwrap();
        let [a, b] = ["A.FZ", "B.FZ"].map(|l| of_load(&found, "comparison", l).clone());
        assert_eq!((&a["n"], &b["n"]), (&Value::from(12), &Value::from(10)));
        for (v, expected) in [
            (&a["bias"], -3.0),
            (&a["rms"], 3.0),
            (&b["bias"], 0.0),
            (&b["rms"], 0.0),
        ] {
            assert!((number(v) - expected).abs() < 1e-9, "{a} {b}");
        }
        assert_eq!(
            (number(&a["share_within"]), number(&b["share_within"])),
            (0.0, 1.0)
        );
        assert!(a["damage_ratio"].is_null() && found.get("comparison_shift").is_none());
        assert!(
            findings.iter().any(|f| f.1 == "load `A.FZ`"),
            "{findings:?}"
        );
    }
    // The interval includes the stated noise of the recorded loads.
    let noisy = format!("{more}noise = {{ force = 3.0 }}\n");
    let (found, _) = answer(&files(strains.clone(), &noisy).with_file("runs.csv", runs)).unwrap();
    assert_eq!(
        number(&of_load(&found, "comparison", "A.FZ")["share_within"]),
        1.0
    );
    let (found, _) = answer(&files(strains, "")).unwrap();
    assert!(found.get("comparison").is_none() && found.get("sections").is_none());
}

/// Returns load A with 25 periods of amplitude 100 from peak to peak, followed by 40 periods of amplitude 50. Load B is
/// constant.
fn two_stretches(t: f64) -> [f64; 2] {
    let a = match t < 10.005 {
        true => 100.0 * (TAU * t / 0.4).cos(),
        false => 50.0 * (TAU * (t - 10.01) / 0.2).cos(),
    };
    [a, 10.0]
}

/// `n` periods from peak to peak are `n` cycles with twice the amplitude as range. Their damage is `n (2 a)^m` (ASTM
/// E1049, with half cycles added up).
#[test]
fn sections_have_the_damage_of_their_sines_and_add_up_to_the_duty_cycle() {
    let more = "[[section]]\nname = \"smooth\"\nstart_s = 10.01\nend_s = 18.015\nrepeats = 10\n\
                [[section]]\nname = \"rough\"\nstart_s = 0.0\nend_s = 10.005\nrepeats = 2.5\n\
                [[section]]\nname = \"apart\"\nfile = \"apart.csv\"\n\
                [recover]\nslope = 4.0\n";
    let strain = record(2000, 0.0, two_stretches, || 0.0);
    // Thirty periods from peak to peak in a separate record.
    let apart = record(601, 0.0, |t| [20.0 * (TAU * t / 0.2).cos(), 10.0], || 0.0);
    let (found, _) = answer(&files(strain, more).with_file("apart.csv", apart)).unwrap();
    let list = found["sections"].as_array().unwrap();
    let names: Vec<&Value> = list.iter().map(|s| &s["section"]).collect();
    assert_eq!(
        names,
        ["smooth", "smooth", "rough", "rough", "apart", "apart"]
    );
    let of = |section: &str, load: &str| {
        let found = list
            .iter()
            .find(|s| s["section"] == section && s["load"] == load);
        found.unwrap().clone()
    };
    let near = |v: &Value, expected: f64| {
        // The program keeps samples in single precision, and damage is a fourth power.
        let limit = 1e-6 * expected.abs().max(100.0);
        assert!((number(v) - expected).abs() < limit, "{v} {expected}");
    };
    let damage = |n: f64, amplitude: f64| n * (2.0 * amplitude).powi(4);
    let expected = [
        ("smooth", 40.0, 50.0, 801.0),
        ("rough", 25.0, 100.0, 1001.0),
        ("apart", 30.0, 20.0, 601.0),
    ];
    for (section, n, amplitude, samples) in expected {
        let a = of(section, "A.FZ");
        near(&a["damage"], damage(n, amplitude));
        near(&a["seconds"], samples / RATE);
        near(&a["min"], -amplitude);
        near(&a["max"], amplitude);
        // Whole periods and one more peak.
        near(&a["mean"], amplitude / samples);
        assert!(number(&a["damage_low"]) < number(&a["damage"]));
        let b = of(section, "B.FZ");
        near(&b["mean"], 10.0);
        assert!(number(&b["damage"]) < 1e-12, "{b}");
    }
    let duty = of_load(&found, "duty_cycle", "A.FZ");
    near(
        &duty["damage"],
        10.0 * damage(40.0, 50.0) + 2.5 * damage(25.0, 100.0) + damage(30.0, 20.0),
    );
    near(&duty["seconds"], 80.1 + 2.5 * 10.01 + 6.01);
}

#[test]
fn what_can_not_be_compared_or_cut_is_refused_with_its_line() {
    let strain = record(3000, START, loads_at, || 0.0);
    let wft = format_load_record(START, 0.0, 30.0);
    let runs = "run,A.FZ,B.FZ\nR1,1,2\n";
    let compare = "[compare]\nfile = \"wft.csv\"\n";
    let section = |from: f64, to: f64| {
        format!("[[section]]\nname = \"s{from}\"\nstart_s = {from}\nend_s = {to}\n")
    };
    let cases = [
        (
            "[runs]\nfile = \"none.csv\"\n".to_owned(),
            "none.csv",
            "no such file",
        ),
        (
            "[compare]\nfile = \"none.rsp\"\n".to_owned(),
            "none.rsp",
            "no such file",
        ),
        (
            format!("{compare}shift_s = 1e6\n"),
            "compare.shift_s",
            "no time in common",
        ),
        (
            format!("{compare}shift_s = \"guess\"\n"),
            "compare.shift_s",
            "expected \"estimate\"",
        ),
        (
            format!("{compare}columns = {{ \"A.FZ\" = \"F_A\" }}\n"),
            "compare.columns.A.FZ",
            "has no column `F_A`",
        ),
        (
            "[compare]\nfile = \"other.csv\"\n".to_owned(),
            "columns",
            "no column has the name of a load",
        ),
        (
            "[compare]\nfile = \"runs.csv\"\n".to_owned(),
            "compare.file",
            "of runs",
        ),
        (
            "[compare]\nfile = \"unlike.csv\"\n".to_owned(),
            "compare.shift_s",
            "do not agree at any time shift",
        ),
        (section(30.0, 36.0), "section.end_s", "beyond the record"),
        (section(2.0, 8.0), "section.end_s", "beyond the record"),
        (section(8.0, 8.0), "section.end_s", "is empty"),
        (section(8.001, 8.002), "section.start_s", "no sample"),
        (
            section(6.0, 9.0) + &section(8.0, 10.0),
            "section.start_s",
            "overlaps section `s6`",
        ),
        (
            "[[section]]\nname = \"a\"\n".to_owned(),
            "section.start_s",
            "no samples",
        ),
    ];
    let mut unlike = "time,A.FZ\n".to_owned();
    let mut noise = normal_numbers(3);
    for i in 0..3000 {
        let _ = writeln!(unlike, "{},{}", f64::from(i) * 0.01, noise());
    }
    for (more, field, words) in cases {
        let files = files(strain.clone(), &more)
            .with_file("wft.csv", wft.clone())
            .with_file("runs.csv", runs)
            .with_file("other.csv", "time,X\n0,1\n0.01,2\n0.02,3\n")
            .with_file("unlike.csv", unlike.clone());
        let faults = answer(&files).unwrap_err();
        let printed = faults.to_string();
        assert!(
            printed.contains(field) && printed.contains(words),
            "{more}: {printed}"
        );
    }
    let of_runs = files(
        "run,G1,G2,G3,G4\nR1,1,2,3,4\nR2,2,1,3,2\n".to_owned(),
        &section(0.0, 1.0),
    );
    let printed = answer(&of_runs).unwrap_err().to_string();
    assert!(printed.contains("the strain file has runs"), "{printed}");
}

#[test]
fn every_sample_is_in_the_table_and_the_job_thins_it() {
    let rows = |dir: &std::path::Path| {
        let csv = std::fs::read_to_string(dir.join("job.out/loads.csv")).unwrap();
        csv.lines()
            .skip(1)
            .map(|l| l.split(',').next().unwrap().to_owned())
            .collect::<Vec<_>>()
    };
    let record = table("time", 300, as_is);
    let (code, printed, result, dir) = by_command("every-sample", &record, "");
    assert_eq!(code, 0, "{printed}");
    assert_eq!(
        (rows(&dir).len(), result["csv_every"].as_u64()),
        (300, Some(1))
    );
    let (code, printed, result, dir) =
        by_command("every-seventh", &record, "[recover]\ncsv_every = 7\n");
    assert_eq!(code, 0, "{printed}");
    let thinned = rows(&dir);
    assert_eq!((thinned.len(), result["csv_every"].as_u64()), (43, Some(7)));
    assert_eq!(thinned[1], "0.07");
    assert!(codes(&result).contains(&"history-thinned".to_owned()));
    assert!(dir.join("job.out/loads.bin").exists());
}

#[test]
fn tables_page_and_console_state_comparison_and_sections() {
    let more = "[runs]\nfile = \"runs.csv\"\n[compare]\nfile = \"wft.csv\"\nunits = { force = \"N\" }\nshift_s = 0\n\
                [[section]]\nname = \"first, half\"\nstart_s = 0\nend_s = 1.5\n";
    let mut wft = "time,A,B,GPS\n".to_owned();
    for i in 0..300 {
        let [a, b] = super::loads(i);
        let _ = writeln!(wft, "{},{a},{b},1", i as f64 * 0.01);
    }
    let dir = super::folder("compared");
    // The first run makes the files of the job. The second run has the files that the job names.
    let (code, printed, _, dir) = {
        let _ = dir;
        by_command("compared", &table("time", 300, as_is), more)
    };
    assert_eq!(code, 2);
    assert!(printed.contains("runs.csv"), "{printed}");
    std::fs::write(dir.join("runs.csv"), "run,A,B\nR0,1,2\n").unwrap();
    std::fs::write(dir.join("wft.csv"), wft).unwrap();
    let out = std::process::Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["recover", &dir.join("job.toml").display().to_string()])
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&[out.stdout, out.stderr].concat()).into_owned();
    assert_eq!(out.status.code(), Some(0), "{printed}");
    assert!(
        printed.contains("damage ratio") && printed.contains("column-not-read"),
        "{printed}"
    );
    let read = |name: &str| std::fs::read_to_string(dir.join("job.out").join(name)).unwrap();
    let comparison = read("comparison.csv");
    assert!(comparison.starts_with("load,unit,n,bias,rms,share_within,damage_ratio,"));
    assert!(comparison.contains("\nA,N,300,"), "{comparison}");
    assert!(read("sections.csv").contains("\n\"first, half\",A,N,1.5,1,"));
    let levels = read("comparison_levels.csv");
    assert!(
        levels.starts_with("A.level [N],A.recovered [-],A.recorded [-],B.level [N],"),
        "{levels}"
    );
    assert_eq!(levels.lines().count(), 41);
    // 300 samples are too few for a spectrum of 32 averages.
    assert!(!dir.join("job.out/comparison_spectra.csv").exists());
    let page = read("report.html");
    assert!(page.contains("Recovered against recorded loads") && page.contains("Duty cycle"));
    assert!(page.contains("Crossings of each level"));
}

/// A record of strain with the channels `speed`, `lat` and `lon`.
fn record_with_channels(n: usize) -> String {
    let plain = record(n, 0.0, loads_at, || 0.0);
    let mut text = String::new();
    for (i, line) in plain.lines().enumerate() {
        let t = (i as f64 - 1.0) / RATE;
        let fast = (10.0..20.0).contains(&t) || (25.0..25.5).contains(&t) || t >= 30.0;
        let [lat, lon] = [51.0 + 1e-4 * t, 4.4 + 0.01 * (t / 20.0).sin()];
        let speed = if fast { 8.0 } else { 3.0 };
        let _ = match i {
            0 => writeln!(text, "{line},speed [m/s],lat,lon"),
            // A missing sample is outside.
            1200 => writeln!(text, "{line},,{lat:.6},{lon:.6}"),
            _ => writeln!(text, "{line},{speed},{lat:.6},{lon:.6}"),
        };
    }
    text
}

/// Stretches by a threshold with a least duration have the statistics of sections by their times; damage adds up.
#[test]
fn a_section_by_speed_is_the_sum_of_the_stretches_by_time() {
    let rule = "[[section]]\nname = \"fast\"\nwithin = { speed = [5.0, inf] }\nat_least_s = 1.5\n";
    let (found, findings) = answer(&files(record_with_channels(4000), rule)).unwrap();
    assert!(
        findings
            .iter()
            .all(|f| f.0 != "strain-without-gauge" || !f.1.contains("speed")),
        "{findings:?}"
    );
    let times = |name: &str, from: f64, to: f64| {
        format!("[[section]]\nname = \"{name}\"\nstart_s = {from}\nend_s = {to}\n")
    };
    let stretches = times("a", 10.0, 11.99) + &times("b", 12.0, 20.0) + &times("c", 30.0, 40.0);
    let (by_time, _) = answer(&files(record_with_channels(4000), &stretches)).unwrap();
    for load in ["A.FZ", "B.FZ"] {
        let rows = |answer: &Value| -> Vec<Value> {
            let list = answer["sections"].as_array().unwrap();
            list.iter().filter(|s| s["load"] == load).cloned().collect()
        };
        let (one, parts) = (&rows(&found)[0], rows(&by_time));
        let all = |key: &str| parts.iter().map(|p| number(&p[key])).collect::<Vec<f64>>();
        let close = |got: f64, expected: f64| {
            assert!(
                (got - expected).abs() <= 1e-9 * expected.abs(),
                "{load}: {got} {expected}"
            )
        };
        assert_eq!(one["stretches"], 3);
        for key in ["seconds", "damage", "damage_low", "damage_high"] {
            close(number(&one[key]), all(key).iter().sum());
        }
        close(
            number(&one["max"]),
            all("max").into_iter().fold(f64::MIN, f64::max),
        );
        close(
            number(&one["min"]),
            all("min").into_iter().fold(f64::MAX, f64::min),
        );
    }
}

#[test]
fn a_section_by_a_box_of_positions_needs_both_channels_inside() {
    let rule =
        "[[section]]\nname = \"bend\"\nwithin = { lat = [51.001, 51.003], lon = [4.405, 4.5] }\n";
    let (found, _) = answer(&files(record_with_channels(4000), rule)).unwrap();
    // lat: 10 to 30 s; lon: sin(t / 20) from 0.5 on, t from 10.472 s. The last sample at 30.00 s is inside.
    let a = of_load(&found, "sections", "A.FZ");
    assert_eq!(a["stretches"], 1);
    assert!((number(&a["seconds"]) - 19.53).abs() < 0.011, "{a}");
}

#[test]
fn rules_of_sections_that_select_nothing_or_too_much_are_refused() {
    let refused = |more: &str, expected: &[&str]| {
        let printed = answer(&files(record_with_channels(4000), more))
            .unwrap_err()
            .to_string();
        for part in expected {
            assert!(printed.contains(part), "{part}: {printed}");
        }
    };
    let rule = |keys: &str| format!("[[section]]\nname = \"fast\"\n{keys}\n");
    refused(
        &rule("within = { sped = [5.0, inf] }"),
        &["section.within", "did you mean `speed`"],
    );
    refused(
        &rule("within = { speed = [9.0, inf] }"),
        &["no stretch", "`speed` covers 3 to 8"],
    );
    refused(
        &rule("within = { speed = [5.0, inf] }\nat_least_s = 60"),
        &["no stretch of 60 s", "the longest has 10 s"],
    );
    refused(
        &rule("within = { speed = [5.0, 5.0] }"),
        &["section.within.speed", "not a range"],
    );
    refused(
        &rule("within = { speed = [-inf, inf] }"),
        &["section.within.speed", "not a range"],
    );
    refused(
        &rule("start_s = 1\nend_s = 2\nwithin = { speed = [5.0, 9.0] }"),
        &["together with a file or times"],
    );
    refused(
        &rule("start_s = 1\nend_s = 2\nat_least_s = 1"),
        &["needs ranges of channels"],
    );
    let both = rule("within = { speed = [5.0, inf] }")
        + "[[section]]\nname = \"other\"\nstart_s = 35\nend_s = 36\n";
    refused(&both, &["section `other` overlaps section `fast` at 35 s"]);
}

/// Conditioned readings are in memory; the channels of sections are still read from the file.
#[test]
fn sections_by_a_rule_work_on_a_conditioned_record() {
    let more = "[conditioning]\nlow_pass_hz = 20\n[[section]]\nname = \"fast\"\nwithin = { speed = [5.0, inf] }\nat_least_s = 1.5\n";
    let (found, _) = answer(&files(record_with_channels(4000), more)).unwrap();
    assert_eq!(of_load(&found, "sections", "A.FZ")["stretches"], 3);
}

/// Spectra of sines: the density sums to the variance, the coherence at the sines is 1; both loads cross each level equally often.
#[test]
fn spectra_coherence_and_levels_of_recovered_and_recorded_loads_agree() {
    let more =
        "[compare]\nfile = \"wft.csv\"\ncolumns = { \"B.FZ\" = \"Kraft B\" }\nshift_s = 6.0\n";
    let mut noise = normal_numbers(5);
    let strain = record(20_000, START, loads_at, || 0.1 * noise());
    let wft = format_load_record(6.0, 0.0, 190.0);
    let files = files(strain, more).with_file("wft.csv", wft);
    let job = Job::read("job.toml", &files).unwrap();
    let outcome = recover(&job, &Context::new(&files)).unwrap();
    let spectra = outcome.comparison.spectra.as_ref().unwrap();
    // 190 s at 100 Hz: 33 half segments of 1024 samples at most, so 1024 is the longest power of two.
    assert_eq!((spectra.segment_s, spectra.averages), (10.24, 36));
    let step = spectra.f_hz[1] - spectra.f_hz[0];
    // The recording has 128 samples per second: the spectra end at an eighth of it.
    let last = *spectra.f_hz.last().unwrap();
    assert!(last <= 16.0 && last > 16.0 - 2.0 * step, "{last}");
    let a = spectra.loads.iter().find(|l| l.load == "A.FZ").unwrap();
    let variance = 0.5 * (100.0f64.powi(2) + 70.0f64.powi(2) + 40.0f64.powi(2));
    for density in [&a.recovered, &a.recorded] {
        let sum = density.iter().sum::<f64>() * step;
        assert!((sum / variance - 1.0).abs() < 0.03, "{sum} {variance}");
    }
    for f in [0.31, 1.13, 2.71] {
        let k = (f / step).round() as usize;
        assert!(
            a.coherence[k] > 0.999 && a.phase_deg[k].abs() < 0.5,
            "{f}: {}",
            a.coherence[k]
        );
    }
    // Far from the sines, independent noise of the readings has the coherence of chance, about 1 over the averages.
    let k = (5.0 / step) as usize;
    let chance = a.coherence[k..k + 100].iter().sum::<f64>() / 100.0;
    assert!(chance < 0.5, "{chance}");
    let levels = outcome
        .comparison
        .levels
        .iter()
        .find(|l| l.load == "A.FZ")
        .unwrap();
    assert_eq!(levels.levels.len(), 40);
    assert!((levels.reference - 300.0).abs() < 3.0);
    let pairs = levels.recovered.iter().zip(&levels.recorded);
    for (level, (recovered, recorded)) in levels.levels.iter().zip(pairs) {
        // Peaks between two samples, at 100 and at 128 Hz, may miss a level; noise of 0.2 N may cross one twice.
        let most = 3.0 + 0.05 * *recorded as f64;
        assert!(
            (*recovered as f64 - *recorded as f64).abs() <= most,
            "{level}: {recovered} {recorded}"
        );
    }
}
