//! Rules of plain English that a program can test, on the pages that follow them, and the questions of a new user.

use super::root;

/// Pages that follow the rules. Add every page that is rewritten.
const PAGES: [&str; 40] = [
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "README.md",
    "docs/1-first-hour.md",
    "docs/2-own-export.md",
    "docs/3-placing-gauges.md",
    "docs/4-recovering-loads.md",
    "docs/5-reconciling.md",
    "docs/6-calibrating.md",
    "docs/7-planning-by-pointing.md",
    "docs/choosing-uncertainties.md",
    "docs/concepts.md",
    "docs/faq.md",
    "docs/glossary.md",
    "docs/glue-and-wire.md",
    "docs/how-many-gauges.md",
    "docs/python/calibrate.md",
    "docs/python/fleet.md",
    "docs/python/payload.md",
    "docs/python/place.md",
    "docs/python/reconcile.md",
    "docs/python/recover.md",
    "docs/reference/accelerations.md",
    "docs/reference/benchmarks.md",
    "docs/reference/calibration.md",
    "docs/reference/conventions.md",
    "docs/reference/files.md",
    "docs/reference/fleet.md",
    "docs/reference/limits.md",
    "docs/reference/placement.md",
    "docs/reference/python.md",
    "docs/reference/reconcile.md",
    "docs/reference/recovering.md",
    "docs/reference/reports.md",
    "docs/reference/thresholds.md",
    "docs/reference/truck.md",
    "docs/reference/trust.md",
    "docs/reference/verification.md",
    "nastran/README.md",
];

/// Words and phrases that have a plain replacement.
pub(super) const REPLACED: [&str; 40] = [
    "aliases",
    "anew",
    "backwards",
    "beside",
    "by itself",
    "by themselves",
    "doubts",
    "drawings",
    "is none",
    "judged",
    "judges",
    "judging",
    "known runs",
    "none that",
    "of its own",
    "put right",
    "rested",
    "said",
    "say",
    "says",
    "so do the rest",
    "speak",
    "speaking",
    "speaks",
    "stranger",
    "strangers",
    "taught",
    "teach",
    "teaches",
    "teaching",
    "tell",
    "tells",
    "the others say",
    "told",
    "turned round",
    "under way",
    "upheaval",
    "upheavals",
    "what is left",
    "what is none",
];

/// Phrases after which a reader must look back for the noun. Texts of the program do not contain them.
pub(super) const WITHOUT_NOUN: [&str; 4] = ["all else", "that of", "the one of", "those of"];

/// Returns the words and phrases with a plain replacement in a text of the program.
pub(super) fn replaced_words(text: &str) -> Vec<&'static str> {
    let all = REPLACED.iter().chain(&WITHOUT_NOUN);
    all.filter(|w| contains_word(text, w)).copied().collect()
}

/// Largest number of words in a sentence.
pub(super) const LONGEST: usize = 25;

/// Returns the paragraphs, list items and table rows of a page, without boxes, pictures and targets of links.
fn paragraphs(page: &str) -> Vec<String> {
    let (mut out, mut fenced) = (vec![String::new()], false);
    for line in page.lines() {
        fenced ^= line.starts_with("```");
        let text = line.trim_start();
        let skipped = fenced || line.starts_with("    ") || line.starts_with("```");
        let number = text.trim_start_matches(|c: char| c.is_ascii_digit());
        let starts = ["- ", "#", "|"].iter().any(|s| text.starts_with(s))
            || (number.len() < text.len() && number.starts_with(". "));
        if skipped || text.is_empty() || starts {
            out.push(String::new());
        }
        if !skipped {
            let last = out.last_mut().expect("starts with one");
            for (n, part) in text.split("](").enumerate() {
                *last += match n {
                    0 => part,
                    _ => part.split_once(')').map_or("", |p| p.1),
                };
            }
            last.push(' ');
        }
    }
    out
}

/// Returns the sentences of a paragraph. A cell of a table counts as a sentence, and a code span counts as a word.
pub(super) fn sentences(paragraph: &str) -> Vec<String> {
    let mut plain = String::new();
    for (n, part) in paragraph.split('`').enumerate() {
        plain += if n % 2 == 0 { part } else { "CODE" };
    }
    let ends = [". ", "? ", "! ", ": ", "; ", "|", ".)"];
    for end in ends {
        plain = plain.replace(end, "\n");
    }
    plain.lines().map(|s| s.trim().to_owned()).collect()
}

pub(super) fn length(sentence: &str) -> usize {
    let words = sentence.split_whitespace();
    words
        .filter(|w| w.chars().any(char::is_alphanumeric))
        .count()
}

pub(super) fn contains_word(text: &str, word: &str) -> bool {
    let letters: String = text
        .to_lowercase()
        .chars()
        .map(|c| {
            if c.is_alphanumeric() || c == '_' {
                c
            } else {
                ' '
            }
        })
        .collect();
    let words: Vec<&str> = letters.split_whitespace().collect();
    format!(" {} ", words.join(" ")).contains(&format!(" {word} "))
}

#[test]
fn pages_have_short_sentences_and_the_words_of_the_field() {
    let long = vec!["word"; LONGEST + 1].join(" ");
    assert!(length(&sentences(&format!("{long}. Next one."))[0]) > LONGEST);
    assert_eq!(
        sentences("See [a page](x.md) now. `told. so` ends. ")[1],
        "CODE ends"
    );
    assert!(contains_word("What is none, of them", "is none"));
    assert!(!contains_word("nonetheless", "none that"));
    let mut wrong = String::new();
    for page in PAGES {
        let text = std::fs::read_to_string(root().join(page)).unwrap();
        for paragraph in paragraphs(&text) {
            for sentence in sentences(&paragraph) {
                if length(&sentence) > LONGEST {
                    wrong += &format!("{page}: {} words: {sentence}\n", length(&sentence));
                }
                for word in REPLACED.iter().filter(|w| contains_word(&sentence, w)) {
                    wrong += &format!("{page}: \"{word}\": {sentence}\n");
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// Question of a new user, page with the answer, heading there, and a word that the answer contains.
const QUESTIONS: [[&str; 4]; 15] = [
    [
        "Which side is Z1?",
        "docs/reference/conventions.md",
        "Conventions",
        "Z1",
    ],
    [
        "Which way does an angle turn?",
        "docs/faq.md",
        "In which direction does the angle of a gauge turn?",
        "element normal",
    ],
    [
        "How many gauges?",
        "docs/how-many-gauges.md",
        "How many gauges",
        "twice",
    ],
    [
        "Which output must Nastran write?",
        "docs/2-own-export.md",
        "1. Export from Simcenter or Nastran",
        "PARAM,POST,-1",
    ],
    [
        "How is a free vehicle held?",
        "docs/faq.md",
        "How do I support a free vehicle?",
        "support = \"free\"",
    ],
    [
        "What follows +-?",
        "docs/faq.md",
        "What does +- mean?",
        "half width",
    ],
    [
        "How is the zero set?",
        "docs/faq.md",
        "How do I set the zero?",
        "zero_runs",
    ],
    [
        "A gauge was glued elsewhere?",
        "docs/faq.md",
        "My gauge is not at its planned place. What now?",
        "angle_deg",
    ],
    [
        "Which bridge factor?",
        "docs/glue-and-wire.md",
        "Wirings",
        "bridge_factor",
    ],
    [
        "mV/V to microstrain?",
        "docs/glue-and-wire.md",
        "From mV/V to microstrain",
        "4000",
    ],
    [
        "Rosette columns?",
        "docs/glue-and-wire.md",
        "Rosettes",
        ".a",
    ],
    [
        "How well do I trust the model?",
        "docs/choosing-uncertainties.md",
        "model_uncertainty_rel",
        "known loads",
    ],
    [
        "Temperature?",
        "docs/glue-and-wire.md",
        "Temperature",
        "zero_runs",
    ],
    [
        "How fast may loads change?",
        "docs/faq.md",
        "How fast may my loads change?",
        "content-near-first-mode",
    ],
    [
        "Rainflow and RPC?",
        "docs/faq.md",
        "How do I get rainflow counts and RPC files?",
        "rainflow.csv",
    ],
];

#[test]
fn fifteen_questions_of_a_new_user_have_an_answer_under_a_heading() {
    for [question, page, heading, answer] in QUESTIONS {
        let text = std::fs::read_to_string(root().join(page)).unwrap();
        let section = text
            .split("\n#")
            .find(|s| {
                s.lines()
                    .next()
                    .unwrap_or("")
                    .trim_start_matches(['#', ' '])
                    == heading
            })
            .unwrap_or_else(|| panic!("{question} {page}: no heading {heading}"));
        assert!(section.contains(answer), "{question} {page}, {heading}");
    }
    let faq = std::fs::read_to_string(root().join("docs/faq.md")).unwrap();
    assert_eq!(faq.matches("\n## ").count(), 20);
}
