//! Words that STYLE.md excludes from names.

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
fn names_state_action_and_content() {
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

/// Private words. They are no part of the name of a function, type, constant or public field.
const PRIVATE: [&str; 30] = [
    "aliases",
    "anew",
    "backwards",
    "beside",
    "besides",
    "doubt",
    "doubts",
    "drawings",
    "judge",
    "judged",
    "judges",
    "living",
    "rested",
    "said",
    "say",
    "says",
    "speak",
    "speaking",
    "speaks",
    "stranger",
    "strangers",
    "taught",
    "teach",
    "teaches",
    "tell",
    "tells",
    "told",
    "untold",
    "upheaval",
    "upheavals",
];
/// Names with a private word that files of results or rules of `reconcile` fix.
const FIXED: [&str; 5] = ["doubt", "drawings", "judged_by", "said_by", "told"];

/// Returns the words of a name in snake case or camel case, in lower case.
fn split_name(name: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    for c in name.chars() {
        if c == '_'
            || c.is_uppercase() && out.last().is_some_and(|w| w.ends_with(char::is_lowercase))
        {
            out.push(String::new());
        }
        if let Some(word) = out.last_mut().filter(|_| c != '_') {
            word.extend(c.to_lowercase());
        }
    }
    out
}

/// Returns the name of a public field in a line.
fn read_field(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let starts = ["pub ", "pub(super) ", "pub(crate) "];
    let rest = starts.iter().find_map(|s| line.strip_prefix(s))?;
    let (name, _) = rest.split_once(':')?;
    Some(name).filter(|n| n.chars().all(|c| c.is_alphanumeric() || c == '_'))
}

#[test]
fn names_contain_no_private_words() {
    assert_eq!(split_name("DateBeside"), ["date", "beside"]);
    assert_eq!(split_name("is_told"), ["is", "told"]);
    assert_eq!(read_field("    pub told: bool,"), Some("told"));
    assert_eq!(read_field("    pub use a::b;"), None);
    let mut wrong = String::new();
    for (path, lines) in sources().into_iter().filter(|s| !is_test(&s.0)) {
        let code = lines.iter().take_while(|l| !l.starts_with("mod tests {"));
        for (n, line) in code.enumerate() {
            let defined = read_definition(line).map(|d| d.1);
            let constant = line
                .trim_start()
                .trim_start_matches("pub ")
                .strip_prefix("const ");
            let constant = constant.and_then(|c| Some(c.split_once(':')?.0));
            for name in defined.into_iter().chain(constant).chain(read_field(line)) {
                let words = split_name(name);
                let found = words.iter().find(|w| PRIVATE.contains(&w.as_str()));
                if let Some(word) = found.filter(|_| !FIXED.contains(&name)) {
                    wrong += &format!("{path}:{}: \"{word}\": {name}\n", n + 1);
                }
            }
        }
    }
    assert!(wrong.is_empty(), "ENGLISH.md, Words:\n{wrong}");
}
