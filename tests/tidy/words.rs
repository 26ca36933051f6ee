//! Words of STYLE.md that names of ours must not have.

use super::sources;

/// Starts of names that say nothing of what is done; `from_`, `to_`, `read_`, `write_`, `solve_`, `check_`, `n_` do.
const STARTS: [&str; 4] = ["get_", "process_", "handle_", "do_"];
/// Names that say nothing of what is held.
const WHOLE: [&str; 10] = [
    "utils", "util", "data", "info", "misc", "helpers", "helper", "common", "manager", "stuff",
];
/// Methods of traits of the Parquet crate.
const OF_OTHERS: [&str; 3] = ["get_next_page", "get_read", "get_bytes"];
/// Ends of types that say nothing of what they are.
const ENDS: [&str; 5] = ["Manager", "Helper", "Util", "Utils", "Info"];
/// What a definition begins with.
const DEFINES: [&str; 6] = ["fn", "struct", "enum", "trait", "mod", "type"];

/// Kind and name of what a line defines.
fn defined(line: &str) -> Option<(&str, &str)> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let before = ["pub", "pub(super)", "pub(crate)", "const", "async"];
    let at = words.iter().position(|w| !before.contains(w))?;
    let kind = DEFINES.iter().find(|d| **d == words[at])?;
    let name = words.get(at + 1)?;
    let end = name
        .find(|c: char| !c.is_alphanumeric() && c != '_')
        .unwrap_or(name.len());
    Some((kind, &name[..end]))
}

fn says_nothing((kind, name): (&str, &str)) -> bool {
    match kind {
        "fn" => STARTS.iter().any(|s| name.starts_with(s)) && !OF_OTHERS.contains(&name),
        "mod" => WHOLE.contains(&name),
        _ => ENDS.iter().any(|e| name.ends_with(e)),
    }
}

#[test]
fn names_say_what_is_done_and_held() {
    assert_eq!(
        defined("    pub(super) fn get_rows<'a>(x: &'a [f64])"),
        Some(("fn", "get_rows"))
    );
    assert!(says_nothing(("fn", "handle_run")) && says_nothing(("mod", "utils")));
    assert!(!says_nothing(("fn", "rows")) && says_nothing(("struct", "RunInfo")));
    let (mut wrong, mut read) = (String::new(), 0);
    for (path, lines) in sources() {
        let file = path.rsplit('/').next().unwrap_or_default();
        if WHOLE.contains(&file.trim_end_matches(".rs")) {
            wrong += &format!("{path}\n");
        }
        for (n, line) in lines.iter().enumerate() {
            let Some(found) = defined(line) else { continue };
            read += 1;
            if says_nothing(found) {
                wrong += &format!("{path}:{}: {} `{}`\n", n + 1, found.0, found.1);
            }
        }
    }
    assert!(read > 1000, "only {read} definitions were read");
    assert!(wrong.is_empty(), "STYLE.md, Words:\n{wrong}");
}
