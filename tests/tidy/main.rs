//! Rules of the repository as tests: layers, printing, file access, unsafe code, README files, and dependencies of the
//! library.

mod declared_words;
mod dependencies;
mod doc_comments;
mod english;
mod imports;
mod size;
mod strings;
mod words;

use std::path::{Path, PathBuf};

/// Row of each module of the root crate. Imports go strictly downward.
///
/// `finding` and `linalg` are below all others of row 1, because estimates carry findings and series use linear
/// algebra. `units` is between them, because columns of series state units.
const ROWS: [(&str, f64); 28] = [
    ("cli", 10.0),
    ("open", 9.5),
    ("report", 9.0),
    ("workflow", 8.0),
    ("measured", 7.8),
    ("strain_chain", 7.7),
    ("job", 7.6),
    ("host", 7.5),
    ("reconcile", 7.0),
    ("calibrate", 7.0),
    ("study", 7.0),
    ("payload", 7.0),
    ("placement", 6.0),
    ("recovery", 6.0),
    ("respond", 6.0),
    ("vehicle", 6.0),
    ("sensitivity", 5.0),
    ("gauge", 4.0),
    ("fe", 3.0),
    ("model", 2.0),
    ("units", 0.7),
    ("series", 1.0),
    ("estimate", 0.6),
    ("input_faults", 1.0),
    ("linalg", 0.5),
    ("finding", 0.5),
    ("stop", 0.5),
    ("lib", 11.0),
];

/// Linear algebra crates. Only `linalg` may name them.
const LINEAR_ALGEBRA: [&str; 4] = ["faer", "nalgebra", "feral_metis", "levenberg_marquardt"];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn rust_files(folder: &Path, out: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for path in entries.flatten().map(|e| e.path()) {
        if path.is_dir() {
            rust_files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// Returns the source files of both crates: path from the root with `/`, and lines of code without comments.
fn sources() -> Vec<(String, Vec<String>)> {
    let mut files = Vec::new();
    rust_files(&root().join("src"), &mut files);
    rust_files(&root().join("nastran/src"), &mut files);
    files.sort();
    let name = |p: &Path| {
        p.strip_prefix(root())
            .unwrap()
            .to_string_lossy()
            .replace('\\', "/")
    };
    let code = |p: &Path| {
        let text = std::fs::read_to_string(p).unwrap();
        text.lines()
            .map(|l| l.split("//").next().unwrap_or("").to_owned())
            .collect()
    };
    files.iter().map(|p| (name(p), code(p))).collect()
}

fn is_test(path: &str) -> bool {
    path.ends_with("/tests.rs") || path.contains("/tests/")
}

/// Returns the module of the root crate that contains a file.
fn module(path: &str) -> Option<&str> {
    let rest = path.strip_prefix("src/")?;
    let first = rest.split('/').next()?;
    Some(first.strip_suffix(".rs").unwrap_or(first))
}

fn row(module: &str) -> Option<f64> {
    ROWS.iter().find(|r| r.0 == module).map(|r| r.1)
}

#[test]
fn imports_go_strictly_downward() {
    let mut wrong = String::new();
    for (path, lines) in sources() {
        let Some(own) = module(&path).filter(|m| *m != "main" && *m != "lib") else {
            continue;
        };
        let Some(own_row) = row(own) else {
            wrong.push_str(&format!(
                "{path}: module `{own}` has no row in tests/tidy.rs\n"
            ));
            continue;
        };
        for (n, line) in lines.iter().enumerate() {
            for part in line.split("crate::").skip(1) {
                let names = part
                    .strip_prefix('{')
                    .map_or(vec![part], |list| list.split(',').collect());
                for name in names {
                    let name: String = name
                        .trim()
                        .chars()
                        .take_while(|c| c.is_alphanumeric() || *c == '_')
                        .collect();
                    let Some(other) = row(&name) else { continue };
                    let vehicle = own == "vehicle" && other > 1.0 && !is_test(&path);
                    if name != own && (other >= own_row || vehicle) {
                        wrong.push_str(&format!("{path}:{}: `{own}` imports `{name}`\n", n + 1));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "imports must go to lower rows:\n{wrong}");
}

#[test]
fn linear_algebra_crates_are_named_in_linalg_alone() {
    let mut wrong = String::new();
    for (path, lines) in sources() {
        if is_test(&path) || module(&path) == Some("linalg") {
            continue;
        }
        for (n, line) in lines.iter().enumerate() {
            for name in LINEAR_ALGEBRA {
                if line.contains(&format!("{name}::")) {
                    wrong.push_str(&format!("{path}:{}: `{name}`\n", n + 1));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "take these from crate::linalg:\n{wrong}");
}

#[test]
fn only_the_command_line_prints_and_touches_files() {
    let forbidden = [
        "println!",
        "print!(",
        "eprint",
        "dbg!",
        "std::fs",
        "File::open",
        "std::env::var",
        "std::process",
    ];
    let mut wrong = String::new();
    for (path, lines) in sources() {
        if is_test(&path)
            || matches!(
                module(&path),
                Some("cli" | "workflow" | "host" | "job" | "measured" | "strain_chain")
            )
            || path == "src/main.rs"
        {
            continue;
        }
        for (n, line) in lines.iter().enumerate() {
            if let Some(word) = forbidden.iter().find(|w| line.contains(**w)) {
                wrong.push_str(&format!("{path}:{}: `{word}`\n", n + 1));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "input and output belong in src/cli:\n{wrong}"
    );
}

#[test]
fn stops_of_the_walk_in_the_architecture_page_exist() {
    let page = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let stops: Vec<(&str, &str)> = (page.lines())
        .filter_map(|l| l.strip_prefix("| `")?.split_once('`')?.0.split_once("::"))
        .collect();
    assert!((20..=40).contains(&stops.len()), "{stops:?}");
    let missing: Vec<_> = (stops.iter())
        .filter(|(file, name)| {
            let text = std::fs::read_to_string(root().join("src").join(file)).unwrap_or_default();
            !text.contains(&format!("fn {name}(")) && !text.contains(&format!("fn {name}<"))
        })
        .collect();
    assert!(missing.is_empty(), "not there any more: {missing:?}");
}

#[test]
fn nothing_is_unsafe() {
    let places: Vec<String> = sources()
        .into_iter()
        .filter(|(_, lines)| lines.iter().any(|l| l.contains("allow(unsafe_code)")))
        .map(|(path, _)| path)
        .collect();
    assert_eq!(places, [""; 0]);
}

#[test]
fn no_test_is_ignored() {
    let mut files = Vec::new();
    for folder in ["src", "nastran/src", "tests", "nastran/tests"] {
        rust_files(&root().join(folder), &mut files);
    }
    let mark = concat!("#[", "ignore");
    for path in files {
        assert!(
            !std::fs::read_to_string(&path).unwrap().contains(mark),
            "{}",
            path.display()
        );
    }
}

#[test]
fn main_is_a_summary_and_every_model_says_what_it_proves() {
    let main = std::fs::read_to_string(root().join("src/main.rs")).unwrap();
    assert!(main.lines().count() < 60);
    for entry in std::fs::read_dir(root().join("models"))
        .into_iter()
        .flatten()
        .flatten()
    {
        if entry.path().is_dir() {
            assert!(
                entry.path().join("README.md").is_file(),
                "{} has no README.md",
                entry.path().display()
            );
        }
    }
}

/// Known circles of imports. The list may only shrink.
const CIRCLES: &[&str] = &[];

#[test]
fn no_circle_of_imports() {
    let all = sources();
    let mut found = Vec::new();
    for root in ["src/", "nastran/src/"] {
        let files = all
            .iter()
            .filter(|f| f.0.starts_with(root) && !is_test(&f.0));
        let files = files.map(|(path, lines)| (path.as_str(), lines.join("\n")));
        for circle in imports::Crate::from_files(root, files).circles() {
            found.push(circle.join(", "));
        }
    }
    let new: Vec<&String> = found
        .iter()
        .filter(|c| !CIRCLES.contains(&c.as_str()))
        .collect();
    assert!(new.is_empty(), "these files import each other: {new:#?}");
    let gone: Vec<&&str> = CIRCLES
        .iter()
        .filter(|c| !found.iter().any(|f| f == *c))
        .collect();
    assert!(
        gone.is_empty(),
        "untied, take them from the list: {gone:#?}"
    );
}
