//! Length of sentences and words with a plain replacement, in the texts that declare keys, columns, fields and findings.

use super::english::{LONGEST, REPLACED, contains_word, length, sentences};
use super::root;

/// Declaration texts, with the columns that contain prose. For findings, these are the lines `cause:`, `limit:`,
/// `remedy:`, `example:`.
const TEXTS: [(&str, std::ops::Range<usize>); 7] = [
    ("src/job/keys.txt", 1..4),
    ("src/report/reference/columns.txt", 3..5),
    ("src/report/reference/fields.txt", 2..4),
    ("src/finding/codes/layout.txt", 0..0),
    ("src/finding/codes/model.txt", 0..0),
    ("src/finding/codes/strain.txt", 0..0),
    ("src/finding/codes/vehicle.txt", 0..0),
];

/// Returns the prose of a line of a declaration text, with one word for each quoted name and value.
fn prose(line: &str, columns: &std::ops::Range<usize>) -> String {
    let parts = ["cause", "limit", "remedy", "example"];
    let text = if columns.is_empty() {
        let part = line
            .trim_start()
            .split_once(": ")
            .filter(|(p, _)| parts.contains(p));
        part.map_or(String::new(), |(_, text)| text.to_owned())
    } else if line.starts_with('#') {
        String::new()
    } else {
        let cells: Vec<&str> = line.split(" | ").collect();
        cells.get(columns.clone()).unwrap_or_default().join("; ")
    };
    let unquoted = text.split('`').step_by(2);
    unquoted.collect::<Vec<_>>().join("CODE")
}

/// Returns the words and phrases of [`REPLACED`] that a text contains as whole words.
fn replaced_words(text: &str) -> Vec<&'static str> {
    let found = REPLACED.iter().filter(|w| contains_word(text, w));
    found.copied().collect()
}

#[test]
fn declarations_of_keys_columns_fields_and_findings_are_plain() {
    let finding = "  cause: The rest tells it, `told`.";
    assert_eq!(replaced_words(&prose(finding, &(0..0))), ["tells"]);
    let column = "a | b.csv | told | - | what is said";
    assert_eq!(replaced_words(&prose(column, &(3..5))), ["said"]);
    assert!(replaced_words("Untold, saying, besides").is_empty());
    let (mut wrong, mut read) = (String::new(), 0);
    for (path, columns) in &TEXTS {
        let text = std::fs::read_to_string(root().join(path)).unwrap();
        for (n, line) in text.lines().enumerate() {
            let prose = prose(line, columns);
            read += usize::from(!prose.is_empty());
            for word in replaced_words(&prose) {
                wrong += &format!("{path}:{}: `{word}` in: {prose}\n", n + 1);
            }
            for long in sentences(&prose).iter().filter(|s| length(s) > LONGEST) {
                wrong += &format!("{path}:{}: {} words: {long}\n", n + 1, length(long));
            }
        }
    }
    assert!(read > 1500, "only {read} lines of prose were read");
    assert!(
        wrong.is_empty(),
        "words to replace and long sentences:\n{wrong}"
    );
}
