//! Findings in plain words.

use crate::finding::Finding;
pub use crate::finding::capitalize;
use crate::finding::explain::code;

/// Returns a finding as one line: file and line if known, severity, code, subject, sentence, numbers, remedy.
pub fn finding_text(f: &Finding) -> String {
    let (place, message) = split_place(&f.message);
    let numbers = numbers_in_words(f).map_or_else(String::new, |words| format!(" ({words})"));
    let remedy = if f.remedy.is_empty() {
        String::new()
    } else {
        format!(" Remedy: {}", f.remedy)
    };
    let (word, message) = (f.severity.word(), message.trim_end_matches('.'));
    let line = format!(
        "{place}{word} [{}] {}: {message}{numbers}.{remedy}",
        f.code, f.subject
    );
    line.replace('\n', " ")
}

/// Returns the measured number of a finding and its limit in words: `scaled condition number 116.4, limit 50`. `None` if the message already contains
/// the numbers.
pub fn numbers_in_words(f: &Finding) -> Option<String> {
    let (measured, limit) = f.shown_numbers()?;
    let words = code(f.code)?.numbers;
    if words.is_empty() {
        return None;
    }
    let percent = |x: f64| format!("{} %", format_number(100.0 * x));
    let of = |words: &str, sign: &str, x: f64| {
        let share = words.replace(&format!("{{{sign}%}}"), &percent(x));
        share.replace(&format!("{{{sign}}}"), &format_number(x))
    };
    Some(of(&of(words, "m", measured), "l", limit?))
}

/// Returns the place at the beginning of a message as `file:line: `, and the text after it. Editors jump to this place.
fn split_place(message: &str) -> (String, &str) {
    let place = || {
        let (file, rest) = message.strip_prefix('`')?.split_once("` line ")?;
        let (line, rest) = rest.split_once(": ")?;
        let line: u32 = line.parse().ok()?;
        Some((format!("{file}:{line}: "), rest))
    };
    place().unwrap_or((String::new(), message))
}

/// Returns a number with its noun, in the plural unless the number is 1.
pub fn count_of(n: usize, what: &str) -> String {
    match (n, what.strip_suffix('y')) {
        (1, _) => format!("1 {what}"),
        (_, Some(stem)) => format!("{n} {stem}ies"),
        (_, None) => format!("{n} {what}s"),
    }
}

/// Returns a number with four significant digits, without an exponent if that is readable.
pub fn format_number(x: f64) -> String {
    let a = x.abs();
    if x == 0.0 {
        "0".into()
    } else if x.is_nan() {
        "-".into()
    } else if (1e-3..1e6).contains(&a) {
        let digits = (3 - a.log10().floor() as i32).clamp(0, 6) as usize;
        let s = format!("{x:.digits$}");
        if s.contains('.') {
            s.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            s
        }
    } else {
        format!("{x:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::finding::Severity;

    #[test]
    fn a_finding_is_one_line_that_begins_with_its_place() {
        let message = "`a b.bdf` line 12: GRID 7 belongs to no element";
        let f = Finding::new(
            Severity::Info,
            "grid-unattached",
            "a b.bdf",
            message,
            "join it",
        );
        let line = "a b.bdf:12: note [grid-unattached] a b.bdf: GRID 7 belongs to no element. Remedy: Join it.";
        // The message already contains these numbers.
        assert_eq!(finding_text(&f.with_numbers(2.0, 1.0)), line);
        let weak = Finding::new(
            Severity::Warning,
            "loads-weakly-separable",
            "A, B",
            "hard to separate",
            "",
        );
        let line = "warning [loads-weakly-separable] A, B: Hard to separate (scaled condition number 116.4, limit 50).";
        assert_eq!(finding_text(&weak.with_numbers(116.44, 50.0)), line);
        let share = Finding::new(Severity::Warning, "not-rigid", "a", "not rigid", "");
        let words = numbers_in_words(&share.with_numbers(0.2, 0.15)).unwrap();
        assert_eq!(
            words,
            "share that no rigid motion explains 20 %, limit 15 %"
        );
        let f = Finding::new(Severity::Error, "gauge-dead", "P1", "two\nlines.", "");
        assert_eq!(finding_text(&f), "error [gauge-dead] P1: Two lines.");
    }
}
