//! Lengths of files, functions and lines of comment.

use super::{is_test, root, rust_files, sources};

/// Largest number of lines of a file.
const FILE: usize = 500;
/// Largest number of lines of a function.
const FUNCTION: usize = 120;
/// Largest number of characters of a comment line, because the formatter wraps only code.
const COMMENT: usize = 150;

#[test]
fn files_and_functions_are_short() {
    let mut found = Vec::new();
    for (path, lines) in sources() {
        if is_test(&path) {
            continue;
        }
        if lines.len() > FILE {
            found.push((path.clone(), lines.len()));
        }
        for (name, length) in functions(&lines) {
            if length > FUNCTION {
                found.push((format!("{path} {name}"), length));
            }
        }
    }
    assert!(found.is_empty(), "split these (name, lines): {found:#?}");
}

#[test]
fn lines_of_comment_fit_a_screen() {
    let mut files = Vec::new();
    rust_files(&root().join("src"), &mut files);
    rust_files(&root().join("nastran/src"), &mut files);
    let mut long = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        for (n, line) in (1..).zip(text.lines()) {
            let is_comment = line.trim_start().starts_with("//");
            if is_comment && line.chars().count() > COMMENT {
                long.push(format!("{}:{n}", file.display()));
            }
        }
    }
    assert!(long.is_empty(), "break these lines: {long:#?}");
}

/// Returns name and number of lines of each function, found by its indentation.
fn functions(lines: &[String]) -> Vec<(String, usize)> {
    let mut out = Vec::new();
    for (start, line) in lines.iter().enumerate() {
        let bare = line.trim_start();
        let indent = &line[..line.len() - bare.len()];
        // `pub(super) fn` has a bracket before its name.
        let bare = match bare.strip_prefix("pub(") {
            Some(rest) => rest.split_once(") ").map_or(bare, |r| r.1),
            None => bare,
        };
        let head = bare.split('(').next().unwrap_or("");
        let words: Vec<&str> = head.split_whitespace().collect();
        let Some(at) = words.iter().position(|w| *w == "fn") else {
            continue;
        };
        if !bare.starts_with("pub") && at > 2 || bare.ends_with(';') || bare.ends_with('}') {
            continue;
        }
        let end = format!("{indent}}}");
        let Some(length) = lines[start..].iter().position(|l| l.trim_end() == end) else {
            continue;
        };
        let name = words.get(at + 1).unwrap_or(&"").split('<').next();
        out.push((name.unwrap_or("").to_owned(), length + 1));
    }
    out
}
