//! The dynamic workflow on cases whose hidden effect is known, and on seeded ones of our own.

mod moving;

use moving::generator::{Background, Layout, hide};
use moving::{Score, frame_of, score};
use std::path::{Path, PathBuf};
use std::process::Command;
use strainbridge::reconcile::Verdict;
use strainbridge::reconcile::motion::{MotionOutcome, examine};

fn shared(case: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/hidden_effects/dynamics")
        .join(case);
    if folder.exists() {
        return Some(folder);
    }
    eprintln!("skipped: {} is absent", folder.display());
    None
}

fn run(command: &str, job: &Path, out: &Path) -> serde_json::Value {
    let output = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args([command.as_ref(), job.as_os_str()])
        .arg("--out")
        .arg(out)
        .arg("--json")
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

fn examined(
    layout: Layout,
    effect: &str,
    size: usize,
    background: Background,
) -> (Score, MotionOutcome) {
    let case = hide(layout, effect, size, background, 7);
    let outcome = examine(&frame_of(&case), &[]).unwrap();
    (score(&case, &outcome), outcome)
}

#[test]
fn shared_cases_get_their_names_and_identify_runs_the_extended_job() {
    for (case, named, truth) in [
        ("dev-d1", None, f64::NAN),
        ("dev-d2", Some("coulomb_friction"), 1000.0),
        ("dev-d3", Some("cubic_stiffness"), 3.2e8),
        ("dev-d4", Some("time_offset:a_body"), 0.005),
    ] {
        let Some(folder) = shared(case) else { return };
        let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("dynamic_{case}"));
        let _ = std::fs::remove_dir_all(&out);
        let r = run("reconcile", &folder.join("job.toml"), &out);
        let Some(named) = named else {
            assert!(r["named"].as_array().unwrap().is_empty(), "{r}");
            assert_ne!(r["verdict"], "unknown");
            continue;
        };
        assert_eq!(r["verdict"], "named", "{case}");
        assert_eq!(r["named"], serde_json::json!([named]), "{case}");
        let size = r["effects"][0]["size"].as_f64().unwrap();
        assert!((size / truth - 1.0).abs() < 0.02, "{case}: {size}");
        assert!(
            r["gap"]["explained_share"].as_f64().unwrap() > 0.95,
            "{case}"
        );
        // What the effect did to a simulation of the held-out road goes to the level of sensor noise.
        for c in r["simulation"]["channels"].as_array().unwrap() {
            let [measured, before, after] =
                ["measured_rms", "before", "after"].map(|k| c[k].as_f64().unwrap());
            assert!(after < 0.15 * before && after < 0.01 * measured, "{c}");
        }
        let by_simulation = r["simulation"]["parameters"].as_array().unwrap();
        if let Some(p) = by_simulation
            .iter()
            .find(|p| matches!(p["name"].as_str(), Some("fc_s" | "k3_s")))
        {
            let p = p["by_simulation"].as_f64().unwrap();
            assert!((p / truth - 1.0).abs() < 0.02, "{case}: {p}");
        }
        let again = run(
            "identify",
            Path::new(r["extended_model"].as_str().unwrap()),
            &out.join("again"),
        );
        let wheel = again["fit"]
            .as_array()
            .unwrap()
            .iter()
            .find(|f| f["channel"] == "f_wheel")
            .unwrap()
            .clone();
        assert!(
            wheel["relative_rms"].as_f64().unwrap() < 0.01,
            "{case}: {wheel}"
        );
    }
}

#[test]
fn controls_are_left_alone_on_clean_and_messy_backgrounds() {
    for background in [Background::Clean, Background::Messy] {
        for layout in [Layout::Front, Layout::Rear] {
            let (s, o) = examined(layout, "none", 0, background);
            assert_eq!(
                s,
                Score::Exact,
                "{layout:?} {background:?}: {:?}",
                o.best_attempt
            );
        }
    }
}

#[test]
fn effects_are_named_with_their_size() {
    let (s, o) = examined(Layout::Front, "coulomb_friction", 1, Background::Clean);
    assert_eq!(s, Score::Exact);
    // 450 N were hidden.
    assert!(
        (o.effects[0].size[0] / 450.0 - 1.0).abs() < 0.05,
        "{:?}",
        o.effects[0].size
    );
    assert!(o.gap.explained_share() > 0.95);
    let (s, o) = examined(Layout::Pair, "roll_coupling", 1, Background::Clean);
    assert_eq!(s, Score::Exact, "{:?}", o.best_attempt);
    let (s, o) = examined(Layout::Front, "sign_flip", 1, Background::Clean);
    assert_eq!(s, Score::Exact, "{:?}", o.best_attempt);
}

#[test]
fn what_is_in_no_library_is_called_unknown() {
    for effect in ["modulated_stiffness", "memory"] {
        let (_, o) = examined(Layout::Front, effect, 2, Background::Clean);
        assert_eq!(o.verdict, Verdict::Unknown, "{effect}: {:?}", o.effects);
    }
}
