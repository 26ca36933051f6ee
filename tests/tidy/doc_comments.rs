//! Doc comments: first words that leave the reader looking back, and words that have a plain replacement.

use super::english::{REPLACED, contains_word};
use super::{root, rust_files};

/// First words of a comment that does not stand alone.
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

/// Text of a line of a doc comment with the kind of the comment; code spans are left out.
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
