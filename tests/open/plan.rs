//! A plan by calls alone, and the command that gives the same bytes.

use super::super::strainbridge;
use super::{Server, frame_job};
use serde_json::{Value, json};
use std::path::Path;

const NAMED: &str = "file = \"picked.toml\"\nangle_step_deg = 45\n";
const PICKS: &str = "[candidates]\nproperties = [1, 2]\n";

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

/// Runs `place` on a job and returns the folder of its output.
fn place(job: &Path, name: &str) -> std::path::PathBuf {
    let out = job.with_file_name(name);
    let arguments = [
        "place",
        job.to_str().unwrap(),
        "--no-cache",
        "--out",
        out.to_str().unwrap(),
    ];
    let run = strainbridge(&arguments);
    assert!(
        run.status.code() < Some(2),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    out
}

/// Rows of a table by the first seven fields: name, element, side, direction.
fn rows(table: &str) -> Vec<String> {
    let row = |l: &str| l.split(',').take(7).collect::<Vec<_>>().join(",");
    table.lines().skip(1).map(row).collect()
}

#[test]
fn a_plan_that_is_saved_gives_the_same_bytes_by_the_command() {
    let job = frame_job("open_plan", NAMED);
    let saved = job.with_file_name("gauges.csv");
    let server = Server::start(&job);
    let about = server.ask("/job", None);
    assert_eq!(
        (&about["count"], &about["picked"]["named"]),
        (&json!(12), &json!(true))
    );

    // All elements, then a narrower choice with fewer gauges: its candidates are rows of the first.
    let wide = server.ask("/place", Some(&json!({ "picks": PICKS })));
    assert_eq!(wide["names"].as_array().unwrap().len(), 12);
    assert!(
        wide["page"]
            .as_str()
            .unwrap()
            .contains("data-figure=\"scene\"")
    );
    let element = rows(wide["gauges"].as_str().unwrap())[0]
        .split(',')
        .nth(1)
        .unwrap()
        .to_owned();
    let picks = format!("{PICKS}exclude_elements = \"{element}\"\n\n[placement]\ngauges = 10\n");
    let narrow = server.ask("/place", Some(&json!({ "picks": picks })));
    let texts = json!({ "picks": picks, "gauges": narrow["gauges"] });
    let answer = server.ask("/save", Some(&texts));
    assert_eq!(answer["files"], json!(["picked.toml", "gauges.csv"]));
    assert_eq!(answer["faults"], Value::Null);
    assert_eq!(read(&job.with_file_name("picked.toml")), picks);

    let out = place(&job, "command");
    assert_eq!(read(&saved), read(&out.join("gauges.csv")));
    assert_eq!(rows(&read(&saved)).len(), 10);
    let report = server.ask("/report", Some(&json!({})));
    let written = Path::new(report["report"].as_str().unwrap())
        .parent()
        .unwrap();
    assert_eq!(written, job.with_file_name("job.out"));
    for file in [
        "gauges.csv",
        "report.html",
        "gluing_sheet.csv",
        "sensitivity.csv",
    ] {
        assert!(read(&out.join(file)) == read(&written.join(file)), "{file}");
    }
    // The page of the session is the page of the command.
    let page = read(&out.join("report.html"));
    assert!(page.contains(narrow["page"].as_str().unwrap()));
}

#[test]
fn gauges_that_stay_are_placed_around_by_session_and_command_alike() {
    let job = frame_job("open_keep", NAMED);
    let saved = job.with_file_name("gauges.csv");
    let server = Server::start(&job);
    let first = server.ask("/place", Some(&json!({ "picks": PICKS })));
    let answer = server.ask(
        "/save",
        Some(&json!({ "picks": PICKS, "gauges": first["gauges"] })),
    );
    let advice = answer["advice"].to_string();
    assert!(advice.contains("write [gauges] with file"), "{advice}");
    // A save without changes leaves no trace, and other files of the folder stay.
    let names = || {
        let all = std::fs::read_dir(job.parent().unwrap()).unwrap();
        let mut names: Vec<String> = all
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    assert_eq!(
        names(),
        ["frame.bdf", "gauges.csv", "job.toml", "picked.toml"]
    );

    // The user follows the advice: the session notices the change.
    std::fs::write(&job, read(&job) + "\n[gauges]\nfile = \"gauges.csv\"\n").unwrap();
    assert_eq!(server.ask("/alive", None)["changed"], json!(["job.toml"]));
    let (status, refused) = server.call(
        "/save",
        Some(&json!({ "picks": PICKS, "gauges": first["gauges"] })),
    );
    assert_eq!(
        (status, &refused["faults"][0]["file"]),
        (422, &json!("job.toml"))
    );
    let about = server.ask("/reload", Some(&json!({})));
    assert_eq!(about["gauges"]["text"], first["gauges"]);
    assert_eq!(server.ask("/alive", None)["changed"], json!([]));

    let picks = format!("{PICKS}\n[placement]\ngauges = 7\nkeep = [\"P02\", \"P05\", \"P09\"]\n");
    let kept = server.ask(
        "/place",
        Some(&json!({ "picks": picks, "gauges": first["gauges"] })),
    );
    let names: Vec<&str> = kept["names"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .collect();
    assert_eq!(
        names,
        [
            "P02", "P05", "P09", "P01", "P03", "P04", "P06", "P07", "P08", "P10"
        ]
    );
    server.ask(
        "/save",
        Some(&json!({ "picks": picks, "gauges": kept["gauges"] })),
    );
    let (all, rest) = (
        rows(&read(&saved)),
        rows(&read(&place(&job, "command").join("gauges.csv"))),
    );
    assert_eq!(all[3..], rest);
    let before = rows(first["gauges"].as_str().unwrap());
    assert_eq!(
        all[..3],
        [before[1].clone(), before[4].clone(), before[8].clone()]
    );
}

/// Numbers of the command: `installed` evaluates the table of the job.
#[test]
fn a_moved_gauge_changes_the_loads_as_the_command_states_for_the_saved_table() {
    let job = frame_job("open_move", NAMED);
    let server = Server::start(&job);
    let best = server.ask("/place", Some(&json!({ "picks": PICKS })));
    let gauges = best["gauges"].as_str().unwrap();
    let row: Vec<&str> = gauges.lines().nth(1).unwrap().split(',').collect();
    let number = |i: usize| row[i].parse::<f64>().unwrap();
    // By 37 mm along the frame.
    let moved = json!([{ "name": "P01", "at": [number(7) + 37.0, number(8), number(9)], "side": row[2], "along": [number(3), number(4), number(5)] }]);
    let texts = json!({ "picks": PICKS, "gauges": gauges, "moved": moved });
    let answer = server.ask("/move", Some(&texts));
    assert_ne!(answer["loads"], best["loads"]);
    assert!(answer["efficiency"].as_f64() < best["efficiency"].as_f64());
    // Another plan was placed since, and then undone: the bound is still that of this plan.
    let other = format!("{PICKS}\n[placement]\ngauges = 9\n");
    server.ask("/place", Some(&json!({ "picks": other })));
    let again = server.ask("/move", Some(&texts));
    assert_eq!(again["efficiency"], answer["efficiency"]);
    assert_eq!(again["loads"], answer["loads"]);
    server.ask(
        "/save",
        Some(&json!({ "picks": PICKS, "gauges": answer["gauges"] })),
    );

    std::fs::write(&job, read(&job) + "\n[gauges]\nfile = \"gauges.csv\"\n").unwrap();
    let result: Value =
        serde_json::from_str(&read(&place(&job, "command").join("result.json"))).unwrap();
    let installed = result["installed"]["load_sigma"].as_array().unwrap();
    for (l, own) in answer["loads"].as_array().unwrap().iter().zip(installed) {
        let (half, sigma) = (
            l["half"].as_f64().unwrap(),
            own["sigma_as_glued"].as_f64().unwrap(),
        );
        assert_eq!(l["name"], own["name"]);
        // Coordinates in text and rows in another order: rounding alone.
        assert!(
            (half / sigma / 1.959963984540054 - 1.0).abs() < 1e-9,
            "{l}: {own}"
        );
    }
}

#[test]
fn files_that_a_session_must_not_replace_stay() {
    let job = frame_job("open_spared", "properties = [1, 2]\nangle_step_deg = 45\n");
    let (picked, gauges) = (
        job.with_file_name("picked.toml"),
        job.with_file_name("gauges.csv"),
    );
    let server = Server::start(&job);
    let first = server.ask("/place", Some(&json!({ "picks": "" })));
    assert_eq!(first["names"].as_array().unwrap().len(), 12);
    drop(server);
    std::fs::write(&picked, "[candidates]\nelements = \"7\"\n").unwrap();
    std::fs::write(&gauges, "name,element\nG1,12\n").unwrap();
    let server = Server::start(&job);
    for body in [
        json!({ "picks": "[candidates]\nproperties = [1]\n" }),
        json!({ "picks": "", "gauges": first["gauges"] }),
        json!({ "picks": "[candidates]\ncolour = 1\n" }),
        json!({ "picks": "[measured]\nstrain = \"/etc/passwd\"\n" }),
    ] {
        let (status, value) = server.call("/save", Some(&body));
        assert_eq!(status, 422, "{value}");
    }
    assert_eq!(read(&picked), "[candidates]\nelements = \"7\"\n");
    assert_eq!(read(&gauges), "name,element\nG1,12\n");
}

#[test]
fn a_job_with_faults_is_listed_with_exit_code_2_and_prints_no_address() {
    let job = frame_job("open_faults", "properties = [1, 2]\ncolour = 3\n");
    let out = strainbridge(&["open", job.to_str().unwrap(), "--no-browser"]);
    assert_eq!(out.status.code(), Some(2));
    assert!(out.stdout.is_empty());
    assert!(String::from_utf8_lossy(&out.stderr).contains("colour"));
}

#[test]
fn a_layout_in_progress_is_cancelled_and_the_next_one_is_not() {
    let job = frame_job("open_cancel", NAMED);
    let server = Server::start(&job);
    let body = json!({ "picks": PICKS });
    let (status, value) = std::thread::scope(|scope| {
        let placing = scope.spawn(|| server.call("/place", Some(&body)));
        while !placing.is_finished() {
            server.ask("/cancel", Some(&json!({})));
        }
        placing.join().unwrap()
    });
    assert_eq!(
        (status, &value["faults"][0]["wrong"]),
        (422, &json!("stopped"))
    );
    assert_eq!(server.call("/place", Some(&body)).0, 200);
}
