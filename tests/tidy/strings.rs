//! Texts that the programs print: sentences of at most [`LONGEST`] words, and no word with a plain replacement.

use super::english::{LONGEST, length, replaced_words, sentences};
use super::{is_test, root, rust_files};

/// Least number of words of a literal that counts as a text, and not as a name, a key or a pattern.
const TEXT: usize = 2;

/// Returns the string literals of a source text with their lines. Comments and characters are skipped.
fn literals(source: &str) -> Vec<(usize, String)> {
    let (mut out, mut rest, mut line) = (Vec::new(), source, 1);
    let mut before = ' ';
    while let Some(c) = rest.chars().next() {
        let (literal, used) = match c {
            '/' if rest.starts_with("//") => (None, rest.find('\n').unwrap_or(rest.len())),
            '"' => {
                let end = find_closing_quote(&rest[1..]);
                (Some(remove_escapes(&rest[1..1 + end])), end + 2)
            }
            'r' if !before.is_alphanumeric() && before != '_' => read_raw_literal(&rest[1..]),
            '\'' => (None, character(rest)),
            _ => (None, c.len_utf8()),
        };
        out.extend(literal.map(|text| (line, text)));
        let (read, next) = rest.split_at(used.min(rest.len()));
        line += read.matches('\n').count();
        before = read.chars().next_back().unwrap_or(' ');
        rest = next;
    }
    out
}

/// Returns the offset of the quotation mark that ends a literal.
fn find_closing_quote(text: &str) -> usize {
    let mut is_escaped = false;
    let end = text.char_indices().find(|(_, c)| {
        let ends = *c == '"' && !is_escaped;
        is_escaped = *c == '\\' && !is_escaped;
        ends
    });
    end.map_or(text.len(), |e| e.0)
}

/// Returns a raw literal that begins after its `r`, if there is one, and its number of bytes including the `r`.
fn read_raw_literal(text: &str) -> (Option<String>, usize) {
    let marks = text.len() - text.trim_start_matches('#').len();
    let Some(body) = text[marks..].strip_prefix('"') else {
        return (None, 1);
    };
    let end = format!("\"{}", "#".repeat(marks));
    let length = body.find(&end).unwrap_or(body.len());
    (
        Some(body[..length].to_owned()),
        1 + marks + 1 + length + end.len(),
    )
}

/// Returns the bytes of a character literal, or 1 for the mark of a lifetime.
fn character(text: &str) -> usize {
    let mut letters = text.char_indices().skip(1);
    match letters.next() {
        Some((_, '\\')) => text[2..].find('\'').map_or(1, |end| {
            // A quotation mark may be the escaped character.
            2 + end + if end == 0 { 2 } else { 1 }
        }),
        _ => letters
            .next()
            .filter(|l| l.1 == '\'')
            .map_or(1, |l| l.0 + 1),
    }
}

/// Returns a literal without its escapes, with one word for each placeholder.
fn remove_escapes(literal: &str) -> String {
    let joined: Vec<&str> = literal.split("\\\n").map(str::trim_start).collect();
    let text = joined.concat().replace("\\n", "\n").replace("\\\"", "\"");
    let mut parts = text.split('{');
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let after = part.split_once('}').map(|p| p.1);
        out += &after.map_or(part.to_owned(), |after| format!("X{after}"));
    }
    out
}

#[test]
fn printed_texts_have_short_sentences_and_the_words_of_the_field() {
    let source = "f(\"a \\\"b\\\" {c:.1} \\\n   d\", '\"', 'x'); // \"no\"\nlet r: &'a str = r#\"two \"words\"\"#;";
    assert_eq!(
        literals(source),
        [(1, "a \"b\" X d".into()), (3, "two \"words\"".into())]
    );
    let mut files = Vec::new();
    for folder in ["src", "nastran/src", "python/src"] {
        rust_files(&root().join(folder), &mut files);
    }
    files.sort();
    let (mut wrong, mut read) = (String::new(), 0);
    for path in files {
        let name = path.to_string_lossy().replace('\\', "/");
        if is_test(&name) || name.ends_with("tests.rs") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
        for (line, literal) in literals(code) {
            if length(&literal) < TEXT {
                continue;
            }
            read += 1;
            for sentence in sentences(&literal) {
                let words = length(&sentence);
                let found = replaced_words(&sentence);
                if words > LONGEST || !found.is_empty() {
                    wrong += &format!("{name}:{line}: {words} words, {found:?}: {sentence}\n");
                }
            }
        }
    }
    assert!(read > 2_000, "only {read} texts were read");
    assert!(wrong.is_empty(), "{wrong}");
}
