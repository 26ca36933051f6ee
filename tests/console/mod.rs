//! Console output of a command fits a terminal, and its summary equals that of `result.json` and of the page.

mod fits;

pub use fits::assert_fits;

use fits::text;
use serde_json::Value;
use std::path::Path;
use std::process::Output;

/// Returns a text without line breaks, with signs as in a UTF-8 terminal.
fn on_one_line(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").replace("+-", "±")
}

/// Fails unless the console and the page contain the summary of `result.json`.
pub fn assert_states_summary(done: &Output, folder: &Path, command: &str) {
    let file = std::fs::read_to_string(folder.join("result.json")).unwrap();
    let result: Value = serde_json::from_str(&file).unwrap();
    let summary = on_one_line(result["summary"].as_str().unwrap());
    assert!(summary.ends_with('.'), "{command}: {summary}");
    let printed = text(&done.stdout);
    assert!(
        on_one_line(&printed).contains(&summary),
        "{command}: {summary}\n{printed}"
    );
    if let Ok(page) = std::fs::read_to_string(folder.join("report.html")) {
        let escaped = summary
            .replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('>', "&gt;");
        assert!(
            page.replace("+-", "±").contains(&escaped),
            "{command}: {summary}"
        );
    }
    let of_error = |f: &Value| f["severity"] == "error";
    let is_error = result["findings"].as_array().unwrap().iter().any(of_error);
    assert_eq!(is_error, summary.contains("is not reliable"), "{summary}");
}
