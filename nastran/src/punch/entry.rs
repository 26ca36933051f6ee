//! Reads entries, an id and its values, from fixed columns.

use super::PunchError;

/// A slot of 18 columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Word {
    Blank,
    Integer(i64),
    Real(f64),
    Text,
}

impl Word {
    pub(super) fn to_real(self) -> f64 {
        match self {
            Word::Real(v) => v,
            Word::Integer(i) => i as f64,
            Word::Blank | Word::Text => f64::NAN,
        }
    }

    pub(super) fn id(self) -> Option<u32> {
        match self {
            Word::Integer(i) => u32::try_from(i).ok(),
            _ => None,
        }
    }
}

/// One entry: the id, the letter after it (`G`, `S` ..; blank for elements) and its values, trailing blanks removed.
#[derive(Clone, Debug, Default)]
pub(super) struct Entry {
    pub line: u32,
    pub id: u32,
    pub letter: Option<u8>,
    pub words: Vec<Word>,
}

/// Returns columns 1 to 72 of a line, which contain its content.
pub(super) fn content(line: &[u8]) -> &[u8] {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    line.get(..72).unwrap_or(line)
}

/// Returns whether the line continues an entry.
pub(super) fn is_continuation(line: &[u8]) -> bool {
    line.starts_with(b"-CONT-")
}

/// Calls `each` with every entry of `text`; `first_line` is the number of its first line. The entry is reused.
///
/// # Errors
/// [`PunchError::BadField`] for an id or a slot that is neither number, text nor blank; every error that `each` returns.
pub(super) fn each_entry(
    text: &[u8],
    first_line: u32,
    mut each: impl FnMut(&Entry) -> Result<(), PunchError>,
) -> Result<(), PunchError> {
    let mut entry = Entry::default();
    let mut open = false;
    for (i, line) in text.split(|&b| b == b'\n').enumerate() {
        let number = first_line.saturating_add(u32::try_from(i).unwrap_or(u32::MAX));
        let line = content(line);
        if line.is_empty() || line.iter().all(u8::is_ascii_whitespace) || line.starts_with(b"$") {
            continue;
        }
        if !is_continuation(line) {
            if open {
                finish_entry(&mut entry, &mut each)?;
            }
            open = true;
            begin(&mut entry, line, number)?;
        } else if !open {
            return Err(bad_field_error(
                number,
                line,
                "an entry before its continuation",
            ));
        }
        for slot in line.get(18..).unwrap_or(&[]).chunks(18) {
            entry
                .words
                .push(word(slot).ok_or_else(|| bad_field_error(number, slot, "a number"))?);
        }
    }
    if open {
        finish_entry(&mut entry, &mut each)
    } else {
        Ok(())
    }
}

fn begin(entry: &mut Entry, line: &[u8], number: u32) -> Result<(), PunchError> {
    entry.words.clear();
    entry.line = number;
    let head = line.get(..18).unwrap_or(line);
    let text = std::str::from_utf8(head).map_err(|_| bad_field_error(number, head, "an id"))?;
    let mut parts = text.split_whitespace();
    entry.id = parts
        .next()
        .and_then(|t| t.parse().ok())
        .ok_or_else(|| bad_field_error(number, head, "an id"))?;
    entry.letter = parts.next().and_then(|t| t.bytes().next());
    Ok(())
}

fn finish_entry(
    entry: &mut Entry,
    each: &mut impl FnMut(&Entry) -> Result<(), PunchError>,
) -> Result<(), PunchError> {
    while entry.words.last() == Some(&Word::Blank) {
        entry.words.pop();
    }
    each(entry)
}

fn bad_field_error(line: u32, text: &[u8], expected: &'static str) -> PunchError {
    PunchError::BadField {
        line,
        text: String::from_utf8_lossy(text).trim().to_string(),
        expected,
    }
}

fn word(slot: &[u8]) -> Option<Word> {
    let text = std::str::from_utf8(slot).ok()?.trim();
    if text.is_empty() {
        return Some(Word::Blank);
    }
    if let Ok(i) = text.parse::<i64>() {
        return Some(Word::Integer(i));
    }
    if let Some(v) = parse_real(text) {
        return Some(Word::Real(v));
    }
    text.starts_with(|c: char| c.is_ascii_alphabetic())
        .then_some(Word::Text)
}

/// Reads a real; also with D exponents, and with three-digit exponents without a letter (`1.234567-101`). `None` for other text.
pub(super) fn parse_real(text: &str) -> Option<f64> {
    let starts_as_number =
        text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.'));
    if !starts_as_number {
        return None;
    }
    if let Ok(v) = text.parse() {
        return Some(v);
    }
    let sign = text.char_indices().skip(1).find(|&(i, c)| {
        matches!(c, '+' | '-')
            && text
                .as_bytes()
                .get(i.wrapping_sub(1))
                .is_some_and(u8::is_ascii_digit)
    });
    match sign {
        Some((i, _)) => format!("{}e{}", text.get(..i)?, text.get(i..)?)
            .parse()
            .ok(),
        None => text.replace(['D', 'd'], "e").parse().ok(),
    }
}
