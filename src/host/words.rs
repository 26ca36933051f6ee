//! Findings in plain words.

use crate::finding::Finding;

/// One finding as one line: file and line where they are known, severity, code, subject, sentence, numbers, remedy.
pub fn finding_text(f: &Finding) -> String {
    let (place, message) = placed(&f.message);
    let numbers = match f.shown_numbers() {
        Some((m, Some(l))) => format!(" (measured {}, limit {})", short(m), short(l)),
        Some((m, None)) => format!(" (measured {})", short(m)),
        None => String::new(),
    };
    let remedy = if f.remedy.is_empty() {
        String::new()
    } else {
        format!(". Remedy: {}", f.remedy)
    };
    let (word, message) = (f.severity.word(), message.trim_end_matches('.'));
    let line = format!(
        "{place}{word} [{}] {}: {message}{numbers}{remedy}",
        f.code, f.subject
    );
    line.replace('\n', " ")
}

/// The place that a message begins with, as `file:line: `, and what follows; editors go there.
fn placed(message: &str) -> (String, &str) {
    let place = || {
        let (file, rest) = message.strip_prefix('`')?.split_once("` line ")?;
        let (line, rest) = rest.split_once(": ")?;
        let line: u32 = line.parse().ok()?;
        Some((format!("{file}:{line}: "), rest))
    };
    place().unwrap_or((String::new(), message))
}

/// Returns a number with what it counts, in the plural where it is not 1.
pub fn counted(n: usize, what: &str) -> String {
    match (n, what.strip_suffix('y')) {
        (1, _) => format!("1 {what}"),
        (_, Some(stem)) => format!("{n} {stem}ies"),
        (_, None) => format!("{n} {what}s"),
    }
}

/// A number with four significant digits, plain where that is readable.
pub fn short(x: f64) -> String {
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
        let line = "a b.bdf:12: note [grid-unattached] a b.bdf: GRID 7 belongs to no element (measured 2, limit 1). Remedy: join it";
        assert_eq!(finding_text(&f.clone().with_numbers(2.0, 1.0)), line);
        // A limit of 0 belongs to a count, which the message has.
        let counted = finding_text(&f.with_numbers(2.0, 0.0));
        assert_eq!(counted, line.replace(" (measured 2, limit 1)", ""));
        let f = Finding::new(Severity::Error, "gauge-dead", "P1", "two\nlines.", "");
        assert_eq!(finding_text(&f), "error [gauge-dead] P1: two lines");
    }
}
