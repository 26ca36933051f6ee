//! Compares the reference with the code: finding codes, pages, links, commands on pages, length of the README.

#![cfg(feature = "cli")]

use clap::Parser;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use strainbridge::explain_all;
use strainbridge::report::reference;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Collects the files below a folder whose name has this ending.
fn files(folder: &Path, end: &str, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files(&path, end, out);
        } else if path.to_string_lossy().ends_with(end) {
            out.push(path);
        }
    }
}

/// Returns the sources without their tests, by path.
fn sources() -> BTreeMap<String, String> {
    let mut list = Vec::new();
    files(&root().join("src"), ".rs", &mut list);
    let mut out = BTreeMap::new();
    for path in list {
        let name = path.strip_prefix(root()).unwrap().display().to_string();
        if name.contains("/tests") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]\nmod").next().unwrap();
        out.insert(name, code.to_owned());
    }
    out
}

/// Returns the string literals of a text that have the form of a code.
fn literals(text: &str) -> BTreeSet<&str> {
    text.split('"').filter(|l| is_code(l)).collect()
}

/// Returns whether a word has the form of a code.
fn is_code(word: &str) -> bool {
    let letters = word.starts_with(|c: char| c.is_ascii_lowercase());
    letters
        && word
            .chars()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || "-_".contains(c))
}

/// Returns the codes in calls of `Finding::new`: the second argument, if it is a literal.
fn codes_of_calls(text: &str) -> Vec<&str> {
    let calls = text.split("Finding::new(").skip(1);
    let second = |call: &'_ str| -> Option<(usize, usize)> {
        let (mut depth, mut comma) = (0, None);
        for (i, c) in call.char_indices().take(600) {
            match c {
                '(' | '{' | '[' => depth += 1,
                ')' | '}' | ']' => depth -= 1,
                ',' if depth == 0 => match comma {
                    None => comma = Some(i + 1),
                    Some(from) => return Some((from, i)),
                },
                _ => {}
            }
        }
        None
    };
    let mut out = Vec::new();
    for call in calls {
        let Some((from, to)) = second(call) else {
            continue;
        };
        let word = call[from..to].trim();
        if let Some(code) = word.strip_prefix('"').and_then(|w| w.strip_suffix('"')) {
            out.push(code);
        }
    }
    out
}

#[test]
fn every_code_that_the_program_gives_has_an_entry_and_every_entry_is_given() {
    let sources = sources();
    let known: BTreeSet<&str> = explain_all().iter().map(|c| c.code).collect();
    let mut given = 0;
    let mut reported = BTreeSet::new();
    for (name, text) in &sources {
        for code in codes_of_calls(text) {
            assert!(
                known.contains(code),
                "{name}: `{code}` has no entry in src/finding/codes"
            );
            given += 1;
        }
        // Codes that reach the call through a table or an argument are literals in the same file.
        if text.contains("Finding::new(")
            || text.contains("Finding {")
            || text.contains("said(")
            || text.contains("pub const CODE")
            || text.contains("pub const GAUGE_SUSPECT")
        {
            reported.extend(literals(text));
        }
    }
    assert!(
        given > 100,
        "{given} calls found: does the search still work?"
    );
    let silent: Vec<&&str> = known.iter().filter(|c| !reported.contains(**c)).collect();
    assert!(
        silent.is_empty(),
        "entries of codes that nothing gives: {silent:?}"
    );
}

#[test]
fn codes_that_reach_a_finding_through_a_table_have_entries_too() {
    let known: BTreeSet<&str> = explain_all().iter().map(|c| c.code).collect();
    let mut given = 0;
    for (name, text) in sources() {
        // `code` may be a variable. The test takes every literal of the file with the form of a code and a dash after a
        // severity.
        for (i, _) in text.match_indices("\",\n") {
            let before = &text[..i];
            let Some(start) = before.rfind('"') else {
                continue;
            };
            let word = &before[start + 1..];
            let lead = before[..start].trim_end();
            let beside = ["Severity::Error,", "Severity::Warning,", "Severity::Info,"];
            if is_code(word) && word.contains('-') && beside.iter().any(|s| lead.ends_with(s)) {
                assert!(
                    known.contains(word),
                    "{name}: `{word}` has no entry in src/finding/codes"
                );
                given += 1;
            }
        }
    }
    assert!(
        given > 10,
        "{given} codes found: does the search still work?"
    );
}

#[test]
fn the_pages_of_the_reference_agree_with_the_code() {
    for (name, text) in reference::pages() {
        let path = root().join("docs/reference").join(name);
        let stands = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            stands == text,
            "docs/reference/{name} is old: `strainbridge explain --reference docs/reference` makes it"
        );
    }
    for [command, field, unit, meaning] in reference::fields() {
        assert!(
            [command, field, unit, meaning]
                .iter()
                .all(|w| !w.is_empty()),
            "{field}"
        );
    }
    let lines = |table: &str| table.lines().filter(|l| !l.starts_with('#')).count();
    let read = |name: &str| {
        std::fs::read_to_string(root().join("src/report/reference").join(name)).unwrap()
    };
    assert_eq!(reference::fields().len(), lines(&read("fields.txt")));
    assert_eq!(reference::columns().len(), lines(&read("columns.txt")));
}

/// Returns the pages of the repository.
fn pages() -> Vec<(PathBuf, String)> {
    let mut list = Vec::new();
    files(&root().join("docs"), ".md", &mut list);
    files(&root().join("examples"), ".md", &mut list);
    for name in [
        "README.md",
        "ARCHITECTURE.md",
        "STYLE.md",
        "CONTRIBUTING.md",
        "CHANGELOG.md",
    ] {
        list.push(root().join(name));
    }
    list.into_iter()
        .map(|p| (p.clone(), std::fs::read_to_string(p).unwrap()))
        .collect()
}

#[test]
fn no_link_is_dead() {
    let mut links = 0;
    for (path, text) in pages() {
        for after in text.split("](").skip(1) {
            let Some(target) = after.split(')').next() else {
                continue;
            };
            let file = target.split('#').next().unwrap_or_default();
            if file.is_empty() || file.contains("://") {
                continue;
            }
            links += 1;
            assert!(
                path.parent().unwrap().join(file).exists(),
                "{}: {target}",
                path.display()
            );
        }
    }
    assert!(links > 20);
}

/// Pages name the tests that show a figure by their file.
#[test]
fn every_test_file_that_a_page_names_exists() {
    let mut named = 0;
    for (path, text) in pages() {
        for word in text.split('`').skip(1).step_by(2) {
            let is_file = word.ends_with(".rs") && !word.contains(['*', '{', ' ', '<']);
            if is_file && (word.starts_with("src/") || word.starts_with("tests/")) {
                named += 1;
                assert!(root().join(word).is_file(), "{}: {word}", path.display());
            }
        }
    }
    // The table of the thesis has 41 rows.
    assert!(named >= 41, "{named}");
}

#[test]
fn every_command_that_a_page_shows_is_understood() {
    let mut commands = 0;
    for (path, text) in pages() {
        let mut fenced = false;
        for line in text.lines() {
            fenced ^= line.starts_with("```");
            let shown = fenced || line.starts_with("    ");
            let line = line.trim();
            if !shown || !line.starts_with("strainbridge ") {
                continue;
            }
            let command = line.split(" #").next().unwrap_or_default();
            let command = command.split(['>', '|', '&']).next().unwrap_or_default();
            let words = command.split_whitespace();
            if words.clone().any(|w| w == ".." || w == "COMMAND") {
                continue;
            }
            commands += 1;
            if let Err(e) = strainbridge::cli::Arguments::try_parse_from(words) {
                let asked = [
                    clap::error::ErrorKind::DisplayHelp,
                    clap::error::ErrorKind::DisplayVersion,
                ];
                assert!(asked.contains(&e.kind()), "{}: {line}\n{e}", path.display());
            }
        }
    }
    assert!(commands > 20);
}

#[test]
fn the_readme_is_short_and_leads_to_the_reference() {
    let text = std::fs::read_to_string(root().join("README.md")).unwrap();
    let words = text.split_whitespace().count();
    assert!(words <= 1300, "{words} words");
    for page in ["job-keys.md", "results.md", "findings.md"] {
        assert!(text.contains(page), "{page}");
    }
}

/// The page must have the thresholds of names with their values, and every constant that it lists must have the value
/// in the code.
#[test]
fn the_page_of_thresholds_states_those_of_the_code() {
    use strainbridge::reconcile::{MotionRules, Rule, StrainRules};
    fn values<R: Copy + Default>(list: &[Rule<R>]) -> BTreeMap<String, f64> {
        let value = |place: fn(&mut R) -> &mut f64| *place(&mut R::default());
        let one = |(name, place): &Rule<R>| ((*name).to_owned(), value(*place));
        list.iter().map(one).collect()
    }
    let page = std::fs::read_to_string(root().join("docs/reference/thresholds.md")).unwrap();
    let cells = |line: &str| -> Vec<String> {
        let inside = line.trim_matches('|').split('|');
        inside
            .map(|c| c.trim().trim_matches('`').to_owned())
            .collect()
    };
    let section = |title: &str| -> Vec<Vec<String>> {
        let text = page.split("\n## ").find(|s| s.starts_with(title)).unwrap();
        let rows = text.lines().filter(|l| l.starts_with("| `"));
        rows.map(cells).collect()
    };
    for (title, known) in [
        ("Strain: what names", values(&StrainRules::ALL)),
        ("Motion: what names", values(&MotionRules::ALL)),
    ] {
        let rows = section(title);
        assert_eq!(rows.len(), known.len(), "{title}");
        for row in rows {
            let stated: f64 = row[1].parse().unwrap();
            let value = known[&row[0]];
            // The page states four digits.
            assert!(
                (stated / value - 1.0).abs() < 5e-4,
                "{title}: {row:?} {value}"
            );
        }
    }
    let mut listed = 0;
    for row in page.lines().filter(|l| l.starts_with("| `")).map(cells) {
        if !row[0].ends_with(".rs") {
            continue;
        }
        let path = root().join("src/reconcile").join(&row[0]);
        let source = std::fs::read_to_string(&path).unwrap_or_default();
        let of_name = format!("const {}: ", row[1]);
        let words = |text: &str| -> String { text.split_whitespace().collect() };
        let mut stands = source.split(of_name.as_str()).skip(1);
        // The type of an array contains a semicolon before the equals sign.
        let is_it = |rest: &str| {
            let value = rest.split_once('=').and_then(|r| r.1.split_once(';'));
            value.is_some_and(|v| words(v.0) == words(&row[2]))
        };
        assert!(stands.any(is_it), "{row:?}");
        listed += 1;
    }
    assert!(listed > 60, "{listed} constants: is the page still read?");
}
