//! The truck tutorial through the program, and the commands that continue from it.

use crate::program::{codes, run, scratch};
use std::path::Path;

fn number(v: &serde_json::Value) -> f64 {
    v.as_f64().unwrap_or(f64::NAN)
}

/// Writes a job of the tutorial with further sections.
fn job(folder: &Path, name: &str, from: &str, extra: &str) -> String {
    let text = std::fs::read_to_string(folder.join(from)).unwrap() + extra;
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn the_story_names_what_was_hidden_and_gets_the_loads_back() {
    let folder = scratch("story");
    let (code, result, err) = run(&["demo"], &folder);
    assert_eq!(code, 0, "{err}");
    assert_eq!(result["named"][0], result["hidden"], "{result}");
    let (before, after) = (
        number(&result["wheel_force_error"]["before"]),
        number(&result["wheel_force_error"]["after"]),
    );
    println!(
        "story: wheel loads {before:.3} before, {after:.3} after; payload {}",
        result["payload_error"]
    );
    assert!(after < 0.06 && after < 0.5 * before, "{before} {after}");
    // Measured 0.35 %.
    assert!(number(&result["payload_error"]) < 0.007);
    for chapter in [
        "1-solve",
        "2-place",
        "3-recover",
        "4-reconcile",
        "5-recover-again",
        "6-payload",
        "7-respond",
    ] {
        assert!(
            folder.join(chapter).join("report.html").is_file(),
            "{chapter}"
        );
        assert!(
            folder.join(chapter).join("result.json").is_file(),
            "{chapter}"
        );
    }
    assert!(
        folder.join("report.html").is_file()
            && folder.join("7-respond").join("envelope.vtu").is_file()
    );

    // Stress from the table that `recover` wrote equals stress from the runs that `respond` recovers.
    let inside: serde_json::Value = serde_json::from_str(
        &std::fs::read_to_string(folder.join("7-respond/result.json")).unwrap(),
    )
    .unwrap();
    let with_table = job(&folder, "respond_table.toml", "respond.toml", "");
    let text = std::fs::read_to_string(&with_table).unwrap();
    let named = "[respond]\nloads = \"5-recover-again/loads.csv\"";
    std::fs::write(&with_table, text.replace("[respond]", named)).unwrap();
    let (code, table, err) = run(&["respond", &with_table], &folder.join("respond_table"));
    assert_eq!(code, 0, "{err}");
    let (a, b) = (&inside["elements"][0], &table["elements"][0]);
    assert_eq!(
        (&a["element"], &a["surface"], &a["at"]),
        (&b["element"], &b["surface"], &b["at"])
    );
    assert!((number(&a["max_von_mises"]) / number(&b["max_von_mises"]) - 1.0).abs() < 1e-9);
    assert!(codes(&table, "info").contains(&"load-errors-independent".to_owned()));
    // Predicted and measured strain at the gauges agree within the scatter of gauge factors and the model.
    let gauges = table["gauges"].as_array().unwrap();
    assert_eq!(gauges.len(), 24);
    let rms = |key: &str| {
        gauges
            .iter()
            .map(|g| number(&g[key]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    assert!(rms("residual_rms_microstrain") < 0.1 * rms("measured_rms_microstrain"));

    // The study on the gauges of the tutorial: proportional noise causes proportional scatter of the loads. Two runs
    // give equal bytes.
    let study = job(
        &folder,
        "study.toml",
        "recover.toml",
        "[study]\nlayouts = [\"given\", \"random\", \"D\"]\ngauges = [12, 24]\ntrials = 300\nseed = 7\n\
         errors = [{ kind = \"relative-uniform\", size = 0.05 }, { kind = \"relative-uniform\", size = 0.1 }, { kind = \"angle\", size = 1.0 }, \
         { kind = \"position\", size = 2.0 }]\n",
    );
    let (code, first, err) = run(&["study", &study], &folder.join("study1"));
    assert_eq!(code, 0, "{err}");
    let rows = first["study"].as_array().unwrap();
    let find = |layout: &str, gauges: u64, error: &str| {
        rows.iter()
            .find(|r| r["layout"] == layout && r["gauges"] == gauges && r["error"] == error)
            .unwrap_or_else(|| panic!("{layout} {gauges} {error}: {first}"))
    };
    let (five, ten) = (
        find("given", 24, "relative-uniform 0.05"),
        find("given", 24, "relative-uniform 0.1"),
    );
    for (a, b) in five["loads"]
        .as_array()
        .unwrap()
        .iter()
        .zip(ten["loads"].as_array().unwrap())
    {
        assert!(
            (number(&b["sigma"]) / number(&a["sigma"]) - 2.0).abs() < 1e-6,
            "{a} {b}"
        );
    }
    assert!(number(&find("given", 24, "angle 1")["mean_relative_rms"]) > 0.0);
    assert!(number(&find("given", 24, "position 2")["mean_relative_rms"]) > 0.0);
    assert!(
        number(&find("D", 12, "relative-uniform 0.1")["condition_number"])
            < number(&find("random", 12, "relative-uniform 0.1")["condition_number"])
    );
    let (_, second, _) = run(&["study", &study], &folder.join("study2"));
    assert_eq!(first["study"], second["study"]);
}

#[test]
fn a_payload_of_wheel_forces_alone_needs_no_gauges_and_a_flipped_sign_is_refused() {
    let folder = scratch("payload_by_wheels");
    std::fs::write(
        folder.join("truck.bdf"),
        crate::world::deck_text(45.0, crate::world::Frame::Beam, true, 0.0),
    )
    .unwrap();
    let names = crate::world::NAMES.join(",");
    let text = crate::program::head()
        + "[runs]\nfile = \"runs.csv\"\nunits = { force = \"kN\" }\nnoise = { force = 0.1 }\n\
           [payload]\ngrid = 900101\nposition = \"free\"\nuse = [\"reactions\"]\nunloaded = \"Run 1\"\n";
    std::fs::write(folder.join("job.toml"), text).unwrap();
    // Tables 3.2 and 6.4: measured wheel forces of Runs 1, 2 and 3. Their sums give 32.255 and 54.414 kN (6.6). The
    // last run is reversed.
    std::fs::write(
        folder.join("runs.csv"),
        format!(
            "run,{names}\nRun 1,24.530,26.220,19.660,18.700,18.860,18.220\nRun 2,29.286,31.284,26.785,22.514,26.061,22.500\n\
             Run 3,32.053,30.531,32.242,28.460,28.405,28.834\nturned,14.530,16.220,9.660,8.700,8.860,8.220\n"
        ),
    )
    .unwrap();
    let (code, result, err) = run(
        &["payload", folder.join("job.toml").to_str().unwrap()],
        &folder.join("out"),
    );
    assert_eq!(code, 1, "{err}");
    let payload = result["payload"].as_array().unwrap();
    // The printed forces of Run 2 add up to 32.240. The rounding is 15 N.
    for (run, kn) in [(0, 32.255), (1, 54.414)] {
        assert!(
            (number(&payload[run]["force"]) / kn - 1.0).abs() < 2e-3,
            "{}",
            payload[run]
        );
        assert!(
            (number(&payload[run]["mass"]) - kn * 1e3 / 9.80665).abs() < 15.0,
            "{}",
            payload[run]
        );
    }
    assert!(
        payload[2]["force"].is_null()
            && payload[2]["refused"]
                .as_str()
                .unwrap()
                .contains("cannot be negative")
    );
    assert!(codes(&result, "error").contains(&"payload-negative".to_owned()));
    // Place by the lever rule: sum of force times station, divided by the payload.
    let x = |i: usize| [55.0, 55.0, 291.0, 291.0, 339.0, 339.0][i] * 0.0254;
    let change = [
        32.053 - 24.530,
        30.531 - 26.220,
        32.242 - 19.660,
        28.460 - 18.700,
        28.405 - 18.860,
        28.834 - 18.220,
    ];
    let sum: f64 = change.iter().sum();
    let at: f64 = (0..6).map(|i| change[i] * x(i)).sum::<f64>() / sum;
    assert!(
        (number(&payload[1]["position"][0]) - at).abs() < 1e-3,
        "{} {at}",
        payload[1]["position"]
    );
}
