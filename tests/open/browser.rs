//! The live page in Chromium: marks, a drag, the slider, gauges that stay, undo, save, a changed job, a server that ends.

use super::{Server, frame_job};
use crate::support::skip;
use serde_json::{Value, json};
use std::process::Command;

#[test]
fn a_plan_is_made_in_a_browser_and_its_lines_outlive_the_server() {
    let job = frame_job(
        "open_browser",
        "file = \"picked.toml\"\nangle_step_deg = 45\n",
    );
    let server = Server::start(&job);
    let address = format!("http://127.0.0.1:{}/#{}", server.port, server.token);
    let python = std::env::var("STRAINBRIDGE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = format!("{}/tests/python/live_page.py", env!("CARGO_MANIFEST_DIR"));
    let run = Command::new(python)
        .args([&script, &address, job.to_str().unwrap()])
        .arg(server.pid().to_string())
        .output();
    let Ok(run) = run else {
        return skip("no Python here");
    };
    let text = String::from_utf8_lossy(&run.stdout);
    if run.status.code() == Some(77) {
        return skip(text.trim());
    }
    let error = String::from_utf8_lossy(&run.stderr);
    let line = text.lines().rfind(|l| l.starts_with('{'));
    let saw: Value =
        serde_json::from_str(line.unwrap_or_else(|| panic!("{text}\n{error}"))).unwrap();

    assert_eq!(
        (&saw["errors"], &saw["elsewhere"]),
        (&json!([]), &json!([])),
        "{saw}"
    );
    assert_eq!(saw["axe"], json!([]), "serious faults of axe");
    assert_eq!(
        saw["wide"],
        json!(false),
        "at 390 px nothing is wider than the window"
    );
    let names = |key: &str| saw[key].as_array().unwrap().len();
    assert_eq!(
        (
            names("first"),
            names("slider"),
            names("rest"),
            names("undone")
        ),
        (12, 10, 10, 10)
    );
    assert!(saw["stale"].as_str().unwrap().contains("place again"));
    // No gauge is on a property that was forbidden.
    assert_eq!(saw["forbidden_left"], json!(0));
    // A drag changes the intervals, undo of the picture takes it back.
    assert_ne!(saw["dragged"], saw["before_drag"]);
    assert_eq!(saw["drag_undone"], saw["before_drag"]);
    // By keyboard: a visible focus on each control, a gauge that moves and returns.
    assert_eq!(saw["focus"], json!([true, true, true]));
    assert!(saw["chosen"].as_str().unwrap().contains("is chosen"));
    assert!(saw["stepped"].as_str().unwrap().contains("moved to"));
    // Marks without a layout are not saved, and a plan that is undone has its own lists.
    assert_eq!(saw["save_while_marks_wait"], json!(false));
    let undone = saw["picks_after_undo"].as_str().unwrap();
    assert!(undone.contains("exclude_properties = [3]"), "{undone}");
    assert_eq!(saw["save_of_saved"], json!(false));
    assert_eq!(saw["cancelled"][0], json!(200));
    assert_eq!(saw["cancelled"][2], json!(true));
    assert!(
        saw["cancelled"][1]
            .as_str()
            .unwrap()
            .contains("the plan as it was")
    );
    // Gauges that stay are the first of the layout.
    assert_eq!(saw["rest"][0], saw["kept"][0]);
    assert_eq!(saw["rest"][1], saw["kept"][1]);
    let file = |name: &str| std::fs::read_to_string(job.with_file_name(name)).unwrap();
    assert_eq!(saw["changed"], json!("job.toml changed on disk. "));
    let lost = saw["lost"].as_str().unwrap();
    assert!(
        lost.contains(file("picked.toml").trim()) && lost.contains(file("gauges.csv").trim()),
        "{lost}"
    );
    assert!(
        file("picked.toml").contains("exclude_properties = [3]"),
        "{}",
        file("picked.toml")
    );
}
