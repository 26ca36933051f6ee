//! Looks up bulk data names and case control commands.

use super::effect::{CaseWord, Effect};
use super::spelling;
use super::table::{Entry, read_table};
use std::collections::{BTreeMap, HashMap};
use std::sync::OnceLock;

/// Returns the effect of a bulk data entry; `None` for a name that exists in no dialect.
pub fn effect_of_card(name: &str) -> Option<Effect> {
    cards().get(name).copied()
}

/// Reads a case control command in upper case. The command is in full or abbreviated to four letters or more; an output request may be in the plural.
///
/// Returns `None` for a command that exists in no dialect.
pub fn case_word(word: &str) -> Option<CaseWord> {
    let abbreviated = || {
        let long_enough = word.len() >= ABBREVIATION;
        let begin = words().iter().filter(|e| e.written.starts_with(word));
        let begin = begin.filter(|_| long_enough);
        begin.min_by_key(|e| preference(e.effect))
    };
    // Output requests and output commands are often written in the plural.
    let singular = || {
        let stems = ["ES", "S"].into_iter().filter_map(|s| word.strip_suffix(s));
        let mut of_stem = stems.filter_map(word_in_full);
        of_stem.find(|e| matches!(e.effect, Effect::Request | Effect::None(_)))
    };
    let e = word_in_full(word).or_else(abbreviated).or_else(singular)?;
    Some(CaseWord {
        name: e.name,
        effect: e.effect,
    })
}

/// Returns whether a statement above CEND, in upper case, changes the solution sequence or starts from an earlier run.
pub fn changes_program(word: &str) -> bool {
    let mut words = words().iter();
    words.any(|e| e.written == word && e.effect == Effect::ExecutiveActs)
}

/// Returns whether a keyword in upper case is a statement above CEND, in full or abbreviated to four letters or more.
pub(crate) fn executive_word(word: &str) -> bool {
    let mut statements = words().iter().filter(|e| e.effect.is_executive());
    statements
        .any(|e| e.written == word || word.len() >= ABBREVIATION && e.written.starts_with(word))
}

/// Returns the statement above CEND that differs from a misspelt statement by one letter.
pub(crate) fn nearest_executive(word: &str) -> Option<&'static str> {
    let statements = words().iter().filter(|e| e.effect.is_executive());
    spelling::find_nearest_name(word, statements.map(|e| e.written))
}

/// Returns the full name of an output request; `None` for another command.
pub fn request_of(word: &str) -> Option<&'static str> {
    let word = case_word(word)?;
    (word.effect == Effect::Request).then_some(word.name)
}

/// Returns the bulk data name that differs from a misspelt name by one letter; `None` if there is no such name.
///
/// # Example
/// ```
/// use nastran::bdf::vocabulary::{Effect, effect_of_card, nearest_card};
///
/// assert_eq!(nearest_card("PSHEL"), Some("PSHELL"));
/// assert_eq!(effect_of_card("PSHELL"), Some(Effect::Carried));
/// assert_eq!(effect_of_card("PSHEL"), None);
/// ```
pub fn nearest_card(name: &str) -> Option<&'static str> {
    spelling::find_nearest_name(name, all_cards().map(|c| c.0))
}

/// Returns the case control command that differs from a misspelt command by one letter.
pub fn nearest_word(word: &str) -> Option<&'static str> {
    spelling::find_nearest_name(word, all_words().map(|w| w.0))
}

/// Returns the parameter of the program that differs from a misspelt parameter by one letter; `None` for the name of another parameter.
pub fn nearest_parameter(name: &str) -> Option<&'static str> {
    let known = PARAMETERS.contains(&name) || SIMILAR_PARAMETERS.contains(&name);
    (!known).then(|| spelling::find_nearest_name(name, PARAMETERS.into_iter()))?
}

/// Parameters that the program reads.
const PARAMETERS: [&str; 11] = [
    "WTMASS", "INREL", "GRDPNT", "K6ROT", "SNORM", "AUTOSPC", "COUPMASS", "POST", "OMID",
    "UNITSYS", "LGDISP",
];
/// Other Nastran parameters, whose names differ by one letter from a parameter that the program reads.
const SIMILAR_PARAMETERS: [&str; 4] = ["AUTOMPC", "AUTOSPCR", "INRELM", "POSTU"];

/// Returns every bulk data name with its effect.
pub fn all_cards() -> impl Iterator<Item = (&'static str, Effect)> {
    cards().iter().map(|(name, effect)| (*name, *effect))
}

/// Returns every case control command in each spelling, with the command as it is read.
pub fn all_words() -> impl Iterator<Item = (&'static str, CaseWord)> {
    words().iter().map(|e| {
        let word = CaseWord {
            name: e.name,
            effect: e.effect,
        };
        (e.written, word)
    })
}

/// Number of letters in the shortest abbreviation of a case control command.
const ABBREVIATION: usize = 4;

/// Returns the rank of a command among the commands that an abbreviation may mean: commands that are read come first, then commands that act.
fn preference(effect: Effect) -> u8 {
    match effect {
        Effect::Carried | Effect::Request => 0,
        Effect::Acts | Effect::Load | Effect::ActsWith(_) => 1,
        Effect::None(_) => 2,
        Effect::Executive | Effect::ExecutiveActs => 3,
    }
}

fn cards() -> &'static BTreeMap<&'static str, Effect> {
    static CARDS: OnceLock<BTreeMap<&'static str, Effect>> = OnceLock::new();
    CARDS.get_or_init(|| {
        let entries = read_table(include_str!("bulk.txt"));
        entries.iter().map(|e| (e.written, e.effect)).collect()
    })
}

fn words() -> &'static [Entry] {
    static WORDS: OnceLock<Vec<Entry>> = OnceLock::new();
    WORDS.get_or_init(|| read_table(include_str!("case_control.txt")))
}

/// Returns the first entry with exactly this spelling.
fn word_in_full(word: &str) -> Option<&'static Entry> {
    static BY_WORD: OnceLock<HashMap<&'static str, &'static Entry>> = OnceLock::new();
    let by_word = BY_WORD.get_or_init(|| words().iter().rev().map(|e| (e.written, e)).collect());
    by_word.get(word).copied()
}
