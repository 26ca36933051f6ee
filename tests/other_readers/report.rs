//! `report.html` in a real browser: headless Chromium, on a wide screen and with the width of a phone.

use crate::exchange::{job, plate, strainbridge};
use crate::python::read_by;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Opens reports and returns the observations by file and width, or `None` without Chromium.
fn open_reports(reports: &[&Path]) -> Option<Vec<Value>> {
    let paths: Vec<&str> = reports.iter().map(|p| p.to_str().unwrap()).collect();
    let seen = read_by("open_report.py", &paths)?;
    let by_width = |p: &&str| ["1280", "390"].map(|w| seen[*p][w].clone());
    Some(paths.iter().flat_map(by_width).collect())
}

/// Tests the properties of every report.
fn is_sound(page: &Value, titles: &[&str], figures: &[&str]) {
    assert_eq!(page["errors"], serde_json::json!([]));
    assert_eq!(page["requests"], serde_json::json!([]));
    // No element extends beyond the screen, so a phone needs no horizontal scrolling.
    assert_eq!(page["wider"], 0);
    assert_eq!(page["overlaps"], serde_json::json!([]));
    assert_eq!(page["rules"], serde_json::json!([]));
    let list = page["titles"].as_array().unwrap();
    for title in titles {
        assert!(list.iter().any(|t| t == title), "{title} of {list:?}");
    }
    let drawn = page["figures"].as_array().unwrap();
    for label in figures {
        assert!(drawn.iter().any(|f| f["label"] == *label), "{label}");
    }
    for figure in drawn {
        // At least a full sentence.
        assert!(
            figure["caption"].as_str().unwrap().len() > 30,
            "no caption: {figure}"
        );
        // An empty picture has one colour. Thin lines on white cover about a hundredth.
        assert!(figure["other"].as_f64().unwrap() > 0.005, "{figure}");
        assert!(figure["colours"].as_u64().unwrap() > 20, "{figure}");
        let (label, frame) = (figure["label"].as_str().unwrap(), &figure["frame"]);
        let legend = frame["legend"].as_str().unwrap();
        if label.starts_with("measured against") || label.starts_with("recovered against") {
            let [wide, tall] = [0, 1].map(|i| frame["size"][i].as_f64().unwrap());
            assert!((wide - tall).abs() < 0.01, "equal axes: {figure}");
        }
        if label.contains("heat map") {
            assert!(legend.contains("100 % of the largest"), "{figure}");
        }
        if label.starts_with("density of force") {
            assert!(legend.contains("band of the equations, 0.7"), "{figure}");
        }
    }
}

/// Parts of the first screen: sentence, key numbers, picture, table of the result.
const PARTS: [&str; 4] = ["verdict", "numbers", "picture", "table"];

/// Tests the first screen.
///
/// With 1280 x 800 it shows all parts, with JavaScript on and off. On a phone it shows sentence and numbers, and
/// picture and table are no wider than the phone.
fn answers_first(page: &Value, has_picture: bool) {
    let shown = |seen: &Value, size: [f64; 2], parts: &[&str]| {
        for part in parts.iter().filter(|p| has_picture || **p != "picture") {
            let found = seen[part].as_array();
            let found = found.unwrap_or_else(|| panic!("no {part}: {seen}"));
            let [left, top, right, bottom] = [0, 1, 2, 3].map(|i| found[i].as_f64().unwrap());
            assert!(left >= -0.5 && top >= -0.5, "{part}: {seen}");
            assert!(right <= size[0] + 0.5, "{part} aside: {seen}");
            assert!(bottom <= size[1] + 0.5, "{part} below: {seen}");
            assert!(
                right - left > 100.0 && bottom - top > 20.0,
                "{part}: {seen}"
            );
        }
    };
    match page.get("still") {
        Some(still) => {
            shown(&page["first"], [1280.0, 800.0], &PARTS);
            shown(still, [1280.0, 800.0], &PARTS);
            assert_eq!(still["summary"], page["first"]["summary"]);
            assert_eq!(still["empty"], 0);
            // Every figure has a picture without JavaScript.
            assert_eq!(still["without_picture"], serde_json::json!([]));
            assert_eq!(still["overlaps"], serde_json::json!([]));
            assert!(!has_picture || still["pictures"].as_u64() >= Some(1));
        }
        None => {
            shown(&page["first"], [390.0, 800.0], &PARTS[..2]);
            shown(&page["first"], [390.0, 1e5], &PARTS[2..]);
        }
    }
}

/// Tests that a gauge shows its name under the pointer. Gauges behind the structure cannot be hit, so one of the first
/// dozen is enough.
fn names_a_gauge(page: &Value) {
    let picked = page["picked"].as_array().unwrap();
    let hit = |p: &Value| p[1].as_str().unwrap().starts_with(p[0].as_str().unwrap());
    assert!(picked.iter().any(hit), "{picked:?}");
}

/// Tests that the model states its size, has its views, and does not capture the wheel before a click.
fn has_a_model(page: &Value) {
    let size = page["size"].as_str().unwrap();
    assert!(
        size.contains(" triangles for ") && size.contains(" kB"),
        "{size}"
    );
    assert_eq!(
        page["views"],
        serde_json::json!(["3D", "front", "side", "top"])
    );
    let Some(wheel) = page["wheel"].as_object() else {
        return;
    };
    let number = |when: &str, what: &str| wheel[when][what].as_f64().unwrap();
    assert!(
        number("before", "scrolled") > 30.0 && number("before", "zoom") == 1.0,
        "{wheel:?}"
    );
    assert!(
        number("after", "scrolled") == 0.0 && number("after", "zoom") != 1.0,
        "{wheel:?}"
    );
}

/// Returns the output folder of a command on files of a folder of `examples/`.
fn folder_of(command: &str, folder: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("pages")
        .join(command)
        .join(folder)
}

/// Runs a command on files of a folder of `examples/`, and returns the path of its page.
fn page_of(command: &str, folder: &str, files: &[&str]) -> PathBuf {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let out = folder_of(command, folder);
    let _ = std::fs::remove_dir_all(&out);
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .arg(command)
        .args(files)
        .arg("--out")
        .arg(&out)
        .current_dir(examples.join(folder))
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(0), "{command} {files:?}\n{error}");
    out.join("report.html")
}

/// Largest size of a page without a model. Pages with a model of a few hundred elements have the same limit here.
const MOST_BYTES: f64 = 1e6;

#[test]
fn every_kind_of_page_opens_wide_and_on_a_phone_without_errors_requests_or_texts_over_each_other() {
    let [solved, placed] = [
        folder_of("solve", "frame").join("results.op2"),
        folder_of("place", "frame"),
    ]
    .map(|p| p.to_str().unwrap().to_owned());
    let pages = [
        ("check", "frame", &["place.toml"][..]),
        ("solve", "frame", &["place.toml"]),
        ("sensitivity", "frame", &["recover.toml"]),
        ("place", "frame", &["place.toml"]),
        ("recover", "frame", &["recover.toml"]),
        ("respond", "frame", &["respond.toml"]),
        ("payload", "frame", &["payload.toml"]),
        ("ballast", "frame", &["ballast.toml"]),
        ("study", "frame", &["study.toml"]),
        ("modes", "frame", &["place.toml"]),
        ("reconcile", "frame", &["reconcile.toml"]),
        ("reconcile", "quarter_truck", &["reconcile.toml"]),
        ("identify", "quarter_truck", &["identify.toml"]),
        ("calibrate", "bridge", &["calibrate.toml"]),
        ("calibrate", "onboard", &["calibrate.toml"]),
        (
            "fleet",
            "fleet",
            &["fleet.toml", "A_2026-05-01.csv", "B_2026-05-02.csv"],
        ),
        ("cases", "frame", &["place.toml"]),
        ("strains", "frame", &["frame.bdf", &solved]),
        ("verify", "frame", &[&placed]),
        ("init", "frame", &["frame.bdf"]),
    ];
    let reports: Vec<PathBuf> = pages.iter().map(|(c, d, f)| page_of(c, d, f)).collect();
    let paths: Vec<&Path> = reports.iter().map(PathBuf::as_path).collect();
    let Some(seen) = open_reports(&paths) else {
        return;
    };
    for (i, page) in seen.iter().enumerate() {
        let (command, folder, _) = pages[i / 2];
        is_sound(page, &[], &[]);
        // `verify` compares bytes and numbers. Its page has a table of its checks and no picture.
        answers_first(page, command != "verify");
        assert!(
            page["bytes"].as_f64().unwrap() < MOST_BYTES,
            "{command} {folder}: {}",
            page["bytes"]
        );
        let models = [
            "check", "solve", "place", "recover", "respond", "payload", "modes", "cases",
            "strains", "init",
        ];
        let drawn = page.get("size").is_some();
        assert!(drawn || !models.contains(&command), "{command}");
        if drawn {
            has_a_model(page);
        }
    }
}

/// Tests the page of the demo: one card per step, each with a visible picture and no terminal text, and true loads next
/// to their intervals.
#[test]
fn the_page_of_the_demo_has_a_picture_in_each_card_and_the_truth_next_to_the_intervals() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("demo");
    let _ = std::fs::remove_dir_all(&folder);
    let told = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .arg("demo")
        .arg(&folder)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&told.stderr);
    assert_eq!(told.status.code(), Some(0), "{error}");
    let Some(seen) = open_reports(&[&folder.join("report.html")]) else {
        return;
    };
    for page in &seen {
        is_sound(page, &["The truck", "Step by step"], &[]);
        assert_eq!(page["terminal"], 0);
        assert!(page["bytes"].as_f64().unwrap() < 1.2 * MOST_BYTES);
        let cards = page["cards"].as_array().unwrap();
        assert_eq!(cards.len(), 8);
        for card in cards {
            let [width, height] = [0, 1].map(|i| card["size"][i].as_f64().unwrap());
            assert!(width >= 200.0 && height >= 120.0, "{card}");
            let title = card["title"].as_str().unwrap();
            let words = card["words"].as_str().unwrap();
            assert!(
                !title.starts_with("Recover") || words.contains("true load"),
                "{title}: {words}"
            );
        }
    }
}

const SCENE: &str = "the model in three dimensions";

/// While the gauge name in a finding has the focus, every picture shows the gauge.
#[test]
fn a_finding_shows_the_gauge_that_it_names() {
    let dir = plate("shown");
    let runs = std::fs::read_to_string(dir.join("runs.csv")).unwrap();
    let (head, rows) = runs.split_once('\n').unwrap();
    let gauge = head.split(',').nth(1).unwrap();
    let reversed = rows.lines().map(|row| {
        let mut fields: Vec<String> = row.split(',').map(str::to_owned).collect();
        fields[1] = format!("{}", -fields[1].parse::<f64>().unwrap());
        fields.join(",")
    });
    let text = format!("{head}\n{}\n", reversed.collect::<Vec<_>>().join("\n"));
    std::fs::write(dir.join("reversed.csv"), text).unwrap();
    let found = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(["recover", &job(&dir, "reversed.toml", "reversed.csv")])
        .output()
        .unwrap();
    assert_eq!(found.status.code(), Some(1), "an error is found");
    let Some(pages) = open_reports(&[&dir.join("reversed.out/report.html")]) else {
        return;
    };
    for page in &pages {
        let shown = page["shown"].as_array().unwrap();
        let of_gauge = shown.iter().find(|s| s["name"] == gauge);
        let of_gauge = of_gauge.unwrap_or_else(|| panic!("{gauge}: {shown:?}"));
        let printed = of_gauge["said"].as_str().unwrap();
        assert!(printed.starts_with(&format!("{gauge}: ")), "{printed}");
        // One label of the first screen and one label of the model.
        assert_eq!(of_gauge["lit"], serde_json::json!([gauge, gauge]));
        assert_eq!(of_gauge["after"], serde_json::json!([]));
    }
}

#[test]
fn reports_open_without_errors_or_requests_show_their_figures_and_name_the_gauge_that_is_picked() {
    let dir = plate("pages");
    let plan = job(&dir, "plan.toml", "strain.csv");
    let text = std::fs::read_to_string(&plan).unwrap();
    let counted = text
        .replace("spacing = 5.0", "spacing = 5.0\ncurve = [4, 6, 8]")
        .replace("[gauges]\nfile = \"gauges.csv\"\n", "");
    std::fs::write(&plan, counted).unwrap();
    strainbridge(&["place", &plan]);
    strainbridge(&["recover", &job(&dir, "runs.toml", "runs.csv")]);
    strainbridge(&["recover", &job(&dir, "record.toml", "strain.csv")]);
    strainbridge(&["solve", &job(&dir, "solve.toml", "strain.csv")]);
    let reports =
        ["plan", "runs", "record", "solve"].map(|n| dir.join(format!("{n}.out/report.html")));
    let Some(pages) = open_reports(&reports.each_ref().map(|p| p.as_path())) else {
        return;
    };
    let kinds: [(&[&str], &[&str]); 4] = [
        (
            &[
                "Model and gauges",
                "How many gauges",
                "Gauges",
                "Sensitivity",
            ],
            &[
                SCENE,
                "efficiency and sigma against the number of gauges",
                "sensitivity as a heat map",
            ],
        ),
        (
            &[
                "Result",
                "Loads with 95 % intervals",
                "Measured against predicted strain",
            ],
            &[SCENE, "measured against predicted strain"],
        ),
        (
            &["Histories", "Sensitivity"],
            &[SCENE, "histories of loads"],
        ),
        (&["Loads and strain", "Balance"], &[SCENE]),
    ];
    for (i, page) in pages.iter().enumerate() {
        let (titles, figures) = kinds[i / 2];
        is_sound(page, titles, figures);
        answers_first(page, true);
        has_a_model(page);
        if i / 2 < 3 {
            names_a_gauge(page);
        }
    }
}
