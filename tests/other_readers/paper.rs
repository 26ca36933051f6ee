//! Reads `report.pdf` with pypdf and draws it with PDFium. The report must contain everything that a signature needs.

use crate::exchange::{job, plate, strainbridge};
use crate::python::read_by;
use crate::support;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Title with characters that a template language, JSON or HTML could misread.
const TITLE: &str = "Plate #panic(1) *b* $x$ _u_ <a> `c` @ref [r] {s} // & µε \u{4e2d} \u{202e}";
/// The title on paper. No font here has the last character but one, and the last one would change the reading
/// direction.
const SHOWN: &str = "Plate #panic(1) *b* $x$ _u_ <a> `c` @ref [r] {s} // & µε [U+4E2D] [U+202E]";

/// Writes the job of `plate` as `name` with this title.
fn write_titled_job(dir: &Path, name: &str) -> PathBuf {
    let path = PathBuf::from(job(dir, name, "strain.csv"));
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, text.replace("Folded plate", TITLE)).unwrap();
    path
}

/// Writes a job for forces at the corners of the plate. The names of its runs have special characters too.
fn on_four_wheels(dir: &Path) -> String {
    let runs = "run,W1.FZ,W3.FZ,W13.FZ,W15.FZ\nR#1 *b* <i>,13.1,13.2,13.05,13.15\n\"a, b $\",26.1,26.2,26.05,26.15\n";
    std::fs::write(dir.join("wheels.csv"), runs).unwrap();
    let mut text = format!(
        "title = '{TITLE}'\nunits = \"mm-t-s\"\n[model]\ndeck = \"model.bdf\"\nmesh_error = false\n"
    );
    for grid in [1, 3, 13, 15] {
        text += &format!(
            "[[load]]\nname = \"W{grid}.FZ\"\ngrid = {grid}\ncomponent = \"FZ\"\nexpected = 50.0\n"
        );
    }
    text + "[runs]\nfile = \"wheels.csv\"\nunits = { force = \"N\" }\nnoise = { force = 0.05 }\nwheel_forces = \"measured\"\n\
            [payload]\ngrid = 8\nposition = \"known\"\nuse = [\"reactions\"]\n"
}

/// Returns the content of `report.pdf` of completed jobs, or `None` with a message if Python is missing.
fn read(jobs: &[&Path]) -> Option<Vec<Value>> {
    let reports: Vec<PathBuf> = jobs
        .iter()
        .map(|j| j.with_extension("out").join("report.pdf"))
        .collect();
    let paths: Vec<&str> = reports.iter().map(|p| p.to_str().unwrap()).collect();
    let seen = read_by("read_paper.py", &paths)?;
    Some(paths.iter().map(|p| seen[*p].clone()).collect())
}

/// Returns the text without spaces and line breaks, as the position of line breaks does not matter.
fn remove_whitespace(text: &str) -> String {
    let kept = |c: &char| !c.is_whitespace() && *c != '\u{200b}';
    text.chars().filter(kept).collect()
}

/// Returns the text of all pages without white space.
fn text_of(paper: &Value) -> String {
    let pages = paper["pages"].as_array().unwrap();
    let all: Vec<&str> = pages.iter().filter_map(|p| p["text"].as_str()).collect();
    remove_whitespace(&all.join(" "))
}

/// Tests the properties of every report: A4, no blank page, page numbers, program, units, hashes, and findings as in
/// `result.json`.
fn is_sound(paper: &Value, result: &Value, words: &[&str]) {
    let text = text_of(paper);
    let pages = paper["pages"].as_array().unwrap();
    assert!(!pages.is_empty());
    for (i, page) in pages.iter().enumerate() {
        let mut size = [0, 1].map(|k| page["size"][k].as_f64().unwrap());
        size.sort_by(f64::total_cmp);
        // A4 in points, portrait or landscape.
        assert!((size[0] - 595.28).abs() < 0.1 && (size[1] - 841.89).abs() < 0.1);
        // Header and footer alone cover less than half a percent.
        assert!(page["inked"].as_f64().unwrap() > 0.01, "page {i}");
        let number = format!("page {} of {}", i + 1, pages.len());
        assert!(
            remove_whitespace(page["text"].as_str().unwrap()).contains(&remove_whitespace(&number)),
            "{number}"
        );
    }
    let version = result["version"].as_str().unwrap();
    let made = format!(
        "strainbridge {version}, command {}",
        result["command"].as_str().unwrap()
    );
    let units = result["units"].as_object().unwrap();
    let stated = units
        .iter()
        .filter(|(q, _)| *q != "system")
        .map(|(q, u)| format!("{q} {}", u.as_str().unwrap()));
    let inputs = result["inputs"].as_array().unwrap();
    assert!(!inputs.is_empty());
    let hashes = inputs
        .iter()
        .map(|i| i["sha256"].as_str().unwrap().to_owned());
    let findings = result["findings"].as_array().unwrap();
    let messages = findings
        .iter()
        .map(|f| f["message"].as_str().unwrap().to_owned());
    let words = words.iter().map(|w| (*w).to_owned());
    for word in std::iter::once(made)
        .chain(stated)
        .chain(hashes)
        .chain(messages)
        .chain(words)
    {
        assert!(
            text.contains(&remove_whitespace(&word)),
            "`{word}` is not in:\n{text}"
        );
    }
}

/// Formats a value of `result.json` with one decimal, as the plan shows places and angles.
fn format_tenths(v: &Value) -> String {
    format!("{:.1}", v.as_f64().unwrap())
}

#[test]
fn plan_and_payload_on_paper_state_inputs_units_and_the_numbers_of_result_json_and_can_be_signed() {
    let dir = plate("paper");
    let plan = write_titled_job(&dir, "plan.toml");
    let placed = strainbridge(&["place", plan.to_str().unwrap()]);
    let weighed = dir.join("payload.toml");
    std::fs::write(&weighed, on_four_wheels(&dir)).unwrap();
    let weights = strainbridge(&["payload", weighed.to_str().unwrap()]);
    // Equal inputs give an equal file with another name.
    let bytes = std::fs::read(plan.with_extension("out").join("report.pdf")).unwrap();
    strainbridge(&[
        "place",
        plan.to_str().unwrap(),
        "--out",
        dir.join("again").to_str().unwrap(),
    ]);
    assert!(bytes.starts_with(b"%PDF"));
    assert!(bytes == std::fs::read(dir.join("again/report.pdf")).unwrap());
    let Some(papers) = read(&[&plan, &weighed]) else {
        return;
    };
    for paper in &papers {
        let title = paper["title"].as_str().unwrap();
        assert_eq!(title, SHOWN.trim());
    }
    let signed = ["Made by", "Checked by", "Name", "Date", "Signature"];
    let mut rows = vec!["Gluing sheet".to_owned(), SHOWN.to_owned()];
    assert!(!placed["gauges"].as_array().unwrap().is_empty());
    for g in placed["gauges"].as_array().unwrap() {
        let [x, y, z] = [0, 1, 2].map(|k| format_tenths(&g["position"][k]));
        let (name, side) = (g["name"].as_str().unwrap(), g["surface"].as_str().unwrap());
        rows.push(format!("{name} {} {side} {x} {y} {z}", g["element"]));
    }
    let words: Vec<&str> = rows.iter().map(String::as_str).chain(signed).collect();
    is_sound(&papers[0], &placed, &words);
    // The forces at the corners give the sum. As they are equal, the payload is in the middle.
    let runs = weights["payload"].as_array().unwrap();
    let mut rows = vec![SHOWN.to_owned()];
    for (r, force) in runs.iter().zip(["52.50", "104.5"]) {
        let given: f64 = force.parse().unwrap();
        assert!((r["force"].as_f64().unwrap() - given).abs() < 0.05);
        rows.push(format!("{} {force}", r["run"].as_str().unwrap()));
    }
    assert_eq!(rows.len(), 3);
    let words: Vec<&str> = rows.iter().map(String::as_str).chain(signed).collect();
    is_sound(&papers[1], &weights, &words);
}

#[test]
fn a_reconciliation_on_paper_holds_the_verdict_its_effects_and_what_else_would_explain_them() {
    let Some(shared) = support::find_shared_path("hidden_effects") else {
        return;
    };
    let dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("paper_gap");
    let _ = std::fs::remove_dir_all(&dir);
    let mut jobs = Vec::new();
    for case in ["static/dev-s3", "dynamics/dev-d2"] {
        let files = std::fs::read_dir(shared.join(case)).unwrap();
        let own = dir.join(case);
        std::fs::create_dir_all(&own).unwrap();
        for file in files.flatten() {
            std::fs::write(
                own.join(file.file_name()),
                std::fs::read(file.path()).unwrap(),
            )
            .unwrap();
        }
        jobs.push(own.join("job.toml"));
    }
    let results: Vec<Value> = jobs
        .iter()
        .map(|j| strainbridge(&["reconcile", j.to_str().unwrap()]))
        .collect();
    let paths: Vec<&Path> = jobs.iter().map(PathBuf::as_path).collect();
    let Some(papers) = read(&paths) else {
        return;
    };
    assert_eq!(papers.len(), results.len());
    for (paper, result) in papers.iter().zip(&results) {
        let mut words = vec![result["verdict"].as_str().unwrap()];
        words.push(result["next_measurement"].as_str().unwrap());
        words.extend(
            result["named"]
                .as_array()
                .unwrap()
                .iter()
                .filter_map(Value::as_str),
        );
        let rivals = result["rivals"].as_array().unwrap();
        words.extend(rivals.iter().filter_map(|r| r["id"].as_str()));
        is_sound(paper, result, &words);
    }
}
