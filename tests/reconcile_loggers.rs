//! Faults of a logger in one channel: a wrong clock, lost samples, a slow filter, mains hum. Also second records that
//! cannot be used for a test.

mod moving;

use moving::generator::{Background, Case, Layout, RATE_HZ, hide};
use moving::logger::{Fault, generate_faulty_case};
use moving::{Score, frame_of, score};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use strainbridge::reconcile::Verdict;
use strainbridge::reconcile::motion::examine;

/// Fails unless the fault is named at its channel with a size within a share of the true size.
fn assert_fault_named(
    layout: Layout,
    fault: Fault,
    channel: &str,
    background: Background,
    seed: u64,
    near: f64,
) {
    let case = generate_faulty_case(layout, fault, channel, background, seed);
    let o = examine(&frame_of(&case), &[]).unwrap();
    let found = score(&case, &o);
    let printed = format!(
        "{layout:?} {fault:?} {channel} {seed}: {found:?} {:?} {:?}",
        o.best_attempt, o.rivals
    );
    assert_eq!(found, Score::Exact, "{printed}");
    assert_eq!(o.effects.len(), 1, "{printed}");
    let size = o.effects[0].size[0];
    assert!((size / fault.size() - 1.0).abs() < near, "{printed}");
    // If the held-out record lost no samples, it tests only parameters. Its gap is small before.
    let closed = o.gap.explained_share() > 0.9 || o.gap.after < 1.3 * o.gap.floor;
    assert!(closed, "{printed} {:?}", o.gap);
}

#[test]
fn a_clock_that_is_off_is_named_by_its_channel() {
    // 40 ppm give 2.6 ms in 64 s, and 200 ppm give 13 ms, an eighth of a wave of the axle. 3,000 ppm give two waves of
    // it.
    for (layout, channel, share) in [
        (Layout::Front, "a_body", 4e-5),
        (Layout::Front, "a_wheel", -2e-4),
        (Layout::Front, "a_wheel", 3e-3),
    ] {
        assert_fault_named(
            layout,
            Fault::Clock(share),
            channel,
            Background::Clean,
            21,
            0.03,
        );
    }
}

#[test]
fn samples_that_are_lost_are_named_by_their_channel() {
    for (layout, channel, n, at) in [
        (Layout::Front, "a_wheel", 12, 0.7),
        (Layout::Front, "f_wheel", 1, 0.3),
        (Layout::Rear, "f_mid", 5, 0.55),
    ] {
        assert_fault_named(
            layout,
            Fault::Lost(n, at),
            channel,
            Background::Clean,
            22,
            0.03,
        );
    }
}

#[test]
fn a_slow_filter_is_named_and_not_a_delay() {
    for (layout, fault, channel) in [
        (Layout::Front, Fault::LowPass(15.0), "a_body"),
        (Layout::Front, Fault::Butterworth(25.0), "a_wheel"),
        (Layout::Front, Fault::Butterworth(40.0), "f_wheel"),
        (Layout::Rear, Fault::LowPass(30.0), "a_mid"),
    ] {
        // The filter of the records is a difference equation. Compared with an RC circuit, its error is (w dt)^2 / 12.
        assert_fault_named(layout, fault, channel, Background::Clean, 23, 0.03);
    }
}

#[test]
fn hum_of_the_mains_is_named_by_its_channel() {
    for (layout, hz, amplitude, channel) in [
        (Layout::Front, 16.72, 0.3, "a_body"),
        (Layout::Front, 16.64, 0.5, "a_wheel"),
        (Layout::Rear, 16.68, 0.4, "a_rear"),
    ] {
        assert_fault_named(
            layout,
            Fault::Hum(hz, amplitude),
            channel,
            Background::Clean,
            24,
            0.1,
        );
    }
}

/// Tolerances can hide a fault. Any other effect that is named must be correct, and `unknown` is not wrong.
#[test]
fn before_an_imperfect_background_nothing_false_is_named() {
    for (fault, channel) in [
        (Fault::Clock(3e-4), "a_wheel"),
        (Fault::Lost(6, 0.5), "a_body"),
        (Fault::LowPass(20.0), "a_body"),
        (Fault::Hum(16.7, 0.6), "a_wheel"),
    ] {
        let case = generate_faulty_case(Layout::Front, fault, channel, Background::Messy, 25);
        let o = examine(&frame_of(&case), &[]).unwrap();
        let found = score(&case, &o);
        assert!(
            matches!(found, Score::Exact | Score::Group | Score::Abstained),
            "{fault:?} {channel}: {found:?} {:?} {:?}",
            o.best_attempt,
            o.rivals
        );
    }
}

#[test]
fn healthy_loggers_are_left_alone() {
    for seed in 30..32 {
        for layout in [Layout::Front, Layout::Rear] {
            let case = hide(layout, "none", 0, Background::Messy, seed);
            let o = examine(&frame_of(&case), &[]).unwrap();
            let quiet = matches!(o.verdict, Verdict::None | Verdict::BelowDetectability);
            assert!(quiet, "{layout:?} {seed}: {:?}", o.effects);
        }
    }
}

/// Creates a folder with the job of a case. `spoil` shortens or damages its second record.
fn workplace(
    name: &str,
    case: &Case,
    effects: &str,
    spoil: impl Fn(&str, &mut Vec<f64>),
) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("loggers_{name}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let mut hold_out = case.hold_out.clone();
    hold_out.iter_mut().for_each(|(name, x)| spoil(name, x));
    for (file, record) in [("data.csv", &case.data), ("holdout.csv", &hold_out)] {
        let mut text = String::from("t");
        record
            .iter()
            .for_each(|c| write!(text, ",{}", c.0).unwrap());
        for i in 0..record[0].1.len() {
            write!(text, "\n{:.4}", i as f64 / RATE_HZ).unwrap();
            record
                .iter()
                .for_each(|c| write!(text, ",{:.4}", c.1[i]).unwrap());
        }
        std::fs::write(folder.join(file), text + "\n").unwrap();
    }
    let job = format!(
        "title = \"logger\"\nunits = \"m-kg-s\"\n[vehicle]\nmodel = \"front2\"\nterms = [\"k_s\", \"c_s\"]\n\
         data = \"data.csv\"\nhold_out = \"holdout.csv\"\nsample_rate = {RATE_HZ}\n\
         noise = {{ acc = {}, force = {} }}\nband_hz = [0.7, 20.0]\n[reconcile]\npath = \"dynamic\"\neffects = {effects}\n",
        case.noise[0], case.noise[1]
    );
    std::fs::write(folder.join("job.toml"), job).unwrap();
    folder
}

fn run(command: &str, job: &Path, out: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args([command.as_ref(), job.as_os_str()])
        .arg("--out")
        .arg(out)
        .arg("--json")
        .output()
        .unwrap()
}

fn answer(done: &Output) -> serde_json::Value {
    let printed = String::from_utf8_lossy(&done.stderr);
    serde_json::from_slice(&done.stdout).unwrap_or_else(|e| panic!("{e}: {printed}"))
}

/// The named fault is in the extended job, and a second run with that job names nothing.
#[test]
fn the_extended_job_holds_the_fault_of_the_logger() {
    let known = "[\"clock_drift\", \"dropped_samples\", \"low_pass\", \"hum\", \"time_offset\"]";
    for (name, fault, channel) in [
        ("clock", Fault::Clock(2e-4), "a_wheel"),
        ("lost", Fault::Lost(4, 0.5), "a_body"),
        ("slow", Fault::Butterworth(30.0), "a_wheel"),
        ("hum", Fault::Hum(16.7, 0.5), "a_body"),
    ] {
        let case = generate_faulty_case(Layout::Front, fault, channel, Background::Clean, 26);
        let folder = workplace(name, &case, known, |_, _| {});
        let r = answer(&run(
            "reconcile",
            &folder.join("job.toml"),
            &folder.join("out"),
        ));
        let id = format!("{}:{channel}", fault.name());
        assert_eq!(
            r["named"],
            serde_json::json!([id]),
            "{name}: {}",
            r["best_attempt"]
        );
        let extended = PathBuf::from(r["extended_model"].as_str().unwrap());
        let again = answer(&run("reconcile", &extended, &folder.join("again")));
        assert_eq!(again["verdict"], "none", "{name}: {}", again["named"]);
        let gap = |of: &serde_json::Value, key: &str| of["gap"][key].as_f64().unwrap();
        assert!(
            gap(&again, "before") < 1.3 * gap(&again, "floor"),
            "{name}: {}",
            again["gap"]
        );
        let identified = run("identify", &extended, &folder.join("identified"));
        assert_eq!(identified.status.code(), Some(0), "{name}");
    }
}

/// A record that is too short for its band is a fault of that file, in `identify` and in `reconcile`. A record with a
/// dead channel is not used.
#[test]
fn a_second_record_that_cannot_test_is_reported_by_its_name() {
    let case = hide(Layout::Front, "none", 0, Background::Clean, 27);
    let some = "[\"coulomb_friction\", \"time_offset\"]";
    for (name, seconds) in [("twelve", 12.0), ("none", 0.004)] {
        let cut = |_: &str, x: &mut Vec<f64>| x.truncate((seconds * RATE_HZ) as usize);
        let folder = workplace(name, &case, some, cut);
        for command in ["reconcile", "identify"] {
            let done = run(command, &folder.join("job.toml"), &folder.join("out"));
            assert_eq!(done.status.code(), Some(2), "{command} {name}");
            let fault = &answer(&done)["faults"][0];
            assert_eq!(fault["file"], "holdout.csv", "{command} {name}");
            assert!(
                fault["remedy"].as_str().unwrap().contains("band edge"),
                "{fault}"
            );
        }
    }
    for channel in ["a_body", "a_wheel", "f_wheel"] {
        let kill = |name: &str, x: &mut Vec<f64>| {
            if name == channel {
                let level = x[0];
                x.fill(level);
            }
        };
        let folder = workplace("dead", &case, some, kill);
        let r = answer(&run(
            "reconcile",
            &folder.join("job.toml"),
            &folder.join("out"),
        ));
        assert_eq!(r["verdict"], "none", "{channel}: {}", r["gap"]);
        assert_eq!(r["gap"]["judged_by"], "cross-validated", "{channel}");
        let findings = r["findings"].as_array().unwrap();
        let printed = findings.iter().any(|f| {
            f["code"] == "no-hold-out" && f["message"].as_str().unwrap().contains(channel)
        });
        assert!(printed, "{channel}: {findings:?}");
    }
}

/// A gap without any equation is null, not a number.
#[test]
fn a_dead_accelerometer_is_reported_by_the_command_without_a_made_up_gap() {
    let mut case = hide(Layout::Front, "none", 0, Background::Clean, 28);
    let still = |name: &str, x: &mut Vec<f64>| {
        if name == "a_body" {
            x.fill(9.8);
        }
    };
    case.data.iter_mut().for_each(|(name, x)| still(name, x));
    let folder = workplace("still", &case, "[\"time_offset\"]", still);
    let done = run("reconcile", &folder.join("job.toml"), &folder.join("out"));
    let r = answer(&done);
    assert_eq!(
        r["named"],
        serde_json::json!(["dead_channel:a_body"]),
        "{r}"
    );
    for key in ["before", "after", "explained_share"] {
        assert!(r["gap"][key].is_null(), "{key}: {}", r["gap"]);
    }
    assert!(r["extended_model"].is_null());
    let findings = r["findings"].as_array().unwrap();
    let not_in = findings.iter().find(|f| f["code"] == "effect-not-in-model");
    assert_eq!(not_in.unwrap()["subject"], "dead_channel:a_body");
    let printed = std::fs::read_to_string(folder.join("out/report.html")).unwrap();
    assert!(printed.contains("No equation can be compared without"));
}
