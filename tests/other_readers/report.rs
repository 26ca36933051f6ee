//! `report.html` in a real browser: Chromium, headless, wide and at the width of a phone.

use crate::exchange::{job, plate, strainbridge};
use crate::python::read_by;
use serde_json::Value;
use std::path::Path;

/// Opens reports and gives what was seen by file and width; `None` without Chromium.
fn opened(reports: &[&Path]) -> Option<Vec<Value>> {
    let paths: Vec<&str> = reports.iter().map(|p| p.to_str().unwrap()).collect();
    let seen = read_by("open_report.py", &paths)?;
    let by_width = |p: &&str| ["1280", "390"].map(|w| seen[*p][w].clone());
    Some(paths.iter().flat_map(by_width).collect())
}

/// What holds of every report.
fn is_sound(page: &Value, titles: &[&str], figures: &[&str]) {
    assert_eq!(page["errors"], serde_json::json!([]));
    assert_eq!(page["requests"], serde_json::json!([]));
    // Nothing stands out to the side, so a phone needs no scrolling there.
    assert_eq!(page["wider"], 0);
    let list = page["titles"].as_array().unwrap();
    assert_eq!(list[0], "Findings");
    for title in titles {
        assert!(list.iter().any(|t| t == title), "{title} of {list:?}");
    }
    let drawn = page["figures"].as_array().unwrap();
    for label in figures {
        assert!(drawn.iter().any(|f| f["label"] == *label), "{label}");
    }
    for figure in drawn {
        // An empty picture has one colour; thin lines on white cover about a hundredth.
        assert!(figure["other"].as_f64().unwrap() > 0.005, "{figure}");
        assert!(figure["colours"].as_u64().unwrap() > 20, "{figure}");
    }
}

/// A gauge that is pointed at says its name. Those behind the structure can't be hit: one of the first dozen will do.
fn names_a_gauge(page: &Value) {
    let picked = page["picked"].as_array().unwrap();
    let hit = |p: &Value| p[1].as_str().unwrap().starts_with(p[0].as_str().unwrap());
    assert!(picked.iter().any(hit), "{picked:?}");
}

const SCENE: &str = "the model in three dimensions";

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
    let Some(pages) = opened(&reports.each_ref().map(|p| p.as_path())) else {
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
        if i / 2 < 3 {
            names_a_gauge(page);
        }
    }
}
