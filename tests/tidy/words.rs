//! Words that STYLE.md excludes from names.

use super::english::REPLACED;
use super::{is_test, sources};

/// First words of names that do not state an action, unlike `from_`, `to_`, `read_`, `write_`, `solve_`, `check_`,
/// `n_`.
const STARTS: [&str; 4] = ["get_", "process_", "handle_", "do_"];
/// Names that do not state their content.
const WHOLE: [&str; 10] = [
    "utils", "util", "data", "info", "misc", "helpers", "helper", "common", "manager", "stuff",
];
/// Methods of traits in the Parquet crate.
const OF_OTHERS: [&str; 3] = ["get_next_page", "get_read", "get_bytes"];
/// Last words of type names that do not describe the type.
const ENDS: [&str; 5] = ["Manager", "Helper", "Util", "Utils", "Info"];
/// Keywords that begin a definition.
const DEFINES: [&str; 6] = ["fn", "struct", "enum", "trait", "mod", "type"];

/// Returns kind and name of the definition in a line.
fn read_definition(line: &str) -> Option<(&str, &str)> {
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

/// Prepositions, and participles that do not end in `ed`. They are not names of functions.
const NO_NAME: [&str; 78] = [
    "above",
    "across",
    "after",
    "against",
    "along",
    "anew",
    "apart",
    "around",
    "at",
    "before",
    "begun",
    "below",
    "bent",
    "beside",
    "between",
    "beyond",
    "bound",
    "broken",
    "brought",
    "by",
    "caught",
    "chosen",
    "done",
    "drawn",
    "driven",
    "everything",
    "fallen",
    "for_",
    "found",
    "given",
    "heard",
    "held",
    "hidden",
    "inside",
    "kept",
    "known",
    "laid",
    "left",
    "lost",
    "made",
    "meant",
    "met",
    "near",
    "nothing",
    "of",
    "off",
    "on",
    "only",
    "out",
    "outside",
    "over",
    "paid",
    "per",
    "same",
    "seen",
    "sent",
    "shaken",
    "shown",
    "spent",
    "spoilt",
    "struck",
    "taken",
    "taught",
    "than",
    "thrown",
    "to",
    "told",
    "torn",
    "toward",
    "under",
    "undone",
    "unlike",
    "via",
    "with",
    "within",
    "without",
    "worn",
    "written",
];
/// Nouns and verbs that end like participles.
const NAMES: [&str; 16] = [
    "seed", "speed", "need", "feed", "embed", "spring", "string", "ring", "heading", "warning",
    "bearing", "finding", "reading", "meaning", "wiring", "coupling",
];

/// Returns whether the name of a function is one word that states neither its action nor its result.
fn is_bare(name: &str) -> bool {
    let participle = (name.ends_with("ed") || name.ends_with("ing")) && !NAMES.contains(&name);
    !name.contains('_') && (participle || NO_NAME.contains(&name))
}

#[test]
fn functions_are_no_bare_participles_and_prepositions() {
    assert!(is_bare("scaled") && is_bare("of") && is_bare("closing") && !is_bare("scale_rows"));
    let mut wrong = String::new();
    for (path, lines) in sources() {
        for (n, line) in lines.iter().enumerate() {
            // A serde visitor must have `expecting`.
            let function = read_definition(line).filter(|f| f.0 == "fn" && f.1 != "expecting");
            if let Some((_, name)) = function.filter(|f| is_bare(f.1)) {
                wrong += &format!("{path}:{}: `{name}`\n", n + 1);
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "ENGLISH.md, rule 8: verb and object:\n{wrong}"
    );
}

#[test]
fn names_say_what_is_done_and_held() {
    assert_eq!(
        read_definition("    pub(super) fn get_rows<'a>(x: &'a [f64])"),
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
            let Some(found) = read_definition(line) else {
                continue;
            };
            read += 1;
            if says_nothing(found) {
                wrong += &format!("{path}:{}: {} `{}`\n", n + 1, found.0, found.1);
            }
        }
    }
    assert!(read > 1000, "only {read} definitions were read");
    assert!(wrong.is_empty(), "STYLE.md, Words:\n{wrong}");
}

/// Fields of JSON files and a name of a rule. Programs of users rely on them.
const IN_FILES: [&str; 4] = ["drawings", "judged_by", "said_by", "told"];

/// Returns the name of the public item or field in a line.
fn read_public_name(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let rest = ["pub ", "pub(crate) ", "pub(super) "]
        .iter()
        .find_map(|p| line.strip_prefix(p))?;
    let name = match read_definition(line) {
        Some((_, name)) => name,
        None => rest.split([':', '(', '<', ' ']).next()?,
    };
    Some(name)
}

/// Returns the words of a name in small letters: `judged_by` and `JudgedBy` have the words `judged`, `by`.
fn words_of(name: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    for c in name.chars() {
        if c == '_' || c.is_uppercase() {
            out.push(String::new());
        }
        if c != '_' {
            let last = out.last_mut().expect("starts with one");
            last.extend(c.to_lowercase());
        }
    }
    out
}

#[test]
fn public_names_use_the_words_of_the_field() {
    assert_eq!(read_public_name("    pub told: f64,"), Some("told"));
    assert_eq!(read_public_name("pub fn is_told(x: f64)"), Some("is_told"));
    assert_eq!(read_public_name("fn is_told(x: f64)"), None);
    assert!(words_of("ToldBy").contains(&"told".to_owned()));
    let (mut wrong, mut read) = (String::new(), 0);
    for (path, lines) in sources() {
        if is_test(&path) {
            continue;
        }
        for (n, line) in lines.iter().enumerate() {
            let name = read_public_name(line).filter(|n| !IN_FILES.contains(n));
            let Some(name) = name else { continue };
            read += 1;
            let words = words_of(name);
            for word in REPLACED.iter().filter(|r| words.iter().any(|w| w == *r)) {
                wrong += &format!("{path}:{}: \"{word}\" in `{name}`\n", n + 1);
            }
        }
    }
    assert!(read > 5_000, "only {read} public names were read");
    assert!(wrong.is_empty(), "ENGLISH.md, Words:\n{wrong}");
}
