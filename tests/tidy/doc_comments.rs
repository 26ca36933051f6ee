//! Doc comments: first words that refer to the preceding text, words with a plain replacement, and length of sentences.

use super::english::{LONGEST, REPLACED, contains_word, length, sentences};
use super::{root, rust_files};

/// First words of a comment that is not understandable alone.
const FIRST: [&str; 8] = [
    "As",
    "Everything",
    "Its",
    "Of",
    "That of",
    "The same",
    "Those",
    "What",
];

/// Returns kind and text of a line of a doc comment, without code spans.
fn doc_text(line: &str) -> Option<(&str, String)> {
    let line = line.trim_start();
    let kind = ["///", "//!"].into_iter().find(|k| line.starts_with(k))?;
    let parts = line[kind.len()..].split('`').enumerate();
    let plain = parts.filter(|(n, _)| n % 2 == 0).map(|(_, part)| part);
    Some((kind, plain.collect::<Vec<_>>().join("CODE")))
}

fn begins_with(text: &str, words: &str) -> bool {
    let rest = text.trim_start().strip_prefix(words);
    rest.is_some_and(|r| !r.starts_with(char::is_alphanumeric))
}

#[test]
fn doc_comments_stand_alone_and_use_the_words_of_the_field() {
    assert!(begins_with(" That of a name", "That of") && !begins_with("Aspect", "As"));
    assert_eq!(
        doc_text("    /// a `b` c"),
        Some(("///", " a CODE c".into()))
    );
    assert_eq!(doc_text("let x = 1; // says"), None);
    let mut files = Vec::new();
    for folder in ["src", "nastran/src", "python/src"] {
        rust_files(&root().join(folder), &mut files);
    }
    files.sort();
    let (mut wrong, mut read) = (String::new(), 0);
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        let (mut before, mut is_example) = ("", false);
        for (n, line) in text.lines().enumerate() {
            let Some((kind, words)) = doc_text(line) else {
                before = "";
                continue;
            };
            read += 1;
            let is_first = before != kind;
            before = kind;
            let is_fence = line.contains("```");
            is_example ^= is_fence;
            if is_example || is_fence {
                continue;
            }
            let first = FIRST.iter().filter(|f| is_first && begins_with(&words, f));
            let replaced = REPLACED.iter().filter(|r| contains_word(&words, r));
            for found in first.chain(replaced) {
                wrong += &format!(
                    "{}:{}: \"{found}\": {}\n",
                    path.display(),
                    n + 1,
                    line.trim()
                );
            }
        }
    }
    assert!(read > 10_000, "only {read} lines of doc comments were read");
    assert!(wrong.is_empty(), "{wrong}");
}

/// Returns the first line and the text of each paragraph and list item of the doc comments of a file, without examples.
fn doc_paragraphs(text: &str) -> Vec<(usize, String)> {
    let (mut out, mut is_example, mut continues) = (Vec::new(), false, false);
    for (n, line) in text.lines().enumerate() {
        let doc = doc_text(line).map(|d| d.1);
        let Some(words) = doc.filter(|d| !d.trim().is_empty()) else {
            continues = false;
            continue;
        };
        let is_fence = line.contains("```");
        is_example ^= is_fence;
        if is_example || is_fence {
            continues = false;
            continue;
        }
        let starts = ["-", "#", "|", "*"].iter();
        if !continues || starts.clone().any(|s| words.trim_start().starts_with(s)) {
            out.push((n + 1, String::new()));
        }
        let last: &mut (usize, String) = out.last_mut().expect("pushed at the first line");
        last.1 += words.trim();
        last.1.push(' ');
        // A heading ends with its line.
        continues = !words.trim_start().starts_with('#');
    }
    out
}

#[test]
fn doc_comments_have_short_sentences() {
    let text = "/// One `a\n/// b`. Two\n/// three.\n/// ```\n/// x\n/// ```\n/// - Four\nfn f() {}\n//! # Five\n//! six";
    let found: Vec<usize> = doc_paragraphs(text).iter().map(|p| p.0).collect();
    assert_eq!(found, [1, 7, 9, 10]);
    let mut files = Vec::new();
    for folder in ["src", "nastran/src", "python/src"] {
        rust_files(&root().join(folder), &mut files);
    }
    files.sort();
    let (mut wrong, mut read) = (String::new(), 0);
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        for (line, paragraph) in doc_paragraphs(&text) {
            read += 1;
            for long in sentences(&paragraph).iter().filter(|s| length(s) > LONGEST) {
                let words = length(long);
                wrong += &format!("{}:{line}: {words} words: {long}\n", path.display());
            }
        }
    }
    assert!(read > 5_000, "only {read} paragraphs were read");
    assert!(wrong.is_empty(), "{wrong}");
}

/// Returns the names that `lib.rs` re-exports, each with the path of its module, as in `pub use workflow::init::{init,
/// init_for};`.
fn list_reexported_names(lib: &str) -> Vec<(String, String)> {
    let lines = lib.lines().filter_map(|l| l.strip_prefix("pub use "));
    let names = lines.flat_map(|line| {
        let path = line.trim_end_matches(';');
        let (module, names) = path.rsplit_once("::").unwrap_or(("", path));
        let (module, names) = match path.split_once("::{") {
            Some((module, names)) => (module, names.trim_end_matches('}')),
            None => (module, names),
        };
        let module = format!("src/{}", module.replace("::", "/"));
        let list: Vec<_> = names.split(", ").map(str::to_owned).collect();
        list.into_iter().map(move |n| (module.clone(), n))
    });
    names.collect()
}

/// Returns the doc comment of a public item without the line marks, or `None` if the file does not define the item.
fn doc_of(text: &str, name: &str) -> Option<String> {
    let lines: Vec<&str> = text.lines().collect();
    let defines = |l: &&str| {
        let kinds = ["fn", "struct", "enum"].iter();
        let mut rest = kinds.filter_map(|k| l.strip_prefix(&format!("pub {k} {name}")));
        rest.any(|r| !r.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    };
    let at = lines.iter().position(defines)?;
    let above = lines[..at].iter().rev();
    let doc = above
        .skip_while(|l| !l.starts_with("///"))
        .map_while(|l| l.strip_prefix("///"));
    let mut doc: Vec<&str> = doc.collect();
    doc.reverse();
    Some(doc.join("\n"))
}

#[test]
fn what_the_library_reexports_has_an_example_that_asserts() {
    let lib = std::fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let names = list_reexported_names(&lib);
    assert!(names.len() > 30, "{names:?}");
    let mut files = Vec::new();
    rust_files(&root().join("src"), &mut files);
    for (module, name) in names {
        let inside = files.iter().filter(|f| f.starts_with(root().join(&module)));
        let alone = [root().join(format!("{module}.rs"))];
        let mut docs = inside.chain(&alone).filter_map(|f| {
            let text = std::fs::read_to_string(f).ok()?;
            doc_of(&text, &name)
        });
        let has_example = |doc: &String| doc.contains("```") && doc.contains("assert");
        assert!(
            docs.any(|d| has_example(&d)),
            "{module}: `{name}` has no example"
        );
    }
}
