//! The guide in `docs/`. Every command in a `sh` box runs, in order, in one folder. Afterwards, the files that a page
//! names must exist.

#[path = "console/fits.rs"]
mod console;
#[path = "../nastran/tests/support/mod.rs"]
mod support;

use std::path::{Path, PathBuf};
use std::process::Command;

/// Returns the guides: the pages whose names begin with a digit, in order.
fn pages() -> Vec<(String, String)> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let mut pages: Vec<PathBuf> = std::fs::read_dir(docs)
        .unwrap()
        .flatten()
        .map(|e| e.path())
        .filter(|p| {
            let name = p.file_name().unwrap_or_default().to_string_lossy();
            name.ends_with(".md") && name.starts_with(|c: char| c.is_ascii_digit())
        })
        .collect();
    pages.sort();
    pages
        .iter()
        .map(|p| {
            let name = p.file_name().unwrap().to_string_lossy().into_owned();
            (name, std::fs::read_to_string(p).unwrap())
        })
        .collect()
}

/// Returns the content of the boxes of one kind.
fn boxes(page: &str, kind: &str) -> Vec<String> {
    let fence = format!("```{kind}");
    let mut out = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if line == fence {
            let inside = lines.by_ref().take_while(|l| *l != "```");
            out.push(inside.map(|l| format!("{l}\n")).collect());
        }
    }
    out
}

/// Runs one line. The expected exit code is stated in its comment (`# exit code 1`), otherwise 0.
fn run(line: &str, folder: &Path) {
    let (command, comment) = line.split_once(" #").unwrap_or((line, ""));
    let (command, target) = command.split_once(" > ").unwrap_or((command, ""));
    let mut words = command.split_whitespace();
    assert_eq!(words.next(), Some("strainbridge"), "{line}");
    let done = Command::new(env!("CARGO_BIN_EXE_strainbridge"))
        .args(words)
        .current_dir(folder)
        .output()
        .unwrap();
    let expected = comment
        .split_once("exit code ")
        .map_or(0, |(_, n)| n.trim().parse().unwrap());
    let error = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(expected), "{line}\n{error}");
    if expected < 2
        && !["--json", "--list", "--verbose", " schema"]
            .iter()
            .any(|o| line.contains(o))
    {
        console::assert_fits(&done, line);
    }
    if !target.trim().is_empty() {
        std::fs::write(folder.join(target.trim()), &done.stdout).unwrap();
    }
}

/// Copies a folder of `examples/` into the folder of the commands.
fn copy_example(name: &str, folder: &Path) {
    let from = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name);
    let to = folder.join(name);
    std::fs::create_dir_all(&to).unwrap();
    for file in std::fs::read_dir(from).unwrap().flatten() {
        std::fs::copy(file.path(), to.join(file.file_name())).unwrap();
    }
}

/// Returns paths in backticks that contain a folder and end in a file.
fn named_files(page: &str) -> Vec<&str> {
    let spans = page.split('`').skip(1).step_by(2);
    spans
        .filter(|s| {
            s.contains('/')
                && !s.contains(' ')
                && s.rsplit('/').next().is_some_and(|f| f.contains('.'))
        })
        .collect()
}

#[test]
fn every_command_of_the_guide_works_and_the_files_it_names_are_written() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("guide");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let pages = pages();
    assert_eq!(pages.len(), 7);
    for example in ["bridge", "onboard"] {
        copy_example(example, &folder);
    }
    for (name, page) in &pages {
        let commands = boxes(page, "sh").concat();
        assert!(!commands.is_empty(), "{name}");
        commands.lines().for_each(|line| run(line, &folder));
        for file in named_files(page) {
            assert!(folder.join(file).exists(), "{name}: `{file}` is not there");
        }
        for toml in boxes(page, "toml") {
            assert!(toml.parse::<toml::Table>().is_ok(), "{name}: {toml}");
        }
    }
    check_documented(&folder);
}

#[test]
fn an_export_comes_to_a_gauge_plan_in_three_commands_and_three_edited_lines() {
    let Some(export) = support::find_shared_path("nastran/mystran_frame_units") else {
        return;
    };
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("first-hour");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    for file in ["frame.bdf", "frame.op2"] {
        std::fs::copy(export.join(file), folder.join(file)).unwrap();
    }
    let (_, page) = pages().swap_remove(1);
    let edits = boxes(&page, "toml edit").concat();
    assert_eq!(edits.lines().count(), 3, "{page}");
    run("strainbridge check frame.bdf frame.op2", &folder);
    run("strainbridge init frame.bdf frame.op2", &folder);
    edit(&folder.join("job.toml"), &edits);
    run("strainbridge place job.toml", &folder);
    let text = std::fs::read_to_string(folder.join("job.out/result.json")).unwrap();
    let plan: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(plan["gauges"].as_array().unwrap().len(), 60);
    // The page about placement states this figure.
    assert!(plan["efficiency_bound"].as_f64().unwrap() > 0.969);
    let findings = plan["findings"].as_array().unwrap();
    let of = |code: &str| findings.iter().find(|f| f["code"] == code);
    assert!(of("loads-weakly-separable").is_some());
    // The tolerance is stated, so the remedy does not ask for it.
    let remedy = of("position-budget-small").unwrap()["remedy"].as_str();
    assert!(remedy.unwrap().starts_with("Place more gauges"));
    let sigma = &plan["load_sigma"][0];
    assert!(sigma["sigma_as_glued"].as_f64() > sigma["sigma"].as_f64());
}

/// Replaces the line of the job with the same key by each line. A new key goes to the beginning of `[placement]`.
fn edit(job: &Path, lines: &str) {
    let text = std::fs::read_to_string(job).unwrap();
    let mut text: Vec<&str> = text.lines().collect();
    let section = text.iter().position(|l| l.starts_with("[placement]"));
    let section = section.unwrap();
    for line in lines.lines() {
        let (key, _) = line.split_once('=').unwrap();
        match text.iter().skip(section).position(|l| l.starts_with(key)) {
            Some(k) => text[section + k] = line,
            None => text.insert(section + 1, line),
        }
    }
    std::fs::write(job, text.join("\n")).unwrap();
}

/// Returns whether `path` matches a documented field. `*` stands for any name, and at the end for everything below.
fn is_field(pattern: &str, path: &str) -> bool {
    let (mut a, mut b) = (pattern.split('.').peekable(), path.split('.'));
    while let Some(p) = a.next() {
        match (p, b.next()) {
            (_, None) => return false,
            ("*", Some(_)) if a.peek().is_none() => return true,
            ("*", Some(_)) => {}
            (p, Some(name)) if p == name => {}
            _ => return false,
        }
    }
    b.next().is_none()
}

/// Collects the fields of a value, including those in lists. Values below a name of the job are omitted, because such
/// names may contain dots.
fn fields_of(value: &serde_json::Value, path: &str, out: &mut std::collections::BTreeSet<String>) {
    match value {
        serde_json::Value::Object(map) => {
            for (name, below) in map {
                let path = format!(
                    "{path}{}{}",
                    if path.is_empty() { "" } else { "." },
                    name.replace('.', "_")
                );
                fields_of(below, &path, out);
                out.insert(path);
            }
        }
        serde_json::Value::Array(list) => list.iter().for_each(|v| fields_of(v, path, out)),
        _ => {}
    }
}

/// Fails unless the reference contains every field and every column that the commands of the guide wrote.
fn check_documented(folder: &Path) {
    use strainbridge::report::reference::{columns, fields};
    let mut seen = 0;
    let mut missing = std::collections::BTreeSet::new();
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            documented_in(&path, &mut seen, &mut missing, &fields(), &columns());
            for inner in std::fs::read_dir(&path)
                .unwrap()
                .flatten()
                .filter(|e| e.path().is_dir())
            {
                documented_in(
                    &inner.path(),
                    &mut seen,
                    &mut missing,
                    &fields(),
                    &columns(),
                );
            }
        }
    }
    assert!(seen >= 10, "{seen} results");
    assert!(
        missing.is_empty(),
        "not in src/report/reference: {missing:#?}"
    );
}

fn documented_in(
    folder: &Path,
    seen: &mut usize,
    missing: &mut std::collections::BTreeSet<String>,
    fields: &[[&str; 4]],
    columns: &[[&str; 5]],
) {
    let Ok(text) = std::fs::read_to_string(folder.join("result.json")) else {
        return;
    };
    *seen += 1;
    let result: serde_json::Value = serde_json::from_str(&text).unwrap();
    let command = result["command"].as_str().unwrap();
    let mut found = std::collections::BTreeSet::new();
    fields_of(&result, "", &mut found);
    for finding in result["findings"].as_array().unwrap() {
        let code = finding["code"].as_str().unwrap();
        let entry = strainbridge::explain(code).unwrap_or_else(|f| panic!("{f}"));
        let severity = serde_json::to_value(&entry.severity).unwrap();
        assert!(
            severity.as_array().unwrap().contains(&finding["severity"]),
            "{code}: {}",
            finding["severity"]
        );
    }
    let known = |path: &str| {
        fields
            .iter()
            .any(|f| [command, "*"].contains(&f[0]) && is_field(f[1], path))
    };
    missing.extend(
        found
            .iter()
            .filter(|p| !known(p))
            .map(|p| format!("{command}: {p}")),
    );
    for file in std::fs::read_dir(folder).unwrap().flatten() {
        let name = file.file_name().to_string_lossy().into_owned();
        if !name.ends_with(".csv") {
            continue;
        }
        // `reconcile` and `demo` also write inputs of jobs, in the format of such inputs.
        let known = columns.iter().any(|c| c[0] == command && c[1] == name);
        if !known && ["reconcile", "demo"].contains(&command) {
            continue;
        }
        let header = std::fs::read_to_string(file.path()).unwrap();
        let stated = &result["tables"][&name];
        for column in header.lines().next().unwrap().split(',') {
            let column = column.trim_matches('"');
            if stated.get(column).is_none() {
                missing.insert(format!(
                    "{command}: {name}: `{column}` without a unit in `tables`"
                ));
            }
            let of_file = columns.iter().filter(|c| c[0] == command && c[1] == name);
            let named = |pattern: &str| match (pattern.split_once('<'), pattern.split_once('>')) {
                (Some((start, _)), Some((_, end))) => {
                    column.starts_with(start) && column.ends_with(end)
                }
                _ => pattern == column,
            };
            if !of_file.clone().any(|c| named(c[2])) {
                missing.insert(format!("{command}: {name}: {column}"));
            }
        }
    }
}
